"""The designs by name.

To add one: a function that draws its points, and an entry here with its properties and the layout
of its rows, which determines the sensitivity methods it feeds.
"""

from functools import partial

from uq.sampling.design import Design
from uq.sampling.layouts import CROSSED, CURVES, PATHS, TRAJECTORIES
from uq.sampling.unit_cube import (
    LEAST_POINTS,
    MOST_OF_SOBOL,
    POOL,
    fast_curves,
    halton,
    latin_hypercube,
    monte_carlo,
    morris_trajectories,
    paths,
    random_balance,
    sobol,
)

DESIGNS = {
    "monte-carlo": Design("independent rows", monte_carlo, independent=True, nests=True),
    "latin-hypercube": Design(
        "each input stratified into as many slices as samples",
        latin_hypercube,
        append_only=False,
        nests=True,
    ),
    "sobol": Design(
        "scrambled Sobol' sequence, samples a power of two",
        sobol,
        power_of_two=True,
        nests=True,
        most_inputs=MOST_OF_SOBOL,
    ),
    "halton": Design("scrambled Halton sequence", halton, nests=True),
    "saltelli": Design(
        "scrambled Sobol' sequence crossed for Sobol' indices, samples a power of two",
        sobol,
        CROSSED,
        power_of_two=True,
    ),
    "morris": Design(
        "trajectories that change one input at a time, for screening with few rows",
        morris_trajectories,
        TRAJECTORIES,
        append_only=False,
        follows_laws=False,
        least=2,
    ),
    "morris-optimised": Design(
        "trajectories chosen far apart, which favours the corners of the inputs",
        partial(morris_trajectories, pool=POOL),
        TRAJECTORIES,
        append_only=False,
        follows_laws=False,
        least=2,
        caution="trajectories chosen far apart favour the corners of the inputs: the effects are"
        " theirs, tens of per cent off those of all trajectories, which the design 'morris'"
        " estimates",
    ),
    "shapley": Design(
        "paths from one independent row to another, for Shapley effects", paths, PATHS
    ),
    "fast": Design(
        "a curve through the inputs for each of them, for extended FAST",
        fast_curves,
        CURVES,
        append_only=False,
        least=LEAST_POINTS,
    ),
    "rbd-fast": Design(
        "one curve shuffled for each input, for RBD-FAST", random_balance, append_only=False
    ),
    "imported": Design(
        "the rows of a CSV or netCDF file, in the parameters' units", None, append_only=False
    ),
}

IMPORTED = tuple(name for name, design in DESIGNS.items() if design.imported)
"""Designs whose rows come from a file."""


def several(key: str, method: str, count: int = 2) -> str:
    """Return the remedy in [design] that gives samples several ``units`` or ``repeats``."""
    if DESIGNS[method].nests:
        return f"set {key} = {count}"
    able = " or ".join(f"'{name}'" for name, design in DESIGNS.items() if design.nests)
    return f"set {key} = {count} and method = {able}, since samples of '{method}' have one row"
