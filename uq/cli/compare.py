"""The output of ``uq compare``."""

from collections.abc import Iterator
from itertools import chain
from math import isfinite
from pathlib import Path

from uq.assess.comparison import Comparison, Side, comparison
from uq.assess.differences import ComparedOutput, ComparedStatistic
from uq.assess.summary_json import comparison_json
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.result.result_file import open_result
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import interval_text, value_text
from uq.text.numbers import compared, counted, estimated, in_brackets, in_unit, number, percent
from uq.text.units import ReadableUnit, typical, unit_of

_MOST_OUTPUTS = 6
"""Largest number of outputs with a sentence on the effect of a single changed input."""


def compare(first: Path, second: Path, json: bool) -> None:
    """Compare two results and print the comparison."""
    found = comparison(open_result(first), open_result(second))
    if not json:
        _show(found, first, second)
        return
    document = comparison_json(found)
    for key, path in (("a", first), ("b", second)):
        document[key] = {"file": str(path)} | document[key]
    print_json(document)


def _show(found: Comparison, first: Path, second: Path) -> None:
    sides = (("A", first, found.first), ("B", second, found.second))
    grid([(name, str(path), _about(side)) for name, path, side in sides], indent=0)
    heading("\nDifferences between the studies")
    for change in found.changed:
        what = change.name if change.kind == "input" else f"{change.kind} {change.name}"
        heading(f"  {what.removeprefix('design design').strip() or 'design'}")
        grid([("A", change.first), ("B", change.second)], indent=4)
    if not found.changed:
        paragraph("none", indent=2)
    for name, shares in found.shares.items():
        if not shares:
            continue
        heading(f"\n{name}")
        grid([(label, *_cells(one)) for label, one in shares.items()], header=_HEADER)
    for name, output in found.outputs.items():
        unit = _unit(output)
        heading(f"\n{name}{in_brackets(unit)}")
        of = compared(name, output.declared.is_angle)
        parts = (_lines(one, output.units, unit.size, of) for one in output.statistics)
        grid(chain.from_iterable(parts), _HEADER)
    note("*: the interval excludes no difference. " + _POINTWISE)
    for text in (*bought(found), *found.notes):
        note(text)


_HEADER = ("", "A", "B", "B - A", "95 % interval", "")
_POINTWISE = "The intervals are pointwise: one in twenty misses."


def _about(side: Side) -> str:
    one = side.summary
    rows = counted(one.samples, "row")
    if one.rows_used < one.samples:
        rows += f", {one.rows_used} independent"
    lost = ", ".join(f"{count} {label}" for label, count in one.status.items() if label != "ok")
    return f"{side.title} ({rows}{f'; {lost}' if lost else ''})"


def _unit(output: ComparedOutput) -> ReadableUnit:
    """Return the unit in which an output is shown."""
    return unit_of(
        output.units, typical(one.first.estimate.value for one in output.parts["quantiles"])
    )


Line = tuple[str, ...]


def _lines(one: ComparedStatistic, units: str, per: float, of: str) -> Iterator[Line]:
    own = per if one.first.unit == units else 1.0
    asked = () if one.first.at is None else (one.first.at,)
    yield estimated(one.first.label, units, of, asked), *_cells(one, own)
    if one.ratio is not None and isfinite(one.ratio.value):
        yield f"{one.first.label}, B over A", "", "", *_apart(one, one.ratio, 1.0, 1.0)


def _cells(one: ComparedStatistic, per: float = 1.0) -> Line:
    both = (one.first.words(per), one.second.words(per))
    return *both, *_apart(one, one.difference, per)


def _apart(of: ComparedStatistic, apart: Estimate, per: float, nothing: float = 0.0) -> Line:
    """Return value and interval of a difference, and a mark where it excludes `nothing`."""
    sure = apart.low > nothing or apart.high < nothing
    ends = "identical rows" if of.identical else interval_text(apart, per)
    if of.no_row_changes_sides:
        ends = f"no row changes sides (at most {percent(apart.high)} do)"
    return value_text(apart, per=per), ends, "*" if sure else ""


def bought(found: Comparison) -> list[str]:
    """Return sentences on how the change of a single input affected the scatter of the outputs."""
    only = found.only
    if only is None:
        return []
    first, second = only.first, only.second
    change = f"sd {_both(first.sd, second.sd, only.units)}"
    if abs(second.mean - first.mean) > 0.1 * max(first.sd, second.sd):
        change += f", mean {_both(first.mean, second.mean, only.units)}"
    sentences = [f"Only {only.name} differs ({change})."]
    for name, output in list(found.outputs.items())[:_MOST_OUTPUTS]:
        for one in output.statistics:
            if one.ratio is not None and isfinite(one.ratio.value):
                sentences.append(_times(f"{one.first.label} of {name}", one.ratio))
    return [" ".join(sentences)]


def _both(first: float, second: float, units: str) -> str:
    """Return two numbers in the unit in which the first is read."""
    unit = unit_of(units, first)
    return f"{number(first / unit.size)} to {in_unit(second, unit)}"


def _times(name: str, ratio: Estimate) -> str:
    ends = interval_text(ratio)
    change = 1 - ratio.value**2
    words = f"{abs(change):.0%} {'less' if change > 0 else 'more'} variance"
    was = f"{number(ratio.value)} times what it was{f' ({ends})' if ends else ''}"
    return f"{name}: {was}, {words}."
