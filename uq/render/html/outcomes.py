"""The rows in a report: how they ended, and the statistics of the outputs."""

from collections.abc import Iterator
from dataclasses import replace
from math import isnan

from uq.assess.findings import Findings
from uq.assess.regime_boundary import in_words
from uq.assess.statistic import Listing, Reader, Statistic
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import REGIME, Described, Shares, Summary
from uq.contract import Output, Status
from uq.render.figures.words import place_in_words, unbroken
from uq.render.html.cells import SHARE, Cell, HtmlTable, cell, without_empty_columns
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.text.keys import key_of
from uq.text.numbers import capitalized, percent, percent_interval, threshold
from uq.text.units import typical, unit_of


def status_table(result: Result, summary: Summary) -> HtmlTable:
    """Return the number and share of rows by status, its meaning, and the first message."""
    meaning = {status.label: status.meaning for status in Status}
    rows = []
    for label, found in summary.status.items():
        example = str(result.dataset["status"].attrs.get(f"example_{label.replace('-', '_')}", ""))
        share = found / max(summary.samples, 1)
        count = Cell(str(found), key=float(found), traced=key_of("status", label))
        cells = (count, Cell(percent(share), key=share, scale=SHARE))
        rows.append((Cell(label), *cells, Cell(meaning.get(label, "")), Cell(example)))
    header = ("status", "rows", "share", "meaning", "first message")
    return without_empty_columns(HtmlTable("Status of all rows", header, rows))


def category_table(name: str, shares: Shares) -> HtmlTable:
    """Return the share of each label of a category among the independent rows."""
    rows = [
        (
            Cell(one.label),
            Cell(f"{count}", key=float(count), traced=key_of(*one.key, "count")),
            _share(one.estimate)._replace(traced=key_of(*one.key, "share")),
        )
        for one in shares.values()
        for count in [one.facts["count"]]
    ]
    title = f"{capitalized(name)}, with 95 % intervals"
    return HtmlTable(title, (name, "rows", "share"), rows)


def regime_tables(findings: Findings) -> list[HtmlTable]:
    """Return the share of each regime, and how intermingled they are where that is known."""
    if not findings.summary.regimes:
        return []
    found = [category_table(REGIME, findings.summary.regimes)]
    one = findings.boundary
    if one is not None and one.estimate.has_interval:
        caption = "Boundary between the regimes, with 95 % interval"
        traced = cell(one)._replace(traced=key_of(*one.key))
        line = (Cell(one.label), traced, Cell(in_words(one)))
        found.append(HtmlTable(caption, ("", "value", "meaning"), [line]))
    return found


def _share(one: Estimate) -> Cell:
    if isnan(one.value):
        return Cell("-")
    below = percent_interval(one.low, one.high) if one.has_interval else ""
    return Cell(percent(one.value), below, one.value, "", SHARE, (one.low, one.high))


_VALUES = ("mean", "sd", "quantiles", "b_lives", "tolerance", "joint_bounds")
"""First parts of the keys of statistics that are values of the output."""


class Outcome:
    """An element of an output: its statistics, its words, the unit it is shown in.

    Parameters
    ----------
    name : str
    place : str
        Within the output: ``left, 250 µm``; "" for a single element.
    declared : Output
    described : Described
    """

    def __init__(self, name: str, place: str, declared: Output, described: Described):
        self.name, self.place, self.declared = name, place, declared
        self.parts = described.parts
        quantiles = (one.estimate.value for one in described.parts["quantiles"])
        unit = unit_of(described.units, typical(quantiles))
        self.unit = unit._replace(name=unbroken(unit.name))

    @property
    def output(self) -> str:
        """The output that it is an element of."""
        return self.name.partition("[")[0]

    @property
    def label(self) -> Cell:
        """Its place within the output, with its name below; the name of a single element."""
        return Cell(self.place, self.name) if self.place else Cell(self.name)

    @property
    def unit_cell(self) -> Cell:
        """The unit of the other cells; empty for a pure number."""
        return Cell("" if self.unit.name == "1" else self.unit.name)

    def per(self, one: Statistic) -> float:
        """Return the length of the unit in which a statistic is shown."""
        return self.unit.size if one.unit == self.declared.unit else 1.0

    def scale(self, one: Statistic) -> str:
        """Return the scale of its bars: values of the output share one."""
        is_value = one.key[0] in _VALUES and one.unit == self.declared.unit
        return self.declared.unit if is_value else ""


def outcomes(result: Result, summary: Summary) -> list[Outcome]:
    """Return the elements that a summary describes, in its order."""
    names = dict.fromkeys(name.partition("[")[0] for name in summary.outputs)
    found = []
    for element in result.independent.elements(list(names)):
        described = summary.outputs[element.name]
        place = place_in_words(result, element)
        found.append(Outcome(element.name, place, element.declared, described))
    return found


def result_tables(found: list[Outcome]) -> Iterator[HtmlTable]:
    """Yield the tables of statistics that are not empty."""
    shown = [
        (outcome, one)
        for part in STATISTICS
        for outcome in found
        for one in outcome.parts[part]
        if one.is_read_by(Reader.REPORT)
    ]
    for listing in dict.fromkeys(one.kind.listing for _, one in shown):
        own = [(outcome, one) for outcome, one in shown if one.kind.listing == listing]
        yield _table(listing, found, own)


def _table(
    listing: Listing, found: list[Outcome], shown: list[tuple[Outcome, Statistic]]
) -> HtmlTable:
    """Lay out statistics in columns, in the order of `STATISTICS`."""
    columns = tuple(dict.fromkeys(_heading(one) for _, one in shown))
    rows: list[tuple[Cell, ...]] = []
    for outcome in found:
        own = [one for of, one in shown if of is outcome]
        rows += _rows(listing, outcome, own, columns)
    header = (listing.first, listing.by or "unit", *columns)
    table = HtmlTable(listing.caption, header + ("note",) * bool(listing.by), rows)
    return table if listing.keeps_empty else without_empty_columns(table)


def _heading(one: Statistic) -> str:
    return one.label if one.heading is None else one.heading


def _rows(
    listing: Listing, outcome: Outcome, own: list[Statistic], columns: tuple[str, ...]
) -> Iterator[tuple[Cell, ...]]:
    """Yield the row of an output, or one for each threshold of its statistics."""
    for at in dict.fromkeys(one.at for one in own):
        here = {_heading(one): one for one in own if one.at == at}
        cells = [_cell(outcome, here.get(column), listing) for column in columns]
        if at is None:
            yield outcome.label, outcome.unit_cell, *cells
        else:
            note = "; ".join(filter(None, (one.more for one in here.values())))
            sign = "magnitude " if outcome.declared.is_angle else ""
            place = Cell(f"{sign}{threshold(at, outcome.declared.unit)}", key=at)
            yield outcome.label, place, *cells, Cell(note)


def _cell(outcome: Outcome, one: Statistic | None, listing: Listing) -> Cell:
    if one is None:
        return Cell("")
    traced = key_of("outputs", outcome.name, *one.key)
    if listing.by:  # the small print has its own column
        return cell(replace(one.best, more=""), scale=SHARE)._replace(traced=traced)
    if one.estimate.reason and isnan(one.estimate.value) and one.rows_needed is None:
        return Cell("none", one.estimate.reason)
    return cell(one, outcome.per(one), outcome.scale(one))._replace(traced=traced)


_WORDS = {
    "never": "Never: the event is known never to occur.",
    "censored": "Censored: the event had not occurred by the horizon.",
    "undefined": "Undefined: the output is not defined in the regime of the row.",
}


def words_used(found: list[Outcome]) -> list[str]:
    """Return what the counts mean that occur."""
    counted = {
        one.key[-1] for outcome in found for one in outcome.parts["counts"] if one.estimate.value
    }
    return [text for word, text in _WORDS.items() if word in counted]
