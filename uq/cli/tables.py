"""The summary of a result, as tables of 80 columns."""

from collections.abc import Iterator, Mapping

import xarray as xr

from uq.analysis.b_lives import B_LIVES
from uq.cli.printing import console, grid, heading, paragraph
from uq.indices.targets import split_name
from uq.wording import (
    Entry,
    accuracy_not_reached,
    duration,
    failed_interval,
    interval,
    known,
    number,
    variance_between,
)


def show_summary(ds: xr.Dataset, summary: Entry) -> None:
    """Print what `uq.analysis.statistics.summarise` found."""
    design = f"{ds.attrs['design']}, {summary['samples']} rows"
    if summary["rows_used"] < summary["samples"]:
        some = summary["rows_used"]
        design += f", statistics from the {some} independent ones" if some else ", none independent"
    heading(str(ds.attrs["title"]), f"{ds.attrs['source']}, {design}")
    grid([(label, str(count), _example(ds, label)) for label, count in summary["status"].items()])
    if summary["regime"]:
        heading("\nregime")
        shares = summary["regime"].items()
        grid(
            [
                (
                    label,
                    number(one["share"]),
                    interval(one),
                    str(one["count"]),
                    failed_interval(one),
                )
                for label, one in shares
            ],
            header=("", "share", "95 % interval", "rows", "with failed rows"),
        )
    for name, output in summary["outputs"].items():
        meaning = ds[name.partition("[")[0]].attrs["long_name"]
        unit = "" if output["units"] == "1" else f" [{output['units']}]"
        heading(f"\n{name}{unit}", meaning)
        grid(_lines(output), header=("", "value", "95 % interval", ""))
        for reason in dict.fromkeys(output["reasons"].values()):
            paragraph(reason, indent=2)
        if output["caution"]:
            paragraph(output["caution"], indent=2)
        if (accuracy := output.get("accuracy")) and accuracy["missed"]:
            paragraph(accuracy_not_reached(accuracy), indent=2)
        if fits := output.get("fits"):
            _show_fits(fits)
    for note in summary["notes"]:
        console.print()
        paragraph(note, indent=0)


Line = tuple[str, str, str, str]


def _lines(output: Entry) -> Iterator[Line]:
    """Yield label, value, interval and the value in hours, days or years."""

    def line(label: str, entry: Entry, key: str = "value", time: bool = True) -> Line:
        in_words = duration(entry[key]) if time and output["units"] == "s" else ""
        return label, known(entry, key), interval(entry), in_words

    yield line("mean", {"value": output["mean"], **output["mean_interval"]})
    yield line("sd", {"value": output["sd"], **output["sd_interval"]})

    def failed(entry: Entry) -> Iterator[Line]:
        if worst := failed_interval(entry):
            yield "  with failed rows", "", worst, ""

    for probability, entry in output["quantiles"].items():
        yield line(f"quantile {probability}", entry)
        yield from failed(entry)
        if guess := entry.get("kaplan_meier"):
            yield line(f"quantile {probability}, if", guess)
            yield from failed(guess)
            yield "", _ASSUMES, "", ""
    for name, entry in output["b_lives"].items():
        yield line(name, entry)
        yield from failed(entry)
    if any("assumes" in entry for entry in output["b_lives"].values()):
        yield "", "B-lives suppose", _ASSUMES, ""
    if bounds := output["tolerance"]:
        yield line("tolerance, lower", bounds, "lower")
        yield line("tolerance, upper", bounds, "upper")
        if bounds["lower"] is None and bounds["upper"] is None:
            yield "", f"needs {bounds['rows_needed']} rows", "", ""
    for threshold, entry in output["thresholds"].items():
        for sign, side in ((">", "above"), ("<", "below")):
            yield line(f"P({sign} {number(float(threshold))})", entry[side], time=False)
            yield from failed(entry[side])
        if reason := entry.get("reason"):
            yield "", reason, "", ""
            guess = entry["kaplan_meier"]
            yield line(f"P(< {number(float(threshold))}), if", guess["below"], time=False)
            if none := guess["below"].get("reason"):
                yield "", none, "", ""
            yield from failed(guess["below"])
            yield "", _ASSUMES, "", ""
    if split := output.get("between_regimes"):
        form, *_ = split_name(split["of"])
        of = f"of its {form}" if form else ""
        yield "variance between regimes", variance_between(split), interval(split), of
    for count in ("never", "censored", "undefined", "failed"):
        if output[count]:
            yield count, str(output[count]), "", "rows"


_ASSUMES = "censoring says nothing of the life left"


def _show_fits(fits: Mapping[str, Entry]) -> None:
    """Print the laws that fit side by side, with the lives they give, and why others do not."""
    for law, fit in fits.items():
        if refusal := fit.get("refused"):
            paragraph(f"{law}: {refusal}", indent=2)
    accepted = {law: fit for law, fit in fits.items() if "refused" not in fit}
    if not accepted:
        return
    names = dict.fromkeys(name for fit in accepted.values() for name in fit["parameters"])
    lines = [("p of the test", *(cell for fit in accepted.values() for cell in _p_value(fit)))]
    lines += [(name, *_side_by_side(accepted, name)) for name in names]
    for name in B_LIVES:
        extrapolated = any(fit[name]["extrapolated"] for fit in accepted.values())
        label = f"{name}, extrapolated" if extrapolated else name
        lines.append((label, *_side_by_side(accepted, name)))
    grid(lines, header=("", *(cell for law in accepted for cell in (law, "95 % interval"))))
    assumed = next(iter(accepted.values()))["assumes"]
    paragraph(f"The numbers of a fitted law assume {assumed}.", indent=2)


def _p_value(fit: Entry) -> tuple[str, str]:
    return f"{fit['p_value']:.2g}", ""


def _side_by_side(fits: Mapping[str, Entry], name: str) -> Iterator[str]:
    """Yield value and interval of one number of each law; nothing of a law without it."""
    for fit in fits.values():
        one = (fit["parameters"] | fit).get(name)
        yield from ("", "") if one is None else (number(one["value"]), interval(one))


def _example(ds: xr.Dataset, status: str) -> str:
    return str(ds["status"].attrs.get(f"example_{status.replace('-', '_')}", ""))
