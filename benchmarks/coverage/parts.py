"""The parts of the table: what can be counted by itself, each in a quarter of an hour or less."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from benchmarks.coverage import (
    basins,
    curves,
    dependent,
    differences,
    effects,
    few,
    fewer_rows,
    first_order,
    fleets,
    indices,
    joint,
    jumps,
    known_indices,
    lives,
    neighbours,
    nested,
    noise,
    plain,
    recorded,
    scaled,
    stopping,
    tails,
    whole,
)
from benchmarks.coverage.tally import Line

REPETITIONS = 2000


class Part(NamedTuple):
    """A part of the table.

    Attributes
    ----------
    count : callable
        ``count(repetitions)`` -> lines.
    repetitions : int
        Fewer where the other tools are expensive.
    """

    count: Callable[[int], list[Line]]
    repetitions: int = REPETITIONS


HSIC = ("hsic-target", "hsic-conditional")
NULLS = ("rbd-fast", "delta", "pawn", "regional", "quantile", "hdmr", *HSIC)

PARTS = {
    **{f"plain-{name}": Part(partial(plain.plain, name)) for name in plain.DESIGNS},
    "tails": Part(tails.means, 1000),
    "sd": Part(tails.scatters, 1000),
    "jumps": Part(jumps.means, 1000),
    "lives": Part(partial(lives.lives, "monte-carlo")),
    "lives-replicates": Part(partial(lives.lives, "latin-hypercube")),
    "lives-mixed": Part(partial(lives.mixed, "monte-carlo", 500)),
    "lives-mixed-few": Part(partial(lives.mixed, "monte-carlo", 100)),
    "lives-mixed-replicates": Part(partial(lives.mixed, "latin-hypercube", 128)),
    **{
        f"fit-{law}{'-censored' * censored}": Part(partial(lives.fits, law, censored))
        for law in lives.FITTED
        for censored in (False, True)
    },
    "fit-wrong": Part(curves.wrong_fits, 1000),
    **{
        f"recorded-{kind}": Part(partial(recorded.lives, kind, 60), 150 if kind == "own" else 500)
        for kind in recorded.KINDS
    },
    "recorded-many": Part(partial(recorded.lives, "late", 200), 200),
    **{
        f"recorded-causes-{kind}": Part(partial(recorded.causes, kind, 100))
        for kind in ("censored", "late")
    },
    **{
        f"recorded-{law}-{kind}": Part(partial(recorded.fits, law, kind, rows), repetitions)
        for law, rows, repetitions, kinds in recorded.FITS
        for kind in kinds
    },
    "bands": Part(curves.bands, 1000),
    **{
        f"bands-censored-{rows}": Part(partial(curves.censored_bands, rows), 1000)
        for rows in (30, 60, 200)
    },
    "sobol": Part(indices.sobol),
    "sobol-jump": Part(indices.sobol_of_jump),
    "sobol-others": Part(indices.sobol_of_others, 500),
    "sobol-scipy": Part(indices.sobol_of_scipy, 200),
    "sobol-g-function": Part(known_indices.g_function),
    "sobol-life": Part(known_indices.of_a_life),
    "shapley": Part(known_indices.shapley),
    "whole": Part(partial(whole.whole, "saltelli"), 1000),
    "whole-shapley": Part(partial(whole.whole, "shapley"), 1000),
    "shapley-dependent": Part(dependent.shapley, 1000),
    "shapley-neighbours": Part(neighbours.neighbours, 100),
    "shapley-waves": Part(partial(dependent.shapley, cases=dependent.WAVES), 1000),
    "shapley-waves-neighbours": Part(partial(neighbours.neighbours, cases=dependent.WAVES), 1000),
    "noise": Part(noise.noise),
    **{f"nested-{name}": Part(partial(nested.statistics, name), 1000) for name in nested.SIZES},
    **{f"levels-{name}": Part(partial(nested.effects, name)) for name in nested.EFFECTS},
    "levels-integrated": Part(nested.integrated),
    "levels-weighted": Part(nested.weighted),
    **{
        f"first-order-{rows}": Part(partial(first_order.rows, rows), 1000)
        for rows in first_order.ROWS
    },
    "first-order-replicates": Part(first_order.replicates, 300),
    "morris": Part(indices.morris),
    **{
        f"null-{name}": Part(partial(indices.nulls, name), 1000 if name in HSIC else REPETITIONS)
        for name in NULLS
    },
    "effects": Part(effects.average),
    "bootstraps": Part(indices.bootstraps, 200),
    "differences": Part(differences.differences),
    "joint-bounds": Part(joint.bounds),
    "twin": Part(fewer_rows.twin),
    "few-shares": Part(few.shares, 1000),
    "few-indices": Part(few.indices, 1000),
    "few-twin": Part(few.twin, 1000),
    "failed": Part(few.failed, 1000),
    "stopped": Part(partial(stopping.rows, "monte-carlo", 2048, 1)),
    "stopped-replicates": Part(partial(stopping.rows, "halton", 256, 8)),
    "stopped-integrated": Part(stopping.integrated),
    **{f"stopped-{name}": Part(partial(stopping.indices, name)) for name in stopping.INDICES},
    "stopped-shapley": Part(stopping.shapley),
    "subset": Part(fewer_rows.subset),
    "subset-plateau": Part(fewer_rows.plateau, 1000),
    "subset-others": Part(fewer_rows.subset_of_openturns, 200),
    "importance": Part(fewer_rows.importance),
    **{
        f"hidden-{method}": Part(partial(fewer_rows.hidden, method), 400)
        for method in ("subset", "importance")
    },
    "scaled": Part(scaled.scaled, 1000),
    "what-if": Part(scaled.what_if, 1000),
    **{f"fleet-{name}": Part(partial(fleets.fleets, name), 1000) for name in fleets.CASES},
    "fleet-shared": Part(fleets.shared_scale, 1000),
    **{
        f"fleet-law-{name.split()[0].lower()}": Part(partial(fleets.other_laws, name), 400)
        for name in fleets.LAWS
    },
    "basins": Part(basins.exponents, 1000),
}
