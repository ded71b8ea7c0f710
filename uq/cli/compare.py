"""The output of ``uq compare``."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path

from uq.assess.comparison import ComparedOutput, ComparedStatistic, Comparison, Side, comparison
from uq.assess.summary_facts import comparison_facts
from uq.cli.printing import cells, console, grid, heading, note, paragraph, print_json
from uq.errors import InputError
from uq.result.result import Result
from uq.stats.estimate import Estimate, interval_text
from uq.text.numbers import compared, counted, estimated, in_brackets, in_unit, number, percent
from uq.text.units import unit_of

_MOST_OUTPUTS = 6
"""Largest number of outputs with a sentence on the effect of a single changed input."""


def compare(
    first: Path, second: Path, json: bool, output: str | None = None, plot: Path | None = None
) -> None:
    """Compare two results and print the comparison."""
    differences = comparison(Result.open(first), Result.open(second), output)
    if plot is not None:
        _draw(differences, plot)
    if not json:
        _show(differences, first, second)
        return
    document = comparison_facts(differences).json
    for key, path in (("a", first), ("b", second)):
        document[key] = {"file": str(path)} | document[key]
    print_json(document)


def _draw(differences: Comparison, path: Path) -> None:
    from uq.plots import compared_lives
    from uq.render.figures.figure import write

    if not differences.curves:
        raise InputError("--plot: only where one result has lives from the field; leave it out")
    form = path.suffix.removeprefix(".") or "png"
    for file in write(compared_lives(differences), path.with_suffix(""), (form,)):
        console.print(str(file), soft_wrap=True)


def _show(differences: Comparison, first: Path, second: Path) -> None:
    sides = (("A", first, differences.first), ("B", second, differences.second))
    grid([(name, str(path), _about(side)) for name, path, side in sides], indent=0)
    heading("\nDifferences between the studies")
    for change in differences.changed:
        change_name = change.name if change.kind == "input" else f"{change.kind} {change.name}"
        heading(f"  {change_name.removeprefix('design design').strip() or 'design'}")
        grid([("A", change.first), ("B", change.second)], indent=4)
    if not differences.changed:
        paragraph("none", indent=2)
    for name, shares in differences.shares.items():
        if not shares:
            continue
        heading(f"\n{name}")
        grid([(label, *_cells(statistic)) for label, statistic in shares.items()], header=_HEADER)
    for name, output in differences.outputs.items():
        unit = output.readable_unit
        heading(f"\n{name}{in_brackets(unit)}")
        variable = compared(name, output.declared.is_angle)
        grid(_lines(output, unit.size, variable), _HEADER)
    for name, curves in differences.curves.items():
        at = [i for i, apart in enumerate(curves.differences) if isfinite(apart.value)]
        if at:
            worst = max(at, key=lambda i: abs(curves.differences[i].value))
            apart = curves.differences[worst]
            unit = unit_of(differences.outputs[name].units, float(curves.time[worst]))
            place = in_unit(float(curves.time[worst]), unit)
            ends = f" ({interval_text(apart)})" if apart.has_interval else ""
            note(
                f"{name}: the survival curves differ most at {place}:"
                f" B - A {apart.value:.2g}{ends}."
            )
    note("*: the interval excludes no difference. " + _POINTWISE)
    for text in (*bought(differences), *differences.notes):
        note(text)


_HEADER = ("", "A", "B", "B - A", "95 % interval", "")
_POINTWISE = "The intervals are pointwise: one in twenty is expected to miss."


def _about(side: Side) -> str:
    summary = side.summary
    rows = counted(summary.samples, "row")
    if summary.rows_used < summary.samples:
        rows += f", {summary.rows_used} independent"
    lost = ", ".join(f"{count} {label}" for label, count in summary.status.items() if label != "ok")
    return f"{side.title} ({rows}{f'; {lost}' if lost else ''})"


Line = tuple[str, ...]


def _lines(output: ComparedOutput, size: float, variable: str) -> Iterator[Line]:
    """Yield the statistics of an output, in a unit of size `size`, and their ratios."""
    for statistic in output.statistics:
        first = statistic.first
        per = size if first.unit == output.units else 1.0
        asked = () if first.at is None else (first.at,)
        yield estimated(first.label, output.units, variable, asked), *_cells(statistic, per)
        if statistic.ratio is not None and isfinite(statistic.ratio.value):
            ratio = _apart(statistic, statistic.ratio, 1.0, 1.0)
            yield f"{first.label}, B over A", "", "", *ratio


def _cells(statistic: ComparedStatistic, per: float = 1.0) -> Line:
    both = (statistic.first.words(per), statistic.second.words(per))
    return *both, *_apart(statistic, statistic.difference, per)


def _apart(statistic: ComparedStatistic, apart: Estimate, per: float, nothing: float = 0.0) -> Line:
    """Return value and interval of a difference, with a mark if it excludes `nothing`."""
    sure = apart.low > nothing or apart.high < nothing
    value, ends = cells(apart, per)
    if statistic.identical:
        ends = "identical rows"
    if statistic.no_row_changes_sides:
        ends = f"no row changes sides (at most {percent(apart.high)} do)"
    return value, ends, "*" if sure else ""


def bought(differences: Comparison) -> list[str]:
    """Return sentences on how the change of a single input affected the scatter of the outputs."""
    only = differences.only
    if only is None:
        return []
    first, second = only.first, only.second
    change = f"sd {_both(first.sd, second.sd, only.units)}"
    if abs(second.mean - first.mean) > 0.1 * max(first.sd, second.sd):
        change += f", mean {_both(first.mean, second.mean, only.units)}"
    sentences = [f"Only {only.name} differs ({change})."]
    for name, output in list(differences.outputs.items())[:_MOST_OUTPUTS]:
        for statistic in output.statistics:
            if statistic.ratio is not None and isfinite(statistic.ratio.value):
                sentences.append(_times(f"{statistic.first.label} of {name}", statistic.ratio))
    return [" ".join(sentences)]


def _both(first: float, second: float, units: str) -> str:
    """Return two numbers in the readable unit of the first."""
    unit = unit_of(units, first)
    return f"{number(first / unit.size)} to {in_unit(second, unit)}"


def _times(name: str, ratio: Estimate) -> str:
    ends = interval_text(ratio)
    change = 1 - ratio.value**2
    words = f"{abs(change):.0%} {'less' if change > 0 else 'more'} variance"
    was = f"{number(ratio.value)} times its former value{f' ({ends})' if ends else ''}"
    return f"{name}: {was}, {words}."
