"""Rows in a report: how they ended, and the tables, figures and sentences of each output."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan
from typing import Any

from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.wording import scale_warning
from uq.assess.findings import Findings
from uq.assess.regimes import in_words
from uq.assess.statistic import Listing, Reader, Statistic
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import REGIME, Described, Shares, Summary
from uq.contract import Output, Status
from uq.render.figures.words import place_in_words, unbroken
from uq.render.html.answer import sayings
from uq.render.html.cells import SHARE, Cell, HtmlTable, cell, estimate_cell, without_empty_columns
from uq.render.html.indices import Methods, of_output
from uq.render.html.pictures import Picture, about
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.text.keys import key_of
from uq.text.numbers import capitalized, percent, percent_interval, threshold
from uq.text.units import readable


def status_table(result: Result, summary: Summary) -> HtmlTable:
    """Return the table of row status: number, share, meaning, and first message."""
    meaning = {status.label: status.meaning for status in Status}
    rows = []
    for label, row_count in summary.status.items():
        example = str(result.dataset["status"].attrs.get(f"example_{label.replace('-', '_')}", ""))
        share = row_count / max(summary.samples, 1)
        count = Cell(str(row_count), key=float(row_count), traced=key_of("status", label))
        cells = (count, Cell(percent(share), key=share, scale=SHARE))
        rows.append((Cell(label), *cells, Cell(meaning.get(label, "")), Cell(example)))
    header = ("status", "rows", "share", "meaning", "first message")
    return without_empty_columns(HtmlTable("Status of all rows", header, rows))


def category_table(name: str, shares: Shares) -> HtmlTable:
    """Return the share of each label of a category among the independent rows."""
    rows = [
        (
            Cell(statistic.label),
            Cell(f"{count}", key=float(count), traced=key_of(*statistic.key, "count")),
            _share(statistic.estimate, key_of(*statistic.key, "share")),
        )
        for statistic in shares.values()
        for count in [statistic.facts["count"]]
    ]
    title = f"{capitalized(name)}, with 95 % intervals"
    return HtmlTable(title, (name, "rows", "share"), rows)


def regime_tables(findings: Findings) -> list[HtmlTable]:
    """Return the share of each regime and, if available, how intermingled the regimes are."""
    if not findings.summary.regimes:
        return []
    tables = [category_table(REGIME, findings.summary.regimes)]
    boundary = findings.boundary
    if boundary is not None and boundary.estimate.has_interval:
        caption = "Boundary between the regimes, with 95 % interval"
        traced = cell(boundary)._replace(traced=key_of(*boundary.key))
        line = (Cell(boundary.label), traced, Cell(in_words(boundary)))
        tables.append(HtmlTable(caption, ("", "value", "meaning"), [line]))
    return tables


def _share(estimate: Estimate, traced: str) -> Cell:
    if isnan(estimate.value):
        return Cell("-", traced=traced)
    below = percent_interval(estimate.low, estimate.high) if estimate.has_interval else ""
    return estimate_cell(percent(estimate.value), below, estimate, traced, SHARE)


class Outcome:
    """Element of an output with its statistics, label and displayed unit.

    Parameters
    ----------
    name : str
    place : str
        Coordinates within the output: ``left, 250 µm``; "" for a single element.
    declared : Output
    described : Described
    """

    def __init__(self, name: str, place: str, declared: Output, described: Described):
        self.name, self.place, self.declared = name, place, declared
        self.parts = described.parts
        unit = described.readable_unit
        self.unit = unit._replace(name=unbroken(unit.name))

    @property
    def output(self) -> str:
        """Output that contains the element."""
        return self.name.partition("[")[0]

    @property
    def label(self) -> Cell:
        """Coordinates within the output with the name below; for a single element, the name."""
        return Cell(self.place, self.name) if self.place else Cell(self.name)

    @property
    def unit_cell(self) -> Cell:
        """Unit of the other cells; empty for a dimensionless number."""
        return Cell("" if self.unit.name == "1" else self.unit.name)

    def per(self, statistic: Statistic) -> float:
        """Return the size of the unit in which a statistic is shown."""
        return self.unit.size if statistic.unit == self.declared.unit else 1.0

    def scale(self, statistic: Statistic) -> str:
        """Return the scale of the bars; all values of the output share one scale."""
        return self.declared.unit if statistic.is_value_in(self.declared.unit) else ""


def outcomes(result: Result, summary: Summary) -> list[Outcome]:
    """Return the elements described by a summary, in the same order."""
    names = dict.fromkeys(name.partition("[")[0] for name in summary.outputs)
    of_outputs = []
    for element in result.independent.elements(list(names)):
        described = summary.outputs[element.name]
        place = place_in_words(result, element)
        of_outputs.append(Outcome(element.name, place, element.declared, described))
    return of_outputs


def result_tables(of_outputs: list[Outcome]) -> Iterator[HtmlTable]:
    """Yield the non-empty tables of statistics."""
    shown = [
        (outcome, statistic)
        for part in STATISTICS
        for outcome in of_outputs
        for statistic in outcome.parts[part]
        if statistic.is_read_by(Reader.REPORT)
    ]
    for listing in dict.fromkeys(statistic.kind.listing for _, statistic in shown):
        listed = [
            (outcome, statistic)
            for outcome, statistic in shown
            if statistic.kind.listing == listing
        ]
        yield _table(listing, of_outputs, listed)


def _table(
    listing: Listing, of_outputs: list[Outcome], shown: list[tuple[Outcome, Statistic]]
) -> HtmlTable:
    """Return a table with statistics as columns, in the order of `STATISTICS`."""
    columns = tuple(dict.fromkeys(_heading(statistic) for _, statistic in shown))
    rows: list[tuple[Cell, ...]] = []
    for outcome in of_outputs:
        statistics = [statistic for of, statistic in shown if of is outcome]
        rows += _rows(listing, outcome, statistics, columns)
    header = (listing.first, listing.by or "unit", *columns)
    table = HtmlTable(listing.caption, header + ("note",) * bool(listing.by), rows)
    return table if listing.keeps_empty else without_empty_columns(table)


def _heading(statistic: Statistic) -> str:
    return statistic.label if statistic.heading is None else statistic.heading


def _rows(
    listing: Listing, outcome: Outcome, statistics: list[Statistic], columns: tuple[str, ...]
) -> Iterator[tuple[Cell, ...]]:
    """Yield the row of an output, or one for each threshold of its statistics."""
    for at in dict.fromkeys(statistic.at for statistic in statistics):
        here = {_heading(statistic): statistic for statistic in statistics if statistic.at == at}
        cells = [_cell(outcome, here.get(column), listing) for column in columns]
        if at is None:
            yield outcome.label, outcome.unit_cell, *cells
        else:
            note = "; ".join(filter(None, (statistic.more for statistic in here.values())))
            sign = "magnitude " if outcome.declared.is_angle else ""
            place = Cell(f"{sign}{threshold(at, outcome.declared.unit)}", key=at)
            yield outcome.label, place, *cells, Cell(note)


def _cell(outcome: Outcome, statistic: Statistic | None, listing: Listing) -> Cell:
    if statistic is None:
        return Cell("")
    traced = key_of("outputs", outcome.name, *statistic.key)
    if listing.by:  # the small print has its own column
        return cell(replace(statistic.best, more=""), scale=SHARE)._replace(traced=traced)
    if (
        statistic.estimate.reason
        and isnan(statistic.estimate.value)
        and statistic.rows_needed is None
    ):
        return Cell("none", statistic.estimate.reason)
    return cell(statistic, outcome.per(statistic), outcome.scale(statistic))._replace(traced=traced)


_WORDS = {
    "never": "Never: the event is known never to occur.",
    "censored": "Censored: the event had not occurred by the horizon.",
    "undefined": "Undefined: the output is not defined in the regime of the row.",
}


def words_used(of_outputs: list[Outcome]) -> list[str]:
    """Return the meanings of the counts that occur."""
    counted = {
        statistic.key[-1]
        for outcome in of_outputs
        for statistics in outcome.parts.values()
        for statistic in statistics
        if statistic.key[0] in _WORDS and statistic.estimate.value
    }
    return [text for word, text in _WORDS.items() if word in counted]


def groups(
    findings: Findings,
    answer: Answer,
    outcomes: Sequence[Outcome],
    drawn: Sequence[Picture],
    methods: Methods,
) -> Iterator[dict[str, Any]]:
    """Yield the results of each output in the study's analysis, its main quantity first.

    Parameters
    ----------
    findings : Findings
    answer : Answer
    outcomes : sequence of Outcome
        Elements of all outputs.
    drawn : sequence of Picture
        Figures that the head of the report does not show.
    methods : Methods

    Yields
    ------
    dict
        Name and meaning of an output; ``sentences`` of the answer, without those on the subject
        of the study; ``tables``; ``words`` that explain the counts; ``pictures``; ``indices``;
        ``warning``, if assumed inputs set its scale.
    """
    result = findings.result
    shown = result.shown_outputs(result.analysis)
    for name in dict.fromkeys((*(quantity.output for quantity in answer.quantities), *shown)):
        if name == REGIME:  # it has its own section
            continue
        matching = [outcome for outcome in outcomes if outcome.output == name]
        shares = (
            category_table(element, of_labels)
            for element, of_labels in findings.summary.categories.items()
            if element.partition("[")[0] == name and of_labels
        )
        others = [quantity for quantity in answer.quantities[1:] if quantity.output == name]
        contents = {
            "sentences": sayings(answer, others),
            "tables": [*shares, *result_tables(matching)],
            "words": words_used(matching),
            "pictures": about(drawn, name),
            "indices": of_output(methods, name),
        }
        if any(contents.values()):
            about_it = {
                "name": name,
                "meaning": capitalized(readable(str(result.dataset[name].attrs["long_name"]))),
                "warning": scale_warning(assumed_scales(answer, name)),
            }
            yield about_it | contents


def assumed_scales(answer: Answer, output: str) -> tuple[str, ...]:
    """Return the assumed inputs to which every life of an output is proportional."""
    of_output = (quantity for quantity in answer.quantities if quantity.output == output)
    return next((quantity.scaled_by for quantity in of_output), ())
