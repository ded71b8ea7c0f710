"""Terminal output of ``uq levels``."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path

from uq.assess.answer.number_targets import NumberTarget
from uq.assess.level_shares import by_level
from uq.assess.summary_json import levels_facts
from uq.assess.variance_by_level import SOLVER, LevelShares
from uq.cli.printing import grid, heading, note, paragraph, print_json, title
from uq.indices.index import S1
from uq.result.result import Result
from uq.sampling.levels import LEVELS
from uq.stats.importance_weights import worth_in_words


def levels(result: Path, output: str | None, plain: bool, json: bool) -> None:
    """Show the shares of the variance by level."""
    opened = Result.open(result)
    decomposition = by_level(opened, output, plain=plain)
    if json:
        print_json(levels_facts(decomposition).json)
        return
    title(opened, decomposition.size)
    grid([(level, ", ".join(decomposition.inputs_on(level)) or "-") for level in LEVELS])
    for name, shares in decomposition.outputs.items():
        heading(f"\n{NumberTarget(opened, name).name}", "shares of the variance")
        grid(_share_lines(shares), header=("", "share", "95 % interval", ""))
        for text in shares.sentences:
            paragraph(text, indent=2)
    if (another := decomposition.another_regime) is not None:
        heading("\nregime", "probability that a repeat ends in another")
        line = ("another regime", S1.text(another.value), S1.interval(another))
        grid([line], header=("", "probability", "95 % interval"))
        if another.reason:
            paragraph(another.reason, indent=2)
    if decomposition.weights is not None:
        note(worth_in_words(decomposition.weights))
    if any(isfinite(shares.shares[SOLVER].value) for shares in decomposition.outputs.values()):
        note("the solver's share is contained in the others")


def _share_lines(level_shares: LevelShares) -> Iterator[tuple[str, str, str, str]]:
    for name, share in level_shares.shares.items():
        assumes = share.assumes.removeprefix("that ")
        yield name, S1.text(share.value), S1.interval(share), assumes
