"""First-order Sobol' indices from a plain sample, with confidence intervals."""

from collections.abc import Mapping
from itertools import combinations_with_replacement

import numpy as np

from uq.contract import Floats
from uq.indices.given_data import DUMMIES, beside_nulls, null_of, one_kind
from uq.indices.index import S1, Indices, RefusedError
from uq.indices.measures import first_order
from uq.indices.method import DesignSample
from uq.indices.residual_variance import (
    Residual,
    ordered_residual_variance,
    residual_variance,
    variance,
)
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.intervals import upper_probability
from uq.stats.quantile_functions import student

ENOUGH_ROWS = 200
"""Minimum sample size for intervals of indices. For an input that has an effect in only 3 % of the
rows the coverage would be 84 % with 100 rows, 92 % with 200 rows and 98 % with 300 rows. The
criterion must not depend on the values: samples that lack the decisive rows would have the
narrowest intervals."""

_IMPOSSIBLE = 0.999
"""Confidence level at which a sum of indices above 1 leads to the rejection of all indices."""

_FEW = f"has no interval: {ENOUGH_ROWS} rows are needed"


def first_order_indices(sample: DesignSample) -> Indices:
    """Estimate first-order indices: the share of the variance that each input explains alone.

    Parameters
    ----------
    sample : DesignSample
        Sample with independent inputs; for an output with several elements their variances are
        summed.

    Returns
    -------
    Indices
        ``S1``, which is 1 minus the residual variance given the input divided by the total variance
        (`uq.indices.residual_variance`). It is unbiased, even for steep outputs. Intervals are
        Student's, on the scale log(1 - S1), from the influence of each row [1]_. Both ends are
        widened by one more row as influential as the most influential. The intervals for
        independent rows are used for replicates too: their mean influence scatters no more, and a
        few replicates may all have the same number of rows beyond a jump, which hides its error.
        Fewer than `ENOUGH_ROWS` rows have no intervals; for an event, the null from inputs without
        effect then shows which indices are negligible. For a single replicate, whose rows are
        dependent, the index is the random balance estimate, with this null.

    Raises
    ------
    RefusedError
        The sum of the indices exceeds 1 by more than its error.

    Notes
    -----
    No estimator detects an effect that no row shows. An effect with probability 3.7 / n is absent
    from one in forty samples of n rows, and in these samples its share is attributed to other
    inputs. Waves of only five rows each cannot be distinguished from noise.

    References
    ----------
    .. [1] S. Da Veiga, F. Gamboa, "Efficient estimation of sensitivity indices", J. Nonparametr.
       Stat. 25, 573-595 (2013).
    """
    dependence = sample.dependence
    if dependence.labels is not None and len(np.unique(dependence.labels)) < 2:
        by_balance = beside_nulls(one_kind(S1, first_order))(sample)
        note = (
            "the rows of one replicate depend on each other: by random balance, too small where"
            " the output is steep in an input; [design] replicates = 8 gives unbiased indices"
            " with intervals"
        )
        return Indices(by_balance.values, (note, *by_balance.notes), by_balance.nulls)
    y = sample.values.reshape(len(sample.values), -1)
    y = y - y.mean(axis=0)
    names, lacks_rows = list(sample.inputs), len(y) < ENOUGH_ROWS
    values, products, widest, widest_sum = _shares(sample.inputs, y, dependence)

    def unexplained(quantile: float) -> Estimate:
        """Return 1 minus the sum of all indices, with its interval."""
        value = float(1 - values.sum())
        half = quantile * max(float(products.sum()), 0.0) ** 0.5
        return Estimate(value, value - half - widest_sum[0], value + half + widest_sum[1])

    quantile = student(upper_probability(sample.confidence), len(y) - 1)
    errors = quantile**2 * products
    halves = np.sqrt(np.diag(errors))
    indices = {
        name: Estimate(value, reason=_FEW) if lacks_rows else _estimate(value, half, added)
        for name, value, half, added in zip(
            names, values.tolist(), halves.tolist(), widest.T, strict=True
        )
    }
    half_products = {
        (names[i], names[j]): float(errors[i, j])
        for i, j in combinations_with_replacement(range(len(names)), 2)
    }
    lacking = {name: index.reason for name, index in indices.items() if index.reason}
    notes = tuple(f"S1 of {name} has no interval: {why}" for name, why in lacking.items())
    if not lacking:
        left = unexplained(student(upper_probability(_IMPOSSIBLE), len(y) - 1))
        if left.high < 0:
            total, low, high = (1 - end for end in (left.value, left.high, left.low))
            raise RefusedError(
                f"S1 of all inputs add up to {total:.2f} ({low:.2f} to {high:.2f}), which cannot"
                " be: the output changes within a few rows of an input, or the inputs depend on"
                " each other"
            )
    nulls = {}
    if lacking and sample.nulls and len(np.unique(y)) == 2:
        nulls = {S1: null_of(_without_effect(y, dependence), len(names))}
    factors = dict.fromkeys(lacking, ENOUGH_ROWS / len(y)) if lacks_rows else {}
    return Indices(
        {S1: indices},
        (f"S1 {_FEW}",) if lacks_rows else notes,
        nulls,
        half_products=half_products,
        rows_factors=factors,
        unexplained=NOTHING if lacking else unexplained(quantile),
    )


def _without_effect(y: Floats, dependence: Dependence) -> Floats:
    """Return first-order indices of inputs without effect (null distribution)."""
    every = variance(y, dependence)
    orders = np.random.default_rng(0).random((DUMMIES, len(y))).argsort(axis=1)
    left = [ordered_residual_variance(y[order], dependence[order]) for order in orders]
    return 1 - np.array(left) / every


def _shares(
    columns: Mapping[str, Floats], y: Floats, dependence: Dependence
) -> tuple[Floats, Floats, Floats, list[float]]:
    """Return the indices of k inputs, with the covariance matrix of their errors.

    Returns
    -------
    values : ndarray, shape (k,)
    products : ndarray, shape (k, k)
        Covariance matrix of their errors.
    widest : ndarray, shape (2, k)
        Change of the lower and upper end by one more row as influential as the most influential.
    widest_sum : list of float
        The same change for both ends of the share that no single input explains.
    """
    n, every = len(y), variance(y, dependence)
    squares = np.sum(y**2, axis=1)
    values, influences, noises = [], [], []
    for column in columns.values():
        left = residual_variance(column, y, dependence)
        value = 1 - max(left.variance, 0.0) / every  # the estimate may be negative near a jump
        influence = (left.squares - (1 - value) * squares) / every
        influence -= influence.mean()
        values.append(value)
        influences.append(influence)
        noises.append(_beyond(left, influence, value, every))
    influence = np.array(influences)
    scatter = influence @ influence.T / (n - 1) + np.diag(noises)
    widest = np.array([influence.max(axis=1), -influence.min(axis=1)]) / n
    of_all = influence.sum(axis=0)
    widest_sum = (np.array([-of_all.min(), of_all.max()]) / n).tolist()
    return np.array(values), scatter / n, widest, widest_sum


def _beyond(left: Residual, influence: Floats, value: float, every: float) -> float:
    """Return the error variance from pairs, minus the influence variance added by smoothing."""
    scatter = float(influence @ influence) / (len(influence) - 1)
    excess = min(max(1 - value, 0.0), 1.0) * left.excess / every**2
    return left.noise / every**2 - min(excess, 0.9 * scatter)


def _estimate(value: float, half: float, widest: Floats) -> Estimate:
    """Return an index with its interval on the scale of log(1 - S1)."""
    if not half > 0:
        return Estimate(value, reason="the rows show no error")
    # If the error exceeds the residual share, the log scale would make the lower end diverge.
    relative = min(half / (1 - value), 1.0) if value < 1 else 1.0
    low = value - half * np.expm1(relative) / relative - widest[0]
    high = value - half * np.expm1(-relative) / relative + widest[1]
    return Estimate(value, float(low), float(high))
