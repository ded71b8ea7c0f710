"""Rows inside a page, with which its scripts (``live/``) compute."""

import shlex
from collections.abc import Iterator, Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.assess.answer.parts import Quantity
from uq.assess.answer.wording import called
from uq.assess.findings import Findings
from uq.assess.row_inputs import independent_inputs
from uq.assess.scaling import population
from uq.assess.summary import REGIME
from uq.contract import Floats
from uq.render.figures.elements_plot import occurring_regimes
from uq.render.figures.figure import LIMIT, ROWS
from uq.render.figures.scatter_plot import leading
from uq.render.figures.words import element_in_words, literal
from uq.render.html.embedded_columns import encoded, input_column, output_column
from uq.render.html.moved_laws import STOPS
from uq.render.html.tolerances import event_key, tolerances
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.result import Result
from uq.stats.clusters import Clusters
from uq.study.file import AnalysisTable
from uq.text.literals import plain
from uq.text.numbers import grouped, printed, threshold
from uq.text.units import readable


def first_element(
    elements: Sequence[Element], answered: Sequence[Quantity], analysis: AnalysisTable
) -> int:
    """Return the place of the element shown first.

    Parameters
    ----------
    elements : sequence of Element
    answered : sequence of Quantity
        The one that the study is about first.
    analysis : AnalysisTable

    Returns
    -------
    int
        Without an answer, of one that the study asks about, a life first.
    """
    about = answered[0].name if answered else ""
    return max(
        range(len(elements)),
        key=lambda i: (
            elements[i].name == about,
            elements[i].output in analysis.thresholds,
            elements[i].is_lifetime,
            -i,
        ),
    )


def first_input(inputs: dict[str, Floats], element: Element, answered: Sequence[Quantity]) -> str:
    """Return the input that the answer names as contributing most to an element.

    Where it names none, that over which the mean rank of the element varies most.
    """
    quantities = [quantity for quantity in answered if quantity.name == element.name]
    events = [event for quantity in quantities for event in quantity.events]
    rankings = [quantity.ranking for quantity in quantities] + [event.ranking for event in events]
    leaders = [ranking.leader for ranking in rankings if ranking is not None]
    named = [name for leader in leaders if leader for name in leader.inputs if name in inputs]
    return (named or leading(inputs, element))[0]


MOST_ROWS = 20_000
"""A page holds no more rows: a brush over them takes 0.1 s."""

MOST_NUMBERS = 480_000
"""Nor more numbers: they take 5 MB."""


_BYTES_OF_NUMBER = 8

QUARTERS = (
    "Of the chosen rows, the share in each quarter of all rows: 25 % each where an input makes no"
    " difference. Of 100 rows, a quarter holds between 17 and 34 % by chance alone, of 1000 between"
    " 22 and 28 %. The inputs that differ most come first."
)

_MISS, _HIT, _NO_PART, _UNKNOWN = range(4)


def rows_inside(
    findings: Findings, file: str, answered: Sequence[Quantity] = ()
) -> dict[str, Any] | None:
    """Return the rows of a result, for JSON.

    Parameters
    ----------
    findings : Findings
    file : str
        The name of the result.
    answered : sequence of Quantity, optional
        What is promised of its elements.

    Returns
    -------
    dict or None
        None where `why_no_rows` has a reason.
    """
    if why_no_rows(findings):
        return None
    analysis, whole, outputs = findings.result.analysis, findings.rows, _outputs(findings)
    inputs = independent_inputs(whole)
    numbers = len(inputs) + sum(1 for _ in whole.elements(outputs))
    rows = part_of(whole, numbers + ceil(len(inputs) * STOPS / _BYTES_OF_NUMBER))
    elements = list(population(rows, outputs))
    columns = [input_column(rows, name, findings.result.input_unit(name)) for name in inputs]
    columns += [output_column(rows, element, analysis) for element in elements]
    promises = {lead.name: lead.promise for lead in answered[:1] if lead.promise is not None}
    drawn = first_element(elements, answered, analysis)
    first = list(inputs).index(first_input(independent_inputs(rows), elements[drawn], answered))
    return {
        "model": rows.model_option,
        "file": shlex.quote(plain(file)),
        "extent": _extent(len(rows), len(whole)),
        "absence": _absence(len(rows), len(whole)),
        "allowed": [int(end(findings.result.dataset["row"].values)) for end in (np.min, np.max)],
        "numbers": encoded(rows.dataset["row"].values, "<i4"),
        "columns": columns,
        "categories": list(_categories(rows)),
        "events": [*_thresholds(rows, elements, analysis), *_regimes(rows)],
        "colours": {"rows": ROWS, "limit": LIMIT},
        "first": [first, len(inputs) + drawn],
        "tolerances": tolerances(rows, elements, promises),
        "note": _note(elements),
        "quarters_note": QUARTERS,
    }


def _extent(count: int, total: int) -> str:
    """Return which rows a page holds."""
    part = f" in this page, a random part of {grouped(total)}" if count < total else ""
    return "The only row." if count == 1 else printed(f"All {grouped(count)} rows{part}.")


def _absence(count: int, total: int) -> str:
    """Return why a page does not hold a row."""
    counted = "those that count in its statistics"
    part = f"a random part of {grouped(total)}" if count < total else counted
    words = (
        f"Not among the {grouped(count)} rows in this page, {part}; the command computes it again."
    )
    return printed(words)


def why_no_rows(findings: Findings) -> str:
    """Return why a page cannot compute with the rows of a result; "" where it can."""
    if findings.result.has_weights:
        return "Inspections have weighted the rows, and a page computes with rows that count alike."
    if not len(findings.rows):
        return f"No row of design '{findings.result.design_name}' follows the laws of the inputs."
    if any(findings.rows.elements(_outputs(findings))):
        return ""
    if any(findings.rows.elements(findings.result.shown_outputs(findings.result.analysis))):
        return "No row has a value of any output."
    return "The outputs are categories; there is no number to draw."


def _outputs(findings: Findings) -> list[str]:
    """Return the outputs that a page shows and some row has."""
    shown = findings.result.shown_outputs(findings.result.analysis)
    return [output for output in shown if output not in findings.absent]


def part_of(rows: Result, columns: int) -> Result:
    """Return rows, or if a page cannot hold as many, a random part of them: whole samples.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    columns : int
        Numbers of each row.

    Returns
    -------
    Result
        The same each time.
    """
    count = len(rows)
    most = min(MOST_ROWS, MOST_NUMBERS // columns)
    if count <= most:
        return rows
    part = rows.replicates
    sample = np.asarray(part) if isinstance(part, Clusters) else np.arange(count)
    names, size = np.unique(sample, return_counts=True)
    order = np.random.default_rng(int(rows.dataset.attrs["seed"])).permutation(len(names))
    chosen = names[order[np.cumsum(size[order]) <= most]]
    return rows.take(np.isin(sample, chosen))


def _thresholds(
    rows: Result, elements: Sequence[Element], analysis: AnalysisTable
) -> Iterator[dict[str, Any]]:
    """Yield the events whose probabilities the study asks for, with the side of each row."""
    for element in elements:
        for value in analysis.thresholds.get(element.output, ()):
            below = event_sides(element, value)
            yield {
                "key": event_key(element, value),
                "words": _asked(rows, element, value),
                "counted": ", counted" if _integrated(element) else "",
                "colour": None,
                "output": element.name,
                "sides": encoded(below, "u1"),
            }


def event_sides(element: Element, threshold: float) -> NDArray[np.uint8]:
    """Return on which side of a threshold each row lies, as the scripts number it."""
    rows = element.plain
    hits = rows.below(threshold) if element.is_lifetime else rows.above(threshold)
    sides = np.where(hits > 0, _HIT, _MISS).astype(np.uint8)
    sides[element.unknown_sides(threshold)] = _UNKNOWN
    sides[element.failed] = _NO_PART
    return sides


def _regimes(rows: Result) -> Iterator[dict[str, Any]]:
    """Yield the regimes as events; rows that failed without one take no part."""
    for category in _categories(rows):
        if category["name"] != REGIME:
            continue
        codes = rows.dataset[REGIME].values
        for entry in category["entries"]:
            if entry["code"] >= 0:
                sides = np.where(codes == entry["code"], _HIT, _MISS)
                sides[(codes < 0) & rows.failed] = _NO_PART
                yield {
                    "key": f"{REGIME}/{entry['label']}",
                    "words": f"in {entry['label']}",
                    "counted": "",
                    "colour": entry["colour"],
                    "output": None,
                    "sides": encoded(sides, "u1"),
                }


def _integrated(element: Element) -> tuple[str, ...]:
    """Return the inputs over which the answer and the tables integrate a life."""
    return () if element.law is None else element.law.inputs


def _asked(rows: Result, element: Element, value: float) -> str:
    """Return the event whose probability is asked for."""
    label = plain(printed(readable(element_in_words(rows, element))))
    at = threshold(value, element.units)
    if element.is_lifetime:
        does = "succeeds" if element.declared.success else "ends"
        return f"P({does} within {printed(at)}), {label}"
    return f"P({f'|{label}|' if element.is_angle else label} > {printed(at)})"


def _categories(rows: Result) -> Iterator[dict[str, Any]]:
    """Yield the regimes, and how rows ended: the labels that occur, and the place of each row's."""
    colours = {name: colour for name, (_, colour) in occurring_regimes(rows).items()}
    for name, label in ((REGIME, "Regime"), ("status", "Status")):
        if name not in rows.dataset:
            continue
        codes = rows.dataset[name].values
        occurring = [(code, words) for code, words in flags(rows.dataset[name]) if code in codes]
        places = [code for code, _ in occurring]
        yield {
            "name": name,
            "label": label,
            "places": encoded(sum(i * (codes == code) for i, code in enumerate(places)), "u1"),
            "entries": [
                {
                    "code": code,
                    "label": plain(words),
                    "count": printed(grouped(int((codes == code).sum()))),
                    "colour": colours.get(literal(words), ROWS) if name == REGIME else None,
                }
                for code, words in occurring
            ],
        }


def _note(elements: Sequence[Element]) -> str:
    """Return what a count is, beside the other numbers of a page."""
    integrated = dict.fromkeys(name for element in elements for name in _integrated(element))
    words = "Counted, without intervals: those of all rows stand under the outputs."
    if not integrated:
        return words
    names = " and ".join(map(called, integrated))
    return (
        f"{words} Each row is one life, as computed, as in tolerance bounds; other numbers of the"
        f" answer, the tables and other tolerances of one input integrate {names} exactly."
    )
