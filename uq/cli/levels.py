"""What ``uq levels`` shows."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path

from uq.analysis.apportioned import SOLVER, LevelShares
from uq.analysis.as_json import levels_json
from uq.analysis.level_shares import by_level
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.conclusions.targets import Target
from uq.designs.levels import LEVELS
from uq.methods.indices import S1
from uq.population.smoothing import worth_in_words
from uq.rows.results import open_result


def levels(result: Path, output: str | None, plain: bool, json: bool) -> None:
    """Show the shares of the variance by level."""
    ds = open_result(result)
    found = by_level(ds, output, plain=plain)
    if json:
        print_json(levels_json(found))
        return
    heading(str(ds.attrs["title"]), f"{ds.attrs['source']}, {found.size}")
    grid([(level, ", ".join(found.inputs_on(level)) or "-") for level in LEVELS])
    for name, shares in found.outputs.items():
        heading(f"\n{Target(ds, name).name}", "shares of the variance")
        grid(_lines(shares), header=("", "share", "95 % interval", ""))
        for text in shares.sentences:
            paragraph(text, indent=2)
    if (another := found.another_regime) is not None:
        heading("\nregime", "probability that a repeat ends in another")
        line = ("another regime", S1.text(another.value), S1.interval(another))
        grid([line], header=("", "probability", "95 % interval"))
        if another.reason:
            paragraph(another.reason, indent=2)
    if found.weights is not None:
        note(worth_in_words(found.weights))
    if any(isfinite(one.shares[SOLVER].value) for one in found.outputs.values()):
        note("the solver's share is contained in the others")


def _lines(one: LevelShares) -> Iterator[tuple[str, str, str, str]]:
    for name, share in one.shares.items():
        assumes = share.assumes.removeprefix("that ")
        yield name, S1.text(share.value), S1.interval(share), assumes
