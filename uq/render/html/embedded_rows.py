"""Rows inside a page, with which its scripts (``live/``) compute."""

import shlex
from collections.abc import Iterator, Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.assess.answer.quantities import Quantity
from uq.assess.answer.wording import called
from uq.assess.findings import Findings
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.row_inputs import independent_inputs
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
from uq.study.file import AnalysisTable
from uq.text.literals import plain
from uq.text.numbers import grouped, printed, threshold
from uq.text.units import readable


def first_element(
    elements: Sequence[Element], answered: Sequence[Quantity], analysis: AnalysisTable
) -> int:
    """Return the index of the element shown first.

    Parameters
    ----------
    elements : sequence of Element
    answered : sequence of Quantity
        Quantities, the study's main quantity first.
    analysis : AnalysisTable

    Returns
    -------
    int
        Without an answer, the index of an element in the study's analysis, preferably a life.
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
    """Return the main driver of an element according to the answer.

    If the answer names none, return the input over which the element's mean rank varies most.
    """
    quantities = [quantity for quantity in answered if quantity.name == element.name]
    events = [event for quantity in quantities for event in quantity.events]
    rankings = [quantity.ranking for quantity in quantities] + [event.ranking for event in events]
    leaders = [ranking.leader for ranking in rankings if ranking is not None]
    named = [name for leader in leaders if leader for name in leader.inputs if name in inputs]
    return (named or leading(inputs, element))[0]


MOST_ROWS = 20_000
"""Maximum number of rows in a page, over which a brush takes 0.1 s."""

MOST_NUMBERS = 480_000
"""Maximum number of values in a page, which take 5 MB."""


_BYTES_OF_NUMBER = 8

QUARTERS = (
    "Of the chosen rows, the share in each quarter of all rows: 25 % each where an input makes no"
    " difference. Of 100 rows, a quarter contains 17 to 34 % by chance alone, of 1000 between"
    " 22 and 28 %. The inputs that differ most come first."
)

_MISS, _HIT, _NO_PART, _UNKNOWN = range(4)


def rows_inside(
    findings: Findings, file: str, answered: Sequence[Quantity] = ()
) -> dict[str, Any] | None:
    """Return the rows of a result as plain data for JSON.

    Parameters
    ----------
    findings : Findings
    file : str
        Name of the result file.
    answered : sequence of Quantity, optional
        Quantities of the answer, with the tolerance bounds of elements.

    Returns
    -------
    dict or None
        None if `why_no_rows` returns a reason.
    """
    if why_no_rows(findings):
        return None
    analysis, whole, outputs = findings.result.analysis, findings.rows, _outputs(findings)
    inputs = independent_inputs(whole)
    numbers = len(inputs) + sum(1 for _ in whole.elements(outputs))
    rows = part_of(whole, numbers + ceil(len(inputs) * STOPS / _BYTES_OF_NUMBER))
    elements = list(elements_with_laws(rows, outputs))
    columns = [input_column(rows, name, findings.result.input_unit(name)) for name in inputs]
    columns += [output_column(rows, element, analysis) for element in elements]
    tolerance_bounds = {
        lead.name: lead.tolerance_bound for lead in answered[:1] if lead.tolerance_bound is not None
    }
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
        "tolerances": tolerances(rows, elements, tolerance_bounds),
        "note": _note(elements),
        "quarters_note": QUARTERS,
    }


def _extent(count: int, total: int) -> str:
    """Return the description of the rows included in a page."""
    part = f" in this page, a random part of {grouped(total)}" if count < total else ""
    return "The only row." if count == 1 else printed(f"All {grouped(count)} rows{part}.")


def _absence(count: int, total: int) -> str:
    """Return the reason why a page excludes a row."""
    counted = "those that count in its statistics"
    part = f"a random part of {grouped(total)}" if count < total else counted
    words = (
        f"Not among the {grouped(count)} rows in this page, {part}; the command computes it again."
    )
    return printed(words)


def why_no_rows(findings: Findings) -> str:
    """Return the reason why a page cannot compute with the rows of a result; "" if it can."""
    if findings.result.has_weights:
        by_inspections = not findings.result.has_next_rows
        why = "Inspections have weighted the rows" if by_inspections else "The rows have weights"
        return f"{why}, and a page needs rows of equal weight."
    if not len(findings.rows):
        return f"No row of design '{findings.result.design_name}' follows the laws of the inputs."
    if findings.result.is_field_record and not independent_inputs(findings.rows):
        return "The rows have no inputs to explore."
    elements = list(findings.rows.elements(_outputs(findings)))
    if any(element.entered is not None for element in elements):
        return "Rows that came under observation late do not represent all lives."
    if elements:
        return ""
    if any(findings.rows.elements(findings.result.shown_outputs(findings.result.analysis))):
        return "No row has a value of any output."
    return "The outputs are categories; there is no number to draw."


def _outputs(findings: Findings) -> list[str]:
    """Return the outputs shown in a page that have at least one value."""
    shown = findings.result.shown_outputs(findings.result.analysis)
    return [output for output in shown if output not in findings.absent]


def part_of(rows: Result, columns: int) -> Result:
    """Return the rows, or a random subset of complete samples if there are too many for a page.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    columns : int
        Number of values per row.

    Returns
    -------
    Result
        The selection is deterministic.
    """
    count = len(rows)
    most = min(MOST_ROWS, MOST_NUMBERS // columns)
    if count <= most:
        return rows
    labels = rows.dependence.labels
    sample = np.arange(count) if labels is None or rows.dependence.samples is None else labels
    names, size = np.unique(sample, return_counts=True)
    order = np.random.default_rng(int(rows.dataset.attrs["seed"])).permutation(len(names))
    chosen = names[order[np.cumsum(size[order]) <= most]]
    return rows.take(np.isin(sample, chosen))


def _thresholds(
    rows: Result, elements: Sequence[Element], analysis: AnalysisTable
) -> Iterator[dict[str, Any]]:
    """Yield the events whose probabilities the study requests, with the side of each row."""
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
    """Return the side of a threshold for each row, as coded in the scripts."""
    rows = element.plain
    hits = rows.below(threshold) if element.is_lifetime else rows.above(threshold)
    sides = np.where(hits > 0, _HIT, _MISS).astype(np.uint8)
    sides[element.unknown_sides(threshold)] = _UNKNOWN
    sides[element.failed] = _NO_PART
    return sides


def _regimes(rows: Result) -> Iterator[dict[str, Any]]:
    """Yield the regimes as events; failed rows without a regime are excluded."""
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
    """Return the inputs over which the answer and the tables integrate a life analytically."""
    return () if element.law is None else element.law.inputs


def _asked(rows: Result, element: Element, value: float) -> str:
    """Return the event whose probability is requested."""
    label = plain(printed(readable(element_in_words(rows, element))))
    at = threshold(value, element.units)
    if element.is_lifetime:
        does = "succeeds" if element.declared.success else "ends"
        return f"P({does} within {printed(at)}), {label}"
    return f"P({f'|{label}|' if element.is_angle else label} > {printed(at)})"


def _categories(rows: Result) -> Iterator[dict[str, Any]]:
    """Yield regimes and row status: the occurring labels, and the index of each row's label."""
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
    """Return the note that explains counts beside the other numbers of a page."""
    integrated = dict.fromkeys(name for element in elements for name in _integrated(element))
    words = "Counted, without intervals: intervals of all rows are under the outputs."
    if not integrated:
        return words
    names = " and ".join(map(called, integrated))
    return (
        "Chosen rows are counted, without intervals; each is one life, as computed, as in tolerance"
        " bounds. Where no row is chosen, probabilities of a life are those of the answer, which"
        f" integrate {names} exactly."
    )
