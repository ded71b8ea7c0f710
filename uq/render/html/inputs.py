"""The inputs in a report: laws, sources, and the quality of each number."""

from collections.abc import Iterator
from math import floor, log10

import numpy as np

from uq.assess.answer.wording import (
    DisplayUnit,
    mark_of,
    source_of,
    unit_of_input,
    without_source,
)
from uq.assess.sampled_laws import PROBABILITIES, compare, laws_and_values, weights_of_samples
from uq.contract import Floats
from uq.render.figures.words import meaning_of, symbol_of, unbroken
from uq.render.html.cells import Cell, HtmlTable, without_empty_columns
from uq.render.html.embedded_columns import indexed
from uq.result.result import Result
from uq.sampling.law import Law
from uq.study.file import Tied
from uq.text.keys import key_of
from uq.text.numbers import law_in_unit
from uq.text.units import PURE, beside, readable, symbol, unit_of


def input_tables(result: Result) -> Iterator[HtmlTable]:
    """Yield the tables of uncertain inputs and of rank correlations.

    Parameters
    ----------
    result : Result
        A result.

    Yields
    ------
    HtmlTable
    """
    yield _uncertain(result)
    study = result.study
    if study.dependence is not None:
        names, matrix = study.dependence.parameters, study.dependence.rank_correlation
        rows = [
            (Cell(f"{first}, {second}"), Cell(f"{matrix[i][j]:g}", key=matrix[i][j]))
            for i, first in enumerate(names)
            for j, second in enumerate(names[:i])
        ]
        source = study.dependence.source
        copula = f", {study.dependence.words}" if study.dependence.words else ""
        caption = f"Rank correlations{copula}{': ' if source else ''}{source}"
        yield HtmlTable(caption, ("pair", "stated"), rows)


def fixed_inputs(result: Result) -> HtmlTable | None:
    """Return the table of fixed inputs; None if there are none."""
    fixed = [
        name
        for name in result.dataset.data_vars
        if result.dataset[name].attrs.get("role") == "fixed"
    ]
    by_study = without_source(result)
    lines = [_fixed(result, str(name), name in by_study) for name in fixed]
    header = ("input", "value", "known", "source")
    return HtmlTable("Fixed inputs", header, lines) if lines else None


def _fixed(result: Result, name: str, by_study: bool) -> tuple[Cell, ...]:
    value = result.dataset[name].item()
    # The source in the model applies only to the nominal value.
    source = (
        (Cell(""), Cell("set in this study, under [fixed]")) if by_study else _source(result, name)
    )
    unit = unit_of(str(result.dataset[name].attrs["units"]), value)
    text = beside(f"{value / unit.size:.6g}", unbroken(unit.name)).replace(" ", "\u00a0")
    return (_name(result, name), Cell(text, key=value), *source)


def _uncertain(result: Result) -> HtmlTable:
    given, weights = laws_and_values(result), weights_of_samples(result)
    rows = []
    for name, entry in result.study.uncertain.items():
        quantiles = [Cell("")] * 3
        if name in given:
            law_of, _ = given[name]
            sampled = compare(*given[name], weights).sampled
            unit = unit_of_input(result, name) if law_of.times is None else DisplayUnit()
            quantiles = _quantiles(name, unit, sampled)
        rows.append(
            (
                _name(result, name),
                Cell(_law(result, name, entry)),
                *quantiles,
                *_source(result, name),
            )
        )
    header = ("input", "law", "5 % of rows", "50 %", "95 %", "known", "source")
    return without_empty_columns(HtmlTable("Uncertain inputs", header, rows))


def _quantiles(name: str, unit: DisplayUnit, quantiles: Floats) -> list[Cell]:
    """Return quantiles rounded to the digits that distinguish them."""
    step = np.ptp(quantiles) / unit.per / 30
    places = max(0, -floor(log10(step))) if step > 0 else 0
    texts = (
        f"{float(quantile) / unit.per:.{places}f}" if places else unit.number(quantile)
        for quantile in quantiles
    )
    return [
        Cell(
            beside(text, unit.name).replace(" ", "\u00a0"),
            key=float(quantile),
            traced=key_of(name, "sampled", repr(p), verb="inputs"),
        )
        for text, quantile, p in zip(texts, quantiles, PROBABILITIES, strict=True)
    ]


def _law(result: Result, name: str, entry: Law | Tied) -> str:
    if isinstance(entry, Tied):
        return f"equals {entry.equals}"
    if entry.times is not None:
        return f"{entry.times} times {law_in_unit(entry, PURE)}"
    return law_in_unit(entry, result.input_unit(name))


def _name(result: Result, name: str) -> Cell:
    words = readable(meaning_of(result.dataset[name]))
    written = indexed(symbol(symbol_of(result.dataset[name])))
    return Cell(name, written + f": {words}" if written else words)


def _source(result: Result, name: str) -> tuple[Cell, Cell]:
    return Cell(mark_of(result, name)), Cell(source_of(result, name))
