"""How the rows of a design belong together: what its sensitivity methods need to know of it."""

from collections.abc import Callable
from dataclasses import dataclass

from uq.designs import seeds

NOISE = "noise"
"""The block of a crossed design of a random model that has the inputs of A and the seed of B."""


@dataclass(frozen=True)
class Layout:
    """How rows are grouped.

    Attributes
    ----------
    needs : str
        What a group needs for an estimate to use it, as in "3 of 8 *paths are whole*".
    labels : callable
        ``labels(parameters, second_order, random)`` -> the names of the blocks of rows, in order.
    shared_seeds : callable
        Which rows of a random model share a seed; see `uq.designs.seeds`.
    one_at_a_time : bool
        Whether each row of a group differs from the one before it in one input.
    by_block : bool
        Whether the rows of one block are a group, instead of one row of each.
    """

    needs: str
    labels: Callable[[tuple[str, ...], bool, bool], tuple[str, ...]]
    shared_seeds: seeds.Rule
    one_at_a_time: bool = False
    by_block: bool = False


def _sample(parameters: tuple[str, ...], second_order: bool, random: bool) -> tuple[str, ...]:
    return ("sample",)


def _crossed(parameters: tuple[str, ...], second_order: bool, random: bool) -> tuple[str, ...]:
    mirrored = [f"BA_{name}" for name in parameters] if second_order else []
    noise = [NOISE] if random else []
    return ("A", *(f"AB_{name}" for name in parameters), *mirrored, "B", *noise)


def _steps(parameters: tuple[str, ...], second_order: bool, random: bool) -> tuple[str, ...]:
    return tuple(f"step_{i}" for i in range(len(parameters) + 1))


def _places(parameters: tuple[str, ...], second_order: bool, random: bool) -> tuple[str, ...]:
    return ("A", *(f"AB_{i}" for i in range(1, len(parameters))), "B")


def _curves(parameters: tuple[str, ...], second_order: bool, random: bool) -> tuple[str, ...]:
    return tuple(f"curve_{name}" for name in parameters)


PLAIN = Layout("rows have a value", _sample, seeds.own)
CROSSED = Layout("groups are whole", _crossed, seeds.of_ends)
TRAJECTORIES = Layout("trajectories are whole", _steps, seeds.of_groups, one_at_a_time=True)
PATHS = Layout("paths are whole", _places, seeds.of_groups, one_at_a_time=True)
CURVES = Layout("curves are whole", _curves, seeds.of_curves, by_block=True)
