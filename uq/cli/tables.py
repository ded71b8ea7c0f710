"""The summary of a result, as tables of 80 columns."""

from collections.abc import Iterator, Mapping
from itertools import chain
from math import isnan

import xarray as xr

from uq.analysis.life_fit import Fit
from uq.analysis.life_quantiles import B_LIVES
from uq.analysis.statistics.statistic import Reader, Statistic
from uq.analysis.summary import Described, Summary
from uq.cli.printing import grid, heading, note, paragraph
from uq.estimate import Estimate
from uq.indices.targets import split_name
from uq.wording import duration, estimated, failed_interval, interval, number


def show_summary(ds: xr.Dataset, summary: Summary) -> None:
    """Print a summary."""
    design = f"{ds.attrs['design']}, {summary.samples} rows"
    if summary.rows_used < summary.samples:
        some = summary.rows_used
        design += f", statistics from the {some} independent ones" if some else ", none independent"
    heading(str(ds.attrs["title"]), f"{ds.attrs['source']}, {design}")
    grid([(label, str(count), _example(ds, label)) for label, count in summary.status.items()])
    if summary.regimes:
        heading("\nregime")
        shares = [_regime(one) for one in summary.regimes.values()]
        grid(shares, header=("", "share", "95 % interval", "rows", "with failed rows"))
    for name, output in summary.outputs.items():
        meaning = ds[name.partition("[")[0]].attrs["long_name"]
        unit = "" if output.units == "1" else f" [{output.units}]"
        heading(f"\n{name}{unit}", meaning)
        grid(_lines(output), header=("", "value", "95 % interval", ""))
        for one in output.statistics:
            for text in one.notes:
                paragraph(text, indent=2)
        if output.fits:
            _show_fits(output.fits)
    for text in summary.notes:
        note(text)


Line = tuple[str, str, str, str]


def _regime(one: Statistic) -> tuple[str, ...]:
    share = (one.label, one.words(), interval(one.estimate))
    return *share, str(one.facts["count"]), failed_interval(one.failed)


def _lines(output: Described) -> Iterator[Line]:
    """Yield label, value, interval, and the value in hours, days or years."""
    for part in output.parts.values():
        shown = [one for one in part if one.is_read_by(Reader.TERMINAL) and one.words()]
        for one in shown:
            yield _line(one)
            if isnan(one.estimate.value) and one.rows_needed is None and not one.otherwise:
                yield from _reason(one)
            yield from _failed(one)
            if one.otherwise and one.otherwise.label:
                yield from _reason(one)
                yield _line(one.otherwise)
                yield from _reason(one.otherwise)
                yield from _failed(one.otherwise)
                yield "", one.otherwise.estimate.assumes.removeprefix("that "), "", ""
        for assumed in dict.fromkeys(one.estimate.assumes for one in shown):
            if assumed:
                yield "", f"{shown[0].kind.name} assume", assumed.removeprefix("that "), ""


def _line(one: Statistic) -> Line:
    more = duration(one.estimate.value) if one.unit == "s" else ""
    if one.unit == "rows":
        more = one.unit
    elif form := split_name(one.of)[0]:
        more = f"of its {form}"
    return estimated(one.label), one.words(), interval(one.estimate), more


def _failed(one: Statistic) -> Iterator[Line]:
    if worst := failed_interval(one.failed):
        yield "  with failed rows", "", worst, ""


def _reason(one: Statistic) -> Iterator[Line]:
    if one.estimate.reason:
        yield "", one.estimate.reason, "", ""


def _show_fits(fits: Mapping[str, Fit]) -> None:
    """Print the laws that fit side by side, with their B-lives, and why the others do not."""
    for law, fit in fits.items():
        if fit.refused:
            paragraph(f"{law}: {fit.refused}", indent=2)
    accepted = {law: fit for law, fit in fits.items() if not fit.refused}
    if not accepted:
        return
    lines = [("p of the test", *chain(*((f"{fit.p_value:.2g}", "") for fit in accepted.values())))]
    laws = [{**fit.parameters, **fit.b_lives} for fit in accepted.values()]
    parameters = dict.fromkeys(chain(*(fit.parameters for fit in accepted.values())))
    for name in (*parameters, *B_LIVES):
        extrapolated = any(name in fit.extrapolated for fit in accepted.values())
        cells = chain(*(_cells(law.get(name)) for law in laws))
        lines.append((f"{name}, extrapolated" if extrapolated else name, *cells))
    grid(lines, header=("", *(cell for law in accepted for cell in (law, "95 % interval"))))
    assumed = next(iter(accepted.values())).assumes
    paragraph(f"The numbers of a fitted law assume {assumed}.", indent=2)


def _cells(one: Estimate | None) -> tuple[str, str]:
    return ("", "") if one is None else (number(one.value), interval(one))


def _example(ds: xr.Dataset, status: str) -> str:
    return str(ds["status"].attrs.get(f"example_{status.replace('-', '_')}", ""))
