"""The rows inside a page, with which its scripts (``live/``) compute."""

import shlex
from collections.abc import Iterator, Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.assess.answer.parts import Quantity
from uq.assess.answer.wording import called
from uq.assess.findings import Findings
from uq.assess.independent_inputs import independent_inputs
from uq.assess.scaling import population
from uq.assess.summary import REGIME
from uq.contract import Floats
from uq.render.figures.elements_plot import display_unit, occurring_regimes
from uq.render.figures.style import LIMIT, ROWS
from uq.render.figures.words import element_in_words, literal, meaning_of, symbol_beside, unbroken
from uq.render.html.axes import axis_of, common_digits
from uq.render.html.encoded import encoded
from uq.render.html.first_scatter import first_element, first_input
from uq.render.html.moved_laws import STOPS
from uq.render.html.symbols import parts_of
from uq.render.html.tolerances import event_key, tolerances
from uq.result.element import Element
from uq.result.elements import (
    flags,
)
from uq.result.result import Result
from uq.stats.clusters import Clusters
from uq.study.file import AnalysisTable
from uq.text.literals import plain
from uq.text.numbers import grouped, printed, threshold
from uq.text.symbols import readable
from uq.text.units import ReadableUnit

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

_ENDED, _CENSORED, _NEVER, _UNDEFINED, _FAILED = range(5)
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
    columns = [_input(rows, name, findings.result.input_unit(name)) for name in inputs]
    columns += [_output(rows, element, analysis) for element in elements]
    promises = {lead.name: lead.promise for lead in answered[:1] if lead.promise is not None}
    drawn = first_element(elements, answered, analysis)
    first = list(inputs).index(first_input(independent_inputs(rows), elements[drawn], answered))
    return {
        "model": rows.model_option,
        "file": shlex.quote(plain(file)),
        "extent": _extent(len(rows), len(whole)),
        "absence": _absence(len(rows), len(whole)),
        "allowed": _allowed(findings.result),
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


def _allowed(result: Result) -> list[int]:
    """Return the first and last number of a row, whether the page holds it or not."""
    numbers = result.dataset["row"].values
    return [int(numbers.min()), int(numbers.max())]


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


def _input(rows: Result, name: str, unit: ReadableUnit) -> dict[str, Any]:
    variable = rows.dataset[name]
    values = variable.values
    symbol = parts_of(symbol_beside(called(name), variable))
    column = _column(name, called(name), unit, values, np.zeros(len(values)), symbol)
    return column | {
        "role": "input",
        "meaning": plain(readable(meaning_of(variable))),
        "curve": "Share above each value",
        "lines": [],
        "quarters": np.quantile(values, (0.25, 0.5, 0.75)).tolist(),
    }


def _output(rows: Result, element: Element, analysis: AnalysisTable) -> dict[str, Any]:
    unit = display_unit(element.units, element.values)
    label = element_in_words(rows, element)
    column = _column(element.name, label, unit, element.values, _states(element), [""])
    asked = analysis.thresholds.get(element.output, ())
    lines = [
        side * float(value) for value in asked for side in ((-1, 1) if element.is_angle else (1,))
    ]
    axis = column["axis"]
    return column | {
        "role": "output",
        "meaning": "",
        "curve": _curve(element),
        "lines": [line for line in lines if axis["low"] <= line <= axis["high"]],
    }


def _curve(element: Element) -> str:
    """Return what the curve of an output shows."""
    if element.declared.success:
        return "Share that has not yet succeeded"
    return "Share that outlives each time" if element.is_lifetime else "Share above each value"


def _states(element: Element) -> NDArray[np.int_]:
    """Return how each row ended, as the scripts number it."""
    states = np.where(np.isposinf(element.values), _NEVER, _ENDED)
    states[element.censored] = _CENSORED
    states[np.isnan(element.values)] = _UNDEFINED
    states[element.failed] = _FAILED
    return states


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


def _column(
    name: str,
    words: str,
    unit: ReadableUnit,
    values: Floats,
    states: NDArray[Any],
    symbol: Sequence[str],
) -> dict[str, Any]:
    """Return a column of numbers: how it is called, written and drawn."""
    label = plain(printed(readable(words)))
    shown = "" if unit.name == "1" else plain(unbroken(unit.name))
    title = f"{label} ({symbol[0]})" if symbol[0] and len(symbol) == 1 else label
    axis = axis_of(values[states <= _CENSORED], unit.size)
    return {
        "name": name,
        "label": label,
        "symbol": symbol,
        "title": f"{title} [{shown}]" if shown else title,
        "after": _after(shown),
        "per": unit.size,
        "common": common_digits(axis),
        "axis": axis,
        "values": encoded(values, "<f8"),
        "states": encoded(states, "u1") if states.any() else None,
    }


def _after(unit: str) -> str:
    """Return a unit as it follows a number."""
    if unit in ("", "\N{DEGREE SIGN}"):
        return unit
    space = "\N{NO-BREAK SPACE}"
    return f"{space}\N{MULTIPLICATION SIGN}{space}{unit}" if unit.startswith("10") else f" {unit}"


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
