"""Convergence, variance by level, and fleets of as many units, in a report."""

from collections.abc import Iterator
from functools import partial
from typing import Any, cast

import pandas as pd

from uq.assess.answer.wording import NumberTarget, called
from uq.assess.convergence import errors_of
from uq.assess.findings import Findings
from uq.assess.fleet import Fleet
from uq.assess.fleet_numbers import Banded
from uq.assess.nested_table import SOURCES
from uq.errors import InputError
from uq.indices.index import S1
from uq.render.html.cells import Cell, HtmlTable, estimate_cell, without_empty_columns
from uq.render.html.indices import index_cell
from uq.render.html.outcomes import Outcome
from uq.render.html.pictures import pictures
from uq.sampling.levels import LEVELS
from uq.stats.estimate import interval_text, share_text, value_text
from uq.text.keys import key_of
from uq.text.numbers import counted, in_brackets, number, threshold
from uq.text.units import typical, unit_of


def convergence_of(findings: Findings, outcomes: list[Outcome]) -> dict[str, Any]:
    """Return the convergence of a result: errors, warnings and figures.

    Parameters
    ----------
    findings : Findings
    outcomes : list of Outcome
        Its outputs.

    Returns
    -------
    dict
        ``table``: the sampling error and the solver error of the rows, or None; ``warnings``;
        ``refused``: the reason why there are no running estimates, or ""; ``pictures``.
    """
    nothing: dict[str, Any] = {"table": None, "warnings": [], "pictures": []}
    if not outcomes:
        return nothing | {"refused": "there is no numeric output"}
    try:
        errors = errors_of(findings.result, outputs=findings.summary.outputs)
    except InputError as refused:
        return nothing | {"refused": str(refused)}
    lines = [
        (outcome, cast(pd.Series, errors.loc[outcome.name]))
        for outcome in outcomes
        if outcome.name in errors.index
    ]
    rows = [
        _row(outcome, line) for outcome, line in lines if line[["sampling", "own"]].notna().any()
    ]
    header = ("output", "unit", "estimate", "half-width of the interval", "error of the rows")
    return {
        "table": without_empty_columns(HtmlTable("Sampling error", header, rows)) if rows else None,
        "warnings": [
            f"{outcome.name}: {line['warning']}" for outcome, line in lines if line["warning"]
        ],
        "refused": findings.running.attrs.get("refused", ""),
        "pictures": list(pictures(findings, "convergence")),
    }


def _row(outcome: Outcome, errors: pd.Series) -> tuple[Cell, ...]:
    cells = (
        Cell(number(error / outcome.unit.size), key=error, traced=traced)
        if error == error
        else Cell("-")
        for name in ("sampling", "own")
        for error in [float(errors[name])]
        for traced in [key_of("outputs", outcome.name, f"{name}_error", verb="convergence")]
    )
    return (
        Cell(outcome.name, outcome.place),
        outcome.unit_cell,
        Cell(str(errors["estimate"])),
        *cells,
    )


def levels_of(findings: Findings) -> dict[str, Any] | None:
    """Return the variance components by level: sample size, table and notes.

    None if no sample has several rows, or if the rows are weighted.
    """
    if not findings.result.is_nested or findings.result.has_weights:
        return None
    decomposition = findings.levels
    rows, notes = [], []
    for name, shares in decomposition.outputs.items():
        shown = NumberTarget(findings.result, name).name
        cells = (
            index_cell(S1, shares.shares[source], key_of("outputs", name, source, verb="levels"))
            for source in SOURCES
        )
        rows.append((Cell(shown), *cells))
        notes += [f"{sentence} ({shown})" for sentence in shares.sentences]
    if (another := decomposition.another_regime) is not None:
        probability = another.reason or share_text(another)
        notes.append(f"probability that a repeat ends in another regime: {probability}")
    on = {level: decomposition.inputs_on(level) for level in LEVELS}
    notes += [f"{level}: {', '.join(map(called, names))}" for level, names in on.items() if names]
    table = HtmlTable("Shares of the variance", ("output", *SOURCES), rows)
    return {"size": decomposition.size, "table": table, "notes": notes}


HEADER = ("life", "quantity", "all samples", "5 % of samples", "95 % of samples")


def fleet_table(findings: Findings) -> HtmlTable | None:
    """Return the table of fleet lives of a result; None if each sample has a single unit."""
    fleets = findings.fleets
    if not fleets:
        return None
    rows = [row for fleet in fleets for row in _fleet_rows(fleet)]
    return HtmlTable(
        f"Fleets of {counted(fleets[0].size, 'unit')}, with 95 % intervals", HEADER, rows
    )


def fleet_notes(findings: Findings) -> list[str]:
    """Return notes on the integration, omissions and assumptions of the fleet numbers."""
    sentences = dict.fromkeys(note for fleet in findings.fleets for note in fleet.sentences)
    return list(sentences)


def _fleet_rows(fleet: Fleet) -> Iterator[tuple[Cell, ...]]:
    options = {"size": str(fleet.size), "output": fleet.output}
    traced = partial(key_of, verb="fleet", options=options)
    unit = unit_of(fleet.units, typical(banded.estimate.value for banded in fleet.first.values()))
    for p, banded in fleet.first.items():
        words = f"{100 * p:g} % quantile of the first{in_brackets(unit)}"
        yield _fleet_row(
            fleet.output, words, banded, traced("first", "quantiles", repr(p)), unit.size
        )
    for time, (failed, at_most) in fleet.by.items():
        by = f"{fleet.ended} by {threshold(time, fleet.units)}"
        of = ("by", repr(time))
        yield _fleet_row(fleet.output, f"number {by}", failed, traced(*of, "failed"))
        yield _fleet_row(fleet.output, f"P(none {by})", at_most, traced(*of, "at_most_allowed"))


def _fleet_row(
    name: str, quantity: str, banded: Banded, traced: str, per: float = 1.0
) -> tuple[Cell, ...]:
    ends = ((banded.estimate, ""), (banded.low, "/band_low"), (banded.high, "/band_high"))
    cells = (
        estimate_cell(
            value_text(end, per=per), interval_text(end, per) or end.reason, end, f"{traced}{last}"
        )
        for end, last in ends
    )
    return Cell(name), Cell(quantity), *cells
