"""Pareto-smoothed importance weights and their reliability diagnostics."""

from math import ceil, inf
from typing import NamedTuple

import numpy as np

from uq.contract import Floats
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.intervals import is_constant
from uq.stats.tails import DISTINCT, generalised_pareto, shrunk

_FEWEST = 5  # values in a tail
DOUBTFUL = 0.7
"""Pareto shape k above which a weighted mean is unreliable for any sample size."""

_NEGLIGIBLE = 1e-3
_LITTLE = 0.01
_BOUNDED = 10.0  # mean weights: the variance of weights that never exceed this is small
_ENOUGH = 10.0  # effective rows
_SAME = 1e-9  # relative difference up to which numbers are equal but for rounding


def effective_rows(numbers: Floats) -> float:
    """Return Kish's effective sample size of weighted rows [1]_.

    References
    ----------
    .. [1] L. Kish, Survey Sampling, Wiley, New York, 1965.
    """
    largest = numbers.max(initial=0.0)
    relative = numbers / largest if largest > 0 else numbers
    return float(relative.sum() ** 2 / (relative**2).sum()) if largest > 0 else 0.0


class ImportanceWeights(NamedTuple):
    """Importance weights of rows, with their diagnostics.

    Attributes
    ----------
    weights : ndarray, shape (n,)
        Weights, scaled to mean 1.
    k : float
        Shape of the generalised Pareto law of the largest weights; -inf if all weights are equal.
    rows : int
        Number of independent rows, or of samples of several rows.
    effective : float
        Kish's effective sample size.
    most : float
        Upper limit of the weight of a row.
    impossible : str
        Reason why rows cannot be weighted; "" if they can.
    """

    weights: Floats
    k: float
    rows: int
    effective: float
    most: float = inf
    impossible: str = ""

    @property
    def refusal(self) -> str:
        """Reason why the weights are unreliable; "" if they are reliable."""
        if not self.impossible and is_bounded(self.most, self.effective):
            return ""
        return self.impossible or refusal(self.k, self.rows)


def smoothed(
    log_weights: Floats, dependence: Dependence = INDEPENDENT, most: float = inf
) -> ImportanceWeights:
    """Return Pareto-smoothed weights [1]_.

    Weights are not smoothed if a known bound keeps every row below a hundredth of the total weight.
    The variance of their mean is then below a hundredth of its square, and k is at most 0, whatever
    the largest observed weights are. If samples have several rows, the weights of samples are
    smoothed, since samples are independent; proportions within a sample do not change.

    Parameters
    ----------
    log_weights : ndarray, shape (n,)
        Logarithms of the weights; not all -inf.
    dependence : Dependence, optional
    most : float, optional
        Upper limit of the weight of a row, for weights of mean 1.

    Returns
    -------
    ImportanceWeights

    References
    ----------
    .. [1] A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
       sampling", J. Mach. Learn. Res. 25, 72 (2024).
    """
    raw = np.exp(log_weights - log_weights.max())
    of_samples = dependence.sums_of_samples(raw)
    alone = len(of_samples) == 1 and log_weights.any()
    k = inf if alone else tail_shape(of_samples)
    weights = raw
    if is_negligible(most, len(of_samples)):
        k = min(k, 0.0)
    elif np.isfinite(k):
        smooth = _with_smooth_tail(of_samples)
        if of_samples is raw:
            weights = smooth
        else:
            with np.errstate(invalid="ignore"):  # samples without weight
                factors = np.nan_to_num(smooth / of_samples)
            weights = (
                raw * factors[np.unique(np.asarray(dependence.labels), return_inverse=True)[1]]
            )
    effective = effective_rows(dependence.sums_of_samples(weights))
    return ImportanceWeights(weights / weights.mean(), k, len(of_samples), effective, most)


def impossible_weights(rows: int, why: str) -> ImportanceWeights:
    """Return unit weights for rows that cannot be weighted, with the reason."""
    return ImportanceWeights(np.ones(rows), inf, rows, 0.0, impossible=why)


def is_bounded(most: float, effective: float) -> bool:
    """Whether the effective rows alone decide, as no row can weigh more than ten mean rows.

    The largest weights lie at the bound then: a Pareto law fitted to them says nothing of heavier
    ones, of which there are none.

    Parameters
    ----------
    most : float
        Upper limit of the weight of a row, for weights of mean 1.
    effective : float
        Kish's effective sample size.
    """
    return most <= _BOUNDED and effective > _ENOUGH


def is_negligible(most: float, rows: int) -> bool:
    """Whether no row can carry more than a hundredth of the total weight."""
    return rows_to_be_negligible(most) <= rows


def rows_to_be_negligible(most: float) -> float:
    """Return the sample size at which no row can exceed a hundredth of the total weight."""
    return most / _LITTLE


def of_samples(weights: Floats) -> ImportanceWeights:
    """Return posterior weights of samples after inspections, with their diagnostics."""
    return ImportanceWeights(weights, tail_shape(weights), len(weights), effective_rows(weights))


def quality(weights: ImportanceWeights | None) -> dict[str, float]:
    """Return the effective sample size and the Pareto shape of the weights."""
    return {} if weights is None else {"effective_rows": weights.effective, "pareto_k": weights.k}


def worth_in_words(weights: ImportanceWeights) -> str:
    """Return the number of samples and the effective sample size in words."""
    return f"{weights.rows} samples, worth {weights.effective:.0f} of equal weight"


def tail_shape(numbers: Floats) -> float:
    """Return the Pareto shape k: the generalised Pareto shape of the largest numbers [1]_.

    The numbers are not negative. Numbers below a thousandth of the largest count as zero and do not
    belong to the tail. The shape is -inf if all other numbers are equal, or if the largest numbers
    take few values, each shared by many rows, as for laws of listed values. It is infinite if there
    are too few numbers. Rows tied at the value at which the tail begins are excluded from the tail,
    as for a limit that is integrated on a grid.

    References
    ----------
    .. [1] A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
       sampling", J. Mach. Learn. Res. 25, 72 (2024).
    """
    ascending = np.sort(numbers)
    counted = ascending[ascending > _NEGLIGIBLE * ascending[-1]]
    if len(counted) == 0 or (len(counted) == len(ascending) and is_constant(counted)):
        return -inf
    count = _tail_size(len(numbers))
    if len(counted) < _FEWEST:
        return inf
    if _are_few_values(counted, count):
        return -inf
    excess = counted
    if len(counted) > count:
        above = counted[-count:][counted[-count:] > counted[-count - 1]]
        if 2 * len(above) > count:  # otherwise ties would leave too few rows in the tail
            excess = above - counted[-count - 1]
    if np.ptp(excess) == 0:
        return -inf if len(excess) > 1 else inf
    return shrunk(generalised_pareto(excess)[0], len(excess))


def largest_shape(rows: int) -> float:
    """Return the largest Pareto shape at which this sample size is reliable."""
    return min(DOUBTFUL, 1 - 1 / np.log10(rows)) if rows > 10 else -inf


HOPELESS = (
    "too few rows are in the range of the other laws; run these as a separate study, or with many"
    " times the rows"
)


def refusal(k: float, rows: int, hopeless: str = HOPELESS) -> str:
    """Return the reason why weights of this shape are unreliable; "" if they are reliable."""
    most = largest_shape(rows)
    if k <= most or k == -inf:
        return ""
    if most == -inf:
        parts = "part" if rows == 1 else "parts"
        return f"weights come from {rows} independent {parts}, and more than 10 are needed"
    if k < DOUBTFUL:
        needed = max(ceil(10 ** (1 / (1 - max(k, 0.0)))), rows + 1)
        return (
            f"about {needed} samples are required instead of {rows}"
            f" (Pareto k {k:.2f}, limit {most:.2f})"
        )
    if k == inf:
        return (
            f"fewer than {_FEWEST} samples have weight there: at least {2 * rows} samples are"
            f" required instead of {rows}"
        )
    return f"{hopeless} (Pareto k {k:.2f})"


def largest_share(weights: Floats) -> float:
    """Return the share of the largest weight in the total weight."""
    return float(weights.max() / weights.sum())


def too_large(share: float, rows: int) -> str:
    """Return the reason why the share of one row is too large; "" if it is acceptable."""
    if share <= _LITTLE:
        return ""
    more = ceil(rows * (share / _LITTLE - 1))
    carried = f"a single sample carries {share:.1%} of the weight, above {_LITTLE:.0%}"
    return f"{carried}: add {more} samples"


def _are_few_values(ascending: Floats, count: int) -> bool:
    """Whether the largest numbers take fewer than ten values, each shared by ten or more rows."""
    close = _SAME * ascending[-1]
    largest = ascending[ascending >= ascending[-min(count, len(ascending))] - close]
    sizes = np.diff(np.flatnonzero(np.r_[True, np.diff(largest) > close, True]))
    return bool(len(sizes) < DISTINCT <= sizes.min())


def _tail_size(rows: int) -> int:
    return ceil(min(rows / 5, 3 * rows**0.5))


def _with_smooth_tail(raw: Floats) -> Floats:
    """Replace the largest weights by quantiles of the generalised Pareto law fitted to them."""
    count = _tail_size(len(raw))
    order = np.argsort(raw, kind="stable")
    tail, cut = order[-count:], raw[order[-count - 1]]
    excess = raw[tail] - cut
    if not excess[0] > np.finfo(float).eps * raw.max():  # lost in rounding: no tail to fit
        return raw
    shape, scale = generalised_pareto(excess)
    k = shrunk(shape, count)
    p = (np.arange(count) + 0.5) / count
    weights = raw.copy()
    weights[tail] = np.minimum(cut + scale * np.expm1(-k * np.log1p(-p)) / k, raw.max())
    return weights
