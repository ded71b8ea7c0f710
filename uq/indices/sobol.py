"""Sobol' indices of a crossed design, with confidence intervals from the replicates."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import combinations

import numpy as np

from uq.contract import Floats
from uq.indices.groups import (
    Values,
    effective_rows,
    one_more_row,
    pooled_with_intervals,
    widened,
    with_difference,
)
from uq.indices.index import S1, S2, ST, IndexKind, Indices, RefusedError
from uq.indices.method import NO_VARIANCE, UNSEEN, DesignSample
from uq.sampling.designs import NOISE

MIN_GROUPS = 8
"""Minimum number of groups for a useful index."""

_NOISE = IndexKind(NOISE, "share of noise", "variance")

Estimates = Callable[[Sequence[str], Floats], Values]
"""Block names and standardised groups of shape (n, blocks) -> indices."""


def sobol_indices(sample: DesignSample, estimates: Estimates | None = None) -> Indices:
    """Estimate first-order, total and, if the design allows, second-order Sobol' indices.

    Indices of an output with elements are aggregated [5]_: variances are summed over elements.

    Parameters
    ----------
    sample : DesignSample
        Sample of a crossed design.
    estimates : callable, optional
        Alternative estimators, for comparison.

    Returns
    -------
    Indices
        Indices pooled over all groups, with intervals from the scatter between replicates. If the
        variance rests on few rows, intervals are widened by the effect of one more such row. For a
        random model `noise` is the total index of the seed.

    Raises
    ------
    RefusedError
        The output is constant.

    Notes
    -----
    S1 is the estimator of [1]_ with a control variate after [2]_. ST is the estimator of [3]_, and
    S2 the estimator of [4]_. `benchmarks/estimators.py` compares them with others on the same rows.

    For a random model, A and AB_i share one seed, B and BA_i another. `NOISE` has the inputs of A
    and the seed of B. S1 and S2 are means of products of rows with different seeds: noise affects
    them only through the variance. ST is a mean squared difference at one seed: it includes the
    interaction of the input with the noise.

    References
    ----------
    .. [1] A. Janon, T. Klein, A. Lagnoux, M. Nodet, C. Prieur, "Asymptotic normality and efficiency
       of two Sobol index estimators", ESAIM: Probab. Stat. 18, 342-364 (2014).
    .. [2] G. Glen, K. Isaacs, "Estimating Sobol sensitivity indices using correlations", Environ.
       Model. Softw. 37, 157-166 (2012): spurious correlations are subtracted.
    .. [3] M. J. W. Jansen, "Analysis of variance designs for model output", Comput. Phys. Commun.
       117, 35-43 (1999).
    .. [4] A. Saltelli, "Making best use of model evaluations to compute sensitivity indices",
       Comput. Phys. Commun. 145, 280-297 (2002).
    .. [5] F. Gamboa, A. Janon, T. Klein, A. Lagnoux, "Sensitivity analysis for multidimensional
       and functional outputs", Electron. J. Stat. 8, 575-603 (2014).
    """
    y, whole = sample.grouped, sample.whole
    ends = [sample.blocks.index("A"), sample.blocks.index("B")]
    independent = y[whole][:, ends]
    if sample.is_constant(independent):
        raise RefusedError(NO_VARIANCE if sample.is_constant(y[whole]) else UNSEEN)
    # The estimators lose digits, and scatter more, for values far from zero (Sobol' 2001).
    y = (y - independent.mean(axis=(0, 1))) / np.sqrt(independent.var(axis=(0, 1)).sum())

    replicates = [group[rows] for group, rows in zip(y, whole, strict=True)]
    few = any(
        len(replicate) < 2 or sample.is_constant(replicate[:, ends]) for replicate in replicates
    )
    lacking = "in some replicates too few rows differ" if few else ""
    of_blocks = partial(estimates or _estimates, sample.blocks)
    estimate = with_difference(of_blocks, sample.difference)
    pooled, notes = pooled_with_intervals(
        estimate, y[whole], replicates, "indices", lacking, sample.confidence
    )
    independent = y[whole][:, ends].reshape(-1, *y.shape[3:])
    given = not notes
    more = one_more_row(independent, int(whole.sum()), len(replicates), sample.confidence)
    if more and given:
        rows = effective_rows(independent) / len(replicates)
        notes += (
            f"the variance rests on about {rows:.2g} rows of each replicate: intervals are widened"
            " by the effect of one more such row, and are conservative",
        )
    indices = {
        kind: {label: widened(estimate, more) for label, estimate in values.items()}
        for kind, values in pooled.items()
    }
    noise = indices.pop(_NOISE, {}).get("")
    inert = [name for name, total in indices[ST].items() if total.value == 0]
    if inert:
        notes += (f"no effect in any row, hence no interval: {', '.join(inert)}",)
    alike = [
        name for name, total in indices[ST].items() if not (name in inert or total.has_interval)
    ]
    if alike and given:
        notes += (f"the same ST in each replicate, hence no interval: {', '.join(alike)}",)
    return Indices(indices, notes, noise=noise)


def _parameters(blocks: Sequence[str]) -> list[str]:
    return [label.removeprefix("AB_") for label in blocks if label.startswith("AB_")]


def _estimates(blocks: Sequence[str], y: Floats) -> Values:
    """Return each index from groups y, shape (n, blocks) or (n, blocks, e)."""
    block = dict(zip(blocks, np.moveaxis(y, 1, 0), strict=True))
    a, b, names = block["A"], block["B"], _parameters(blocks)
    indices = {
        S1: {name: first_order(a, block[f"AB_{name}"], b) for name in names},
        ST: {name: total_order(a, block[f"AB_{name}"], b) for name in names},
    }
    if NOISE in block:
        indices[_NOISE] = {"": total_order(a, block[NOISE], b)}
    if any(label.startswith("BA_") for label in block):
        indices[S2] = {
            f"{first},{second}": second_order(
                a, block[f"AB_{first}"], block[f"AB_{second}"], block[f"BA_{first}"], b
            )
            for first, second in combinations(names, 2)
        }
    return indices


def first_order(a: Floats, ab: Floats, b: Floats) -> float:
    """Return the first-order index S1 from the blocks A, AB_i and B.

    It is the mean product of B and AB_i, which share input i, divided by the variance of these rows
    (Janon et al. 2014). The product of A and B has mean zero and is used as control variate: the
    spurious correlation of B and AB_i is their spurious correlation with A times the correlation of
    A and AB_i, which is 1 - ST (Glen & Isaacs 2012).
    """
    a, ab, b = (block - block.mean(axis=0) for block in (a, ab, b))
    apart, spread = np.mean((a - ab) ** 2, axis=0) / 2, np.var(np.r_[a, ab], axis=0)
    alike = 1 - np.divide(apart, spread, out=np.zeros_like(apart), where=spread > 0)
    return _share(np.mean(b * (ab - alike * a), axis=0), b, ab)


def total_order(a: Floats, ab: Floats, b: Floats) -> float:
    """Return the total index ST from the blocks A, AB_i and B (Jansen 1999)."""
    return _share(0.5 * np.mean((a - ab) ** 2, axis=0), a, b)


def second_order(a: Floats, ab: Floats, ab_other: Floats, ba: Floats, b: Floats) -> float:
    """Return the second-order index S2 from A, AB_i, AB_j, BA_i and B (Saltelli 2002)."""
    parts = (ba * ab_other - a * b, b * (ab - a), b * (ab_other - a))
    both, first, second = (_share(np.mean(part, axis=0), a, b) for part in parts)
    return both - first - second


def _share(part: Floats, a: Floats, b: Floats) -> float:
    """Return a variance part divided by the total variance; 0 if the total is only rounding."""
    variance = np.var(np.r_[a, b], axis=0).sum()
    return float(part.sum() / variance) if variance > np.finfo(float).eps else 0.0


def pilot(sample: DesignSample) -> dict[IndexKind, float]:
    """Return the largest standard deviation, over inputs, of a group's term in S1 and in ST.

    Parameters
    ----------
    sample : DesignSample
        A few groups of a crossed design, including complete ones.

    Returns
    -------
    dict of IndexKind to float
    """
    y = sample.grouped[sample.whole]
    block = dict(zip(sample.blocks, ((y - y.mean()) / y.std()).T, strict=True))
    mixed = [block[f"AB_{name}"] for name in _parameters(sample.blocks)]
    a, b = block["A"], block["B"]
    spread: dict[IndexKind, list[float]] = {S1: [], ST: []}
    for ab in mixed:
        apart = (a - ab) ** 2 / 2
        product = b * (ab - (1 - apart.mean()) * a)
        # Linearised ratio of means.
        spread[S1].append(np.std(product - product.mean() * (b**2 + ab**2) / 2))
        spread[ST].append(np.std(apart))
    return {kind: max(deviations) for kind, deviations in spread.items()}
