"""Variance by level in a report: shared, own, or due to chance."""

from typing import NamedTuple

from uq.assess.answer.number_targets import NumberTarget
from uq.assess.answer.wording import called
from uq.assess.findings import Findings
from uq.assess.variance_by_level import SOURCES
from uq.indices.index import S1
from uq.render.html.cells import SHARE, Cell, HtmlTable
from uq.sampling.levels import LEVELS
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import share_text
from uq.text.keys import key_of


class LevelTables(NamedTuple):
    """The shares of the variance by level.

    Attributes
    ----------
    size : str
        Samples, units and repeats.
    table : HtmlTable
    notes : list of str
    """

    size: str
    table: HtmlTable
    notes: list[str]


def levels_of(findings: Findings) -> LevelTables | None:
    """Return the shares of a result; None where no sample has several rows, or with weights."""
    if not findings.result.is_nested or findings.result.has_weights:
        return None
    decomposition = findings.levels
    rows, notes = [], []
    for name, shares in decomposition.outputs.items():
        shown = NumberTarget(findings.result, name).name
        rows.append(
            (Cell(shown), *(_cell(name, source, shares.shares[source]) for source in SOURCES))
        )
        notes += [f"{sentence} ({shown})" for sentence in shares.sentences]
    if (another := decomposition.another_regime) is not None:
        probability = another.reason or share_text(another)
        notes.append(f"probability that a repeat ends in another regime: {probability}")
    on = {level: decomposition.inputs_on(level) for level in LEVELS}
    notes += [f"{level}: {', '.join(map(called, names))}" for level, names in on.items() if names]
    return LevelTables(
        decomposition.size, HtmlTable("Shares of the variance", ("output", *SOURCES), rows), notes
    )


def _cell(name: str, source: str, share: Estimate) -> Cell:
    key = share.value if share.value == share.value else None
    traced = key_of("outputs", name, source, verb="levels")
    ends = (share.low, share.high)
    return Cell(S1.text(share.value), S1.interval(share), key, traced, SHARE, ends)
