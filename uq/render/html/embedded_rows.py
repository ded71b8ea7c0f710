"""The rows inside a page, with which its scripts (``live/``) compute."""

import base64
import shlex
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from uq.assess.answer.parts import Quantity
from uq.assess.answer.wording import called
from uq.assess.findings import Findings
from uq.assess.independent_inputs import independent_inputs
from uq.assess.scaling import population
from uq.render.figures.elements_plot import display_unit, occurring_regimes
from uq.render.figures.panel import is_wide
from uq.render.figures.style import LIMIT, ROWS
from uq.render.figures.words import element_in_words, literal, meaning_of, symbol_beside, unbroken
from uq.render.html.first_scatter import first_element, first_input
from uq.render.html.symbols import parts_of
from uq.render.html.tolerances import promised, tolerances
from uq.result.element import Element
from uq.result.elements import (
    flags,
)
from uq.result.result import Result
from uq.stats.clusters import Clusters
from uq.stats.intervals import upper_probability
from uq.stats.quantile_functions import student
from uq.study.file import AnalysisTable
from uq.text.literals import plain
from uq.text.numbers import printed, threshold
from uq.text.symbols import readable
from uq.text.units import ReadableUnit


def encoded(values: Any, kind: str) -> str:
    """Return an array as base64 of its bytes.

    Parameters
    ----------
    values : array-like
    kind : str
        NumPy's name of their type, such as ``"<f8"``.

    Returns
    -------
    str
    """
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


MOST_ROWS = 20_000
"""A page holds no more rows: a brush over them takes 0.1 s."""

MOST_NUMBERS = 480_000
"""Nor more numbers: they take 5 MB."""


_STUDENTS = 100
"""From so many independent parts on, an expansion has enough digits."""


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
    rows = part_of(whole, len(inputs) + sum(1 for _ in whole.elements(outputs)))
    elements = list(population(rows, outputs))
    columns = [_input(rows, name, findings.result.input_unit(name)) for name in inputs]
    promises = {one.name: one.promise for one in answered if one.promise is not None}
    columns += [
        _output(rows, one, analysis) | {"promised": list(promised(promises.get(one.name)))}
        for one in elements
    ]
    drawn = first_element(elements, answered, analysis)
    first = list(inputs).index(first_input(independent_inputs(rows), elements[drawn], answered))
    design = _design(rows)
    laws = tolerances(rows, elements)
    if integrated := dict.fromkeys(one for each in elements for one in _integrated(each)):
        names = " and ".join(map(called, integrated))
        design["intervals"] = (
            "Counted: each row is one life, as computed, as in tolerance bounds; other numbers of"
            f" the answer, the tables and other tolerances integrate {names} exactly."
            f" {design['intervals']}"
        )
    return {
        "model": rows.model_option,
        "file": shlex.quote(plain(file)),
        "total": len(whole),
        "allowed": _allowed(findings.result),
        "numbers": encoded(rows.dataset["row"].values, "<i4"),
        "failed": encoded(rows.failed, "u1"),
        "columns": columns,
        "categories": list(_categories(rows)),
        "colours": {"rows": ROWS, "limit": LIMIT},
        "first": [first, len(inputs) + drawn],
        "tolerances": laws,
        **design,
    }


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
    return [one for one in shown if one not in findings.absent]


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
    return _column(name, called(name), *unit, variable.values) | {
        "role": "input",
        "symbol": parts_of(symbol_beside(called(name), variable)),
        "meaning": plain(readable(meaning_of(variable))),
        "thresholds": [],
    }


def _output(rows: Result, element: Element, analysis: AnalysisTable) -> dict[str, Any]:
    unit, per = display_unit(element.units, element.values)
    column = _column(element.name, element_in_words(rows, element), unit, per, element.values)
    return column | {
        "role": "output",
        "life": element.is_lifetime,
        "success": bool(element.declared.success),
        "angle": element.is_angle,
        "counted": bool(_integrated(element)),
        "neverKnownAtOnce": element.declared.never_known_at_once,
        "censored": encoded(element.censored, "u1") if element.censored.any() else None,
        "thresholds": [
            {"value": value, "words": _asked(column, element, value)}
            for value in analysis.thresholds.get(element.output, ())
        ],
    }


def _integrated(element: Element) -> tuple[str, ...]:
    """Return the inputs over which the answer and the tables integrate a life."""
    return () if element.law is None else element.law.inputs


def _asked(column: Mapping[str, Any], element: Element, value: float) -> str:
    """Return the event whose probability is asked for."""
    at = threshold(value, element.units)
    if element.is_lifetime:
        does = "succeeds" if element.declared.success else "ends"
        return f"P({does} within {printed(at)}), {column['label']}"
    label = f"|{column['label']}|" if element.is_angle else column["label"]
    return f"P({label} > {printed(at)})"


def _column(name: str, words: str, unit: str, per: float, values: Any) -> dict[str, Any]:
    return {
        "name": name,
        "label": plain(printed(readable(words))),
        "unit": "" if unit == "1" else plain(unbroken(unit)),
        "per": per,
        "wide": is_wide(values[np.isfinite(values)]),
        "values": encoded(values, "<f8"),
    }


def _categories(rows: Result) -> Iterator[dict[str, Any]]:
    """Yield the regimes, and how rows ended."""
    colours = {name: colour for name, (_, colour) in occurring_regimes(rows).items()}
    for name, label in (("regime", "Regime"), ("status", "Status")):
        if name in rows.dataset:
            codes = rows.dataset[name].values
            counts = {code: int((codes == code).sum()) for code, _ in flags(rows.dataset[name])}
            yield {
                "name": name,
                "label": label,
                "codes": encoded(codes, "i1"),
                "entries": [
                    {
                        "code": code,
                        "label": plain(words),
                        "count": counts[code],
                        "colour": colours.get(literal(words), ROWS) if name == "regime" else None,
                    }
                    for code, words in flags(rows.dataset[name])
                    if counts[code]
                ],
            }


def _design(rows: Result) -> dict[str, Any]:
    """Return what intervals rest on, and a sentence that says so."""
    part = rows.replicates
    found: dict[str, Any] = {
        "independent": rows.has_independent_rows,
        "replicate": None,
        "sample": None,
        "samples": None,
        "parts": "rows",
    }
    several = "samples" if rows.has_independent_samples else "replicates"
    count = 0 if part is None else len(np.unique(part))
    if isinstance(part, Clusters):
        found |= {"sample": encoded(part, "<i4"), "samples": part.samples, "parts": several}
    elif part is not None and count > 1:
        found |= {"replicate": encoded(part, "<i4")}
    if part is None:
        words = (
            "95 % intervals of shares are Wilson's, or those of Clopper and Pearson where hits or"
            " misses are fewer than 20, and those of quantiles come from order statistics; where"
            " lives are censored, both rest on Greenwood's formula. The band is Kolmogorov's."
        )
    elif count < 2:
        words = f"No intervals: they rest on the scatter between {several}, of which there is one."
    else:
        words = f"95 % intervals rest on the scatter between {count} {several}."
    students = (student(upper_probability(), parts - 1) for parts in range(2, _STUDENTS))
    return found | {"students": [None, None, *students], "intervals": words}
