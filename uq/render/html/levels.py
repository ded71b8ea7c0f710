"""Variance by level in a report: shared, own, or due to chance."""

from typing import Any

from uq.assess.answer.number_targets import NumberTarget
from uq.assess.answer.wording import called
from uq.assess.findings import Findings
from uq.assess.variance_by_level import SOURCES
from uq.indices.index import S1
from uq.render.html.cells import Cell, HtmlTable
from uq.render.html.indices import index_cell
from uq.sampling.levels import LEVELS
from uq.stats.estimate_text import share_text
from uq.text.keys import key_of


def levels_of(findings: Findings) -> dict[str, Any] | None:
    """Return the shares of the variance by level: size of the sample, table and notes.

    None where no sample has several rows, or with weights.
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
