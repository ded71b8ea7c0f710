"""Fleets in a report: as many units as a sample has."""

from collections.abc import Iterator
from functools import partial
from math import isfinite

from uq.assess.findings import Findings
from uq.assess.fleet import Fleet
from uq.assess.fleet_numbers import Banded
from uq.render.html.cells import Cell, HtmlTable
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import interval_text, value_text
from uq.text.keys import key_of
from uq.text.numbers import counted, in_brackets, threshold
from uq.text.units import typical, unit_of

HEADER = ("life", "quantity", "all samples", "5 % of samples", "95 % of samples")


def fleet_table(findings: Findings) -> HtmlTable | None:
    """Return the lives of fleets of a result; None where a sample has a single unit."""
    found = findings.fleets
    if not found:
        return None
    rows = [row for one in found for row in _rows(one)]
    return HtmlTable(
        f"Fleets of {counted(found[0].size, 'unit')}, with 95 % intervals", HEADER, rows
    )


def fleet_notes(findings: Findings) -> list[str]:
    """Return what is integrated in these numbers, what they lack, and what they assume."""
    found = dict.fromkeys(note for one in findings.fleets for note in one.sentences)
    return list(found)


def _rows(one: Fleet) -> Iterator[tuple[Cell, ...]]:
    options = {"size": str(one.size), "output": one.output}
    traced = partial(key_of, verb="fleet", options=options)
    unit = unit_of(one.units, typical(banded.estimate.value for banded in one.first.values()))
    for p, banded in one.first.items():
        words = f"{100 * p:g} % quantile of the first{in_brackets(unit)}"
        yield _row(one.output, words, banded, traced("first", "quantiles", repr(p)), unit.size)
    for time, (failed, at_most) in one.by.items():
        by = f"{one.ended} by {threshold(time, one.units)}"
        of = ("by", repr(time))
        yield _row(one.output, f"number {by}", failed, traced(*of, "failed"))
        yield _row(one.output, f"P(none {by})", at_most, traced(*of, "at_most_allowed"))


def _row(name: str, quantity: str, one: Banded, traced: str, per: float = 1.0) -> tuple[Cell, ...]:
    ends = ((one.estimate, ""), (one.low, "/band_low"), (one.high, "/band_high"))
    cells = (_cell(end, per, f"{traced}{last}") for end, last in ends)
    return Cell(name), Cell(quantity), *cells


def _cell(one: Estimate, per: float, traced: str) -> Cell:
    key = one.value if isfinite(one.value) else None
    return Cell(value_text(one, per=per), interval_text(one, per) or one.reason, key, traced)
