"""Sobol' indices of a crossed design, with intervals from the replicates."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import combinations

import numpy as np

from uq.designs.layouts import NOISE
from uq.methods.groups import (
    Values,
    effective_rows,
    one_more_row,
    pooled_with_intervals,
    widened,
    with_difference,
)
from uq.methods.indices import S1, S2, ST, IndexKind, Indices, RefusedError
from uq.methods.method import NO_VARIANCE
from uq.methods.sample import Floats, Sample

MIN_GROUPS = 8
"""Fewer groups than this do not give a useful index."""

_NOISE = IndexKind(NOISE, "share of noise", "variance")

Estimates = Callable[[Sequence[str], Floats], Values]
"""Names of the blocks, and groups of shape (n, blocks), standardised -> indices."""


def sobol_indices(sample: Sample, estimates: Estimates | None = None) -> Indices:
    """Estimate first-order, total and, where the design has them, second-order indices.

    Those of a whole output are aggregated [2]_: parts of the variance are summed over its elements.

    Parameters
    ----------
    sample : Sample
        Of a crossed design.
    estimates : callable, optional
        Estimators to compare with those below.

    Returns
    -------
    Indices
        Pooled over all groups, with intervals from the scatter between replicates. Where the
        variance rests on few rows, intervals are widened by the effect of one more such row. For a
        random model `noise` is the total index of the seed.

    Raises
    ------
    RefusedError
        A constant output.

    Notes
    -----
    For a random model A and AB_i share a seed, B and BA_i another, and `NOISE` has the inputs of A
    and the seed of B. S1 and S2 are means of products of rows with different seeds, which noise
    enters through the variance alone. ST is a mean square of differences at one seed: of the noise
    it includes the interaction with the input.

    References
    ----------
    .. [1] A. Saltelli et al., "Variance based sensitivity analysis of model output. Design and
       estimator for the total sensitivity index", Comput. Phys. Commun. 181, 259-270 (2010).
    .. [2] F. Gamboa, A. Janon, T. Klein, A. Lagnoux, "Sensitivity analysis for multidimensional
       and functional outputs", Electron. J. Stat. 8, 575-603 (2014).
    """
    y, whole = sample.grouped, sample.whole
    ends = [sample.blocks.index("A"), sample.blocks.index("B")]
    independent = y[whole][:, ends]
    if sample.is_constant(independent):
        raise RefusedError(NO_VARIANCE)
    # The estimators lose digits, and scatter more, for values far from zero (Sobol' 2001).
    y = (y - independent.mean(axis=(0, 1))) / np.sqrt(independent.var(axis=(0, 1)).sum())

    replicates = [group[rows] for group, rows in zip(y, whole, strict=True)]
    few = any(len(own) < 2 or sample.is_constant(own[:, ends]) for own in replicates)
    lacking = "in some replicates too few rows differ" if few else ""
    of_blocks = partial(estimates or _estimates, sample.blocks)
    estimate = with_difference(of_blocks, sample.difference)
    found, notes = pooled_with_intervals(
        estimate, y[whole], replicates, "indices", lacking, sample.confidence
    )
    independent = y[whole][:, ends].reshape(-1, *y.shape[3:])
    more = one_more_row(independent, int(whole.sum()), len(replicates), sample.confidence)
    if more and not notes:
        rows = effective_rows(independent) / len(replicates)
        notes += (
            f"the variance rests on about {rows:.2g} rows of each replicate: intervals are widened"
            " by the effect of one more such row, and are conservative",
        )
    indices = {
        kind: {label: widened(estimate, more) for label, estimate in values.items()}
        for kind, values in found.items()
    }
    noise = indices.pop(_NOISE, {}).get("")
    inert = [name for name, total in indices[ST].items() if total.value == 0]
    if inert:
        notes += (f"no effect in any row, hence no interval: {', '.join(inert)}",)
    return Indices(indices, notes, noise=noise)


def _parameters(blocks: Sequence[str]) -> list[str]:
    return [label.removeprefix("AB_") for label in blocks if label.startswith("AB_")]


def _estimates(blocks: Sequence[str], y: Floats) -> Values:
    """Return each index from groups y, shape (n, blocks) or (n, blocks, e)."""
    block = dict(zip(blocks, np.moveaxis(y, 1, 0), strict=True))
    a, b, names = block["A"], block["B"], _parameters(blocks)
    found = {
        S1: {name: first_order(a, block[f"AB_{name}"], b) for name in names},
        ST: {name: total_order(a, block[f"AB_{name}"], b) for name in names},
    }
    if NOISE in block:
        found[_NOISE] = {"": total_order(a, block[NOISE], b)}
    if any(label.startswith("BA_") for label in block):
        found[S2] = {
            f"{one},{other}": second_order(
                a, block[f"AB_{one}"], block[f"AB_{other}"], block[f"BA_{one}"], b
            )
            for one, other in combinations(names, 2)
        }
    return found


def first_order(a: Floats, ab: Floats, b: Floats) -> float:
    """Return S1 from the blocks A, AB_i and B: Saltelli et al. (2010), Table 2 (b)."""
    return _share(np.mean(b * (ab - a), axis=0), a, b)


def total_order(a: Floats, ab: Floats, b: Floats) -> float:
    """Return ST from the blocks A, AB_i and B: Jansen (1999), Table 2 (f) there."""
    return _share(0.5 * np.mean((a - ab) ** 2, axis=0), a, b)


def second_order(a: Floats, ab: Floats, ab_other: Floats, ba: Floats, b: Floats) -> float:
    """Return S2 from the blocks A, AB_i, AB_j, BA_i and B: Saltelli (2002)."""
    both = _share(np.mean(ba * ab_other - a * b, axis=0), a, b)
    return both - first_order(a, ab, b) - first_order(a, ab_other, b)


def _share(part: Floats, a: Floats, b: Floats) -> float:
    """Return a part of the variance over all of it; 0 where there is none but by rounding."""
    variance = np.var(np.r_[a, b], axis=0).sum()
    return float(part.sum() / variance) if variance > np.finfo(float).eps else 0.0


def pilot(sample: Sample) -> dict[IndexKind, float]:
    """Return the largest standard deviation, over inputs, of a group's share in S1 and in ST.

    Parameters
    ----------
    sample : Sample
        A few groups of a crossed design, of which some are whole.

    Returns
    -------
    dict of IndexKind to float
    """
    y = sample.grouped[sample.whole]
    block = dict(zip(sample.blocks, ((y - y.mean()) / y.std()).T, strict=True))
    mixed = [block[f"AB_{name}"] for name in _parameters(sample.blocks)]
    return {
        S1: max(np.std(block["B"] * (one - block["A"])) for one in mixed),
        ST: max(np.std(0.5 * (block["A"] - one) ** 2) for one in mixed),
    }
