"""Sobol' indices of a crossed design: SALib's estimators, intervals from the replicates."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from uq.designs.layouts import NOISE
from uq.estimate import Estimate
from uq.intervals import is_constant
from uq.methods.few_rows import effective_rows, one_more_row, widened
from uq.methods.groups import by_replicates
from uq.methods.indices import S1, S2, ST, Indices, Kind, RefusedError
from uq.methods.method import NO_VARIANCE
from uq.methods.sample import Floats, Sample

MIN_GROUPS = 8
"""Fewer groups than this give no index worth the name."""

_NOISE = Kind(NOISE, "share of noise", "variance")


def sobol_indices(sample: Sample) -> Indices:
    """Estimate first-order, total and, where the design has them, second-order indices.

    Parameters
    ----------
    sample : Sample
        Of a crossed design.

    Returns
    -------
    Indices
        From all groups together; the interval from the same estimate by replicates. Where the
        variance rests on few rows, it is widened by what one more such row might do. Of a random
        model `noise` is the total index of the seed.

    Raises
    ------
    RefusedError
        A constant output.

    Notes
    -----
    Of a random model A and AB_i share a seed, B and BA_i another, and `NOISE` has the inputs of A
    and the seed of B. S1 and S2 are means of products of rows of both seeds, which noise enters
    through the variance alone. ST is a mean square of differences at one seed: of the noise it
    holds what it does together with the input.

    References
    ----------
    A. Saltelli et al., "Variance based sensitivity analysis of model output. Design and estimator
    for the total sensitivity index", Comput. Phys. Commun. 181, 259-270 (2010).
    """
    y, whole = sample.values[sample.groups], sample.whole
    ends = [sample.blocks.index("A"), sample.blocks.index("B")]
    independent = y[whole][:, ends]
    if is_constant(independent):
        raise RefusedError(NO_VARIANCE)
    # The estimators lose digits, and scatter more, on values far from zero (Sobol' 2001).
    y = (y - independent.mean()) / independent.std()

    replicates = [group[rows] for group, rows in zip(y, whole, strict=True)]
    few = any(len(own) < 2 or is_constant(own[:, ends]) for own in replicates)
    lacking = "in some replicates too few rows differ" if few else ""
    found, notes = by_replicates(
        lambda groups: _estimates(sample.blocks, groups), y[whole], replicates, "indices", lacking
    )
    independent = y[whole][:, ends].ravel()
    more = one_more_row(independent, int(whole.sum()), len(replicates))
    if more and not notes:
        rows = effective_rows(independent) / len(replicates)
        notes += (
            f"the variance rests on some {rows:.2g} rows of each replicate: intervals are widened"
            " by what one more such row might do, and are conservative",
        )
    indices: dict[Kind, dict[str, Estimate]] = {}
    for (kind, label), estimate in found.items():
        indices.setdefault(kind, {})[label] = widened(estimate, more)
    noise = indices.pop(_NOISE, {}).get("")
    inert = [name for name, total in indices[ST].items() if total.value == 0]
    if inert:
        notes += (f"no effect in any row, hence no interval: {', '.join(inert)}",)
    return Indices(indices, notes, noise=noise)


def _parameters(blocks: Sequence[str]) -> list[str]:
    return [label.removeprefix("AB_") for label in blocks if label.startswith("AB_")]


def _estimates(blocks: Sequence[str], y: Floats) -> dict[tuple[Kind, str], float]:
    """Return each index from groups y, shape (n, blocks)."""
    from SALib.analyze.sobol import first_order, second_order, total_order

    block = dict(zip(blocks, y.T, strict=True))
    a, b = block["A"], block["B"]
    found = {}
    for name in _parameters(blocks):
        found[S1, name] = first_order(a, block[f"AB_{name}"], b)
        found[ST, name] = total_order(a, block[f"AB_{name}"], b)
    if NOISE in block:
        found[_NOISE, ""] = total_order(a, block[NOISE], b)
    if any(label.startswith("BA_") for label in block):
        for one, other in combinations(_parameters(blocks), 2):
            found[S2, f"{one},{other}"] = second_order(
                a, block[f"AB_{one}"], block[f"AB_{other}"], block[f"BA_{one}"], b
            )
    return {key: float(value) for key, value in found.items()}


def pilot(sample: Sample) -> dict[Kind, float]:
    """Return the largest standard deviation of what a group adds to S1 and to ST, over inputs.

    Parameters
    ----------
    sample : Sample
        A few groups of a crossed design, of which some are whole.

    Returns
    -------
    dict of Kind to float
    """
    y = sample.values[sample.groups][sample.whole]
    block = dict(zip(sample.blocks, ((y - y.mean()) / y.std()).T, strict=True))
    mixed = [block[f"AB_{name}"] for name in _parameters(sample.blocks)]
    return {
        S1: max(np.std(block["B"] * (one - block["A"])) for one in mixed),
        ST: max(np.std(0.5 * (block["A"] - one) ** 2) for one in mixed),
    }
