"""Survival curves of censored lives, cumulative incidence by cause, and their intervals."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats, Mask
from uq.stats.intervals import CONFIDENCE, Ends, upper_probability
from uq.stats.quantile_functions import normal

DRAWS = 4000
"""Number of simulated curves; the coverage is then accurate to 0.3 %."""

POINTS = 300
"""Largest number of times at which curves are simulated, spread over the odds of having ended."""

_HALVINGS = 9  # bisections of the logarithm of the tail probability


class MatchedBeta(NamedTuple):
    """Beta laws by their means and variances, each of shape (k,); a variance may be 0."""

    mean: Floats
    variance: Floats

    def quantile(self, probability: float) -> Floats:
        """Return the quantile of each law."""
        spread = self.variance > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            count = self.mean * (1 - self.mean) / self.variance - 1
            hits = np.where(spread, self.mean * count, 1.0)
            misses = np.where(spread, (1 - self.mean) * count, 1.0)
        return np.where(spread, special.betaincinv(hits, misses, probability), self.mean)


class BetaProducts:
    """Beta product confidence distribution of the share that has ended, for censored lives.

    Parameters
    ----------
    values : ndarray, shape (n,)
        +inf for rows that never end.
    censored : ndarray of bool, shape (n,)
    known_at_once : bool
        Whether every censored row would end later: the share that ends is then estimated
        separately.

    Attributes
    ----------
    ends : ndarray, shape (k,)
        Distinct times at which rows ended, ascending.
    ending : tuple of float
        Parameters a, b of the beta law of the share that ever ends; b is 0 if this share is 1.

    Notes
    -----
    If d of Y rows at risk end at the same time, survival decreases by a factor with the confidence
    distribution Beta(Y - d + 1, d). The product S of these factors over all previous ends bounds
    survival from above. A further row that ends immediately after the time adds a factor Beta(Y, 1)
    and bounds survival from below [1]_. If m of n rows end, the share that ever ends has the law
    Beta(m + 1, n - m). The share that has ended is the product of this share and 1 - S; its law is
    approximated by a beta law of the same mean and variance. Without censored rows this is the
    exact law of Clopper and Pearson: the law of an order statistic of uniform numbers.

    References
    ----------
    .. [1] M. P. Fay, E. H. Brittain, M. A. Proschan, "Pointwise confidence intervals for a survival
       distribution with small samples or heavy censoring", Biostatistics 14, 723-736 (2013).
    """

    def __init__(self, values: Floats, censored: Mask, *, known_at_once: bool):
        never = np.isposinf(values) & known_at_once & censored.any()
        self.ending = (float((~never).sum() + 1), float(never.sum()))
        self._sorted = np.sort(values[~never])
        ended = values[~censored & np.isfinite(values)]
        self.ends, together = np.unique(ended, return_counts=True)
        self._ended = np.append(0, np.cumsum(together))
        at_risk = len(self._sorted) - np.searchsorted(self._sorted, self.ends)
        left = at_risk - together + 1.0
        self._log_mean = np.append(0.0, np.cumsum(np.log(left / (at_risk + 1.0))))
        relative = together / (left * (at_risk + 2.0))
        self._log_relative = np.append(0.0, np.cumsum(np.log1p(relative)))
        self._before, self._left = at_risk + 1.0, left

    @property
    def cumulative(self) -> Floats:
        """Mean and variance of -log S up to and including each end, shape (k, 2)."""
        mean = special.digamma(self._before) - special.digamma(self._left)
        variance = special.polygamma(1, self._left) - special.polygamma(1, self._before)
        return np.cumsum(np.stack([mean, variance], axis=1), axis=0)

    def ended_by(self, time: Floats) -> MatchedBeta:
        """Return the beta laws for lower confidence bounds of the share that has ended."""
        place = np.searchsorted(self.ends, time, side="right")
        return self._law(self._log_mean[place], self._log_relative[place])

    def ended_after(self, time: Floats) -> MatchedBeta:
        """Return the beta laws for upper confidence bounds of the share that has ended."""
        place = np.searchsorted(self.ends, time, side="right")
        left = self.at_risk_after(time)
        with np.errstate(divide="ignore", invalid="ignore"):
            log_mean = self._log_mean[place] + np.log(left / (left + 1))
            log_relative = self._log_relative[place] + np.log1p(1 / (left * (left + 2)))
        return self._law(log_mean, np.where(left > 0, log_relative, 0.0))

    def at_risk_after(self, time: Floats) -> Floats:
        """Return the number of rows at risk after each time, among the rows that end."""
        seen = np.searchsorted(self._sorted, time, side="right")
        return np.asarray(len(self._sorted) - seen, dtype=float)

    def rows_ended_by(self, time: Floats) -> Floats:
        """Return the number of rows that have ended by each time."""
        return np.asarray(self._ended[np.searchsorted(self.ends, time, side="right")], dtype=float)

    def _law(self, log_mean: Floats, log_relative: Floats) -> MatchedBeta:
        among, scatter = -np.expm1(log_mean), np.exp(2 * log_mean) * np.expm1(log_relative)
        a, b = self.ending
        p = a / (a + b)
        of_p = p * (1 - p) / (a + b + 1)
        return MatchedBeta(p * among, (of_p + p**2) * scatter + among**2 * of_p)


class SurvivalCurve(NamedTuple):
    """Survival probability at each time, and its variance for independent rows."""

    share: Floats
    variance: Floats


def outliving(
    values: Floats, censored: Mask, time: Floats, *, known_at_once: bool
) -> SurvivalCurve:
    """Estimate the survival probability at each time.

    Parameters
    ----------
    values : ndarray, shape (n,)
        +inf for rows that never end.
    censored : ndarray of bool, shape (n,)
    time : ndarray
        [s]
    known_at_once : bool
        Whether every censored row would end later.

    Returns
    -------
    SurvivalCurve

    Notes
    -----
    Let p be the share of the n rows that end, and S the Kaplan-Meier estimate of these rows. The
    survival probability at t is 1 - p + p S(t). Given the number of rows that end, the bias of S is
    negligible, so that the errors of p and S are uncorrelated. The variance is
    (1 - S)^2 p (1 - p) / n + p^2 Var(S), with Greenwood's Var(S). Without censored rows this is
    the variance of the share of all rows, F (1 - F) / n with F = p (1 - S).

    If `known_at_once` is false, rows that never end are at risk until the last time, and p is 1.
    """
    never = np.isposinf(values)
    if not known_at_once:
        return kaplan_meier(np.where(never, time.max(initial=0.0), values), never | censored, time)
    p = 1 - never.mean()
    of_ending = kaplan_meier(values[~never], censored[~never], time)
    share = 1 - p + p * of_ending.share
    spread = (1 - of_ending.share) ** 2 * p * (1 - p) / len(values)
    return SurvivalCurve(share, spread + p**2 * of_ending.variance)


def kaplan_meier(values: Floats, censored: Mask, time: Floats) -> SurvivalCurve:
    """Return the Kaplan-Meier estimate of finite values, with Greenwood's variance.

    scipy's ``ecdf`` gives the estimate, but uses the variance only inside its own intervals.

    References
    ----------
    E. L. Kaplan, P. Meier, "Nonparametric estimation from incomplete observations", J. Am. Stat.
    Assoc. 53, 457-481 (1958).
    """
    ends, count = np.unique(values[~censored], return_counts=True)
    at_risk = len(values) - np.searchsorted(np.sort(values), ends)
    share = np.cumprod((at_risk - count) / at_risk)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = share**2 * np.cumsum(count / (at_risk * (at_risk - count)))
    # After all rows have ended the variance is zero, unless some rows were censored before.
    variance[share == 0] = np.nan if censored.any() else 0.0
    place = np.searchsorted(ends, time, side="right")
    return SurvivalCurve(np.append(1.0, share)[place], np.append(0.0, variance)[place])


class CumulativeIncidence(NamedTuple):
    """Probability that a life has ended by each time, by one cause, and its variance."""

    share: Floats
    variance: Floats


def aalen_johansen(
    values: Floats, causes: NDArray[np.integer], entered: Floats, cause: int, time: Floats
) -> CumulativeIncidence:
    """Return the cumulative incidence of a cause among competing ones.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Lives, or times of censoring; +inf for rows that never end and stay at risk.
    causes : ndarray of int, shape (n,)
        Which cause ended the life; -1 for censored rows and those that never end.
    entered : ndarray, shape (n,)
        Times from which rows were at risk; 0 without late entry.
    cause : int
    time : ndarray, shape (k,)

    Returns
    -------
    CumulativeIncidence
        At each time; NaN after a time at which nobody was at risk while others entered later.

    Notes
    -----
    The sum of S(t-) d_c / Y over all ends up to a time [1]_, with Y rows at risk, d_c that end by
    the cause, and S the product-limit estimate for all causes together. One minus Kaplan-Meier with
    other causes as censoring would exceed it. The variance is that of the delta method [2]_; rows
    that end at one time are taken to end one after the other.

    References
    ----------
    .. [1] O. O. Aalen, S. Johansen, "An empirical transition matrix for non-homogeneous Markov
       chains based on censored observations", Scand. J. Stat. 5, 141-150 (1978).
    .. [2] E. Marubini, M. G. Valsecchi, "Analysing survival data from clinical trials and
       observational studies", Wiley (1995), section 10.2.
    """
    ends = np.unique(values[causes >= 0])
    at_risk = _at_risk(values, entered, ends)
    every = np.bincount(np.searchsorted(ends, values[causes >= 0]), minlength=len(ends))
    mine = np.bincount(np.searchsorted(ends, values[causes == cause]), minlength=len(ends))
    left = np.cumprod((at_risk - every) / at_risk)
    before = np.append(1.0, left)[:-1]
    share = np.cumsum(before * mine / at_risk)
    # Sums of the three terms of the delta method, expanded in the incidence at the time asked.
    with np.errstate(divide="ignore", invalid="ignore"):
        hazard = every / (at_risk * (at_risk - every))
        # The factor is 0 for the last end, after which nothing changes.
        hazard = np.where(at_risk > every, hazard, 0.0)
        of_cause = before**2 * mine * (at_risk - mine) / at_risk**3.0
        cross = before * mine / at_risk**2.0
    zeroth, first, second = (np.cumsum(hazard * share**p) for p in (0, 1, 2))
    variance = (
        share**2 * zeroth
        - 2 * share * first
        + second
        + np.cumsum(of_cause)
        - 2 * (share * np.cumsum(cross) - np.cumsum(cross * share))
    )
    place = np.searchsorted(ends, time, side="right")
    return CumulativeIncidence(
        np.append(0.0, share)[place], np.append(0.0, np.maximum(variance, 0.0))[place]
    )


def _at_risk(values: Floats, entered: Floats, time: Floats) -> NDArray[np.intp]:
    """Return the number of rows at risk at each time: those with entry 0 are from the first on."""
    late = entered[entered > 0]
    ended, to_enter = (np.searchsorted(np.sort(part), time) for part in (values, late))
    return np.asarray(len(values) - ended - (len(late) - to_enter))


_FEW_BY_CAUSE = 10


def incidence_interval(
    values: Floats, causes: NDArray[np.integer], entered: Floats, cause: int, time: Floats
) -> Ends:
    """Return the pointwise 95 % interval of a cumulative incidence.

    Arguments as for `aalen_johansen`. It is symmetric about the logarithm of -log(1 - F) [1]_. With
    fewer than 10 ends by the cause it is the exact binomial one for the number of rows that has the
    same variance [2]_; with none, for the rows at risk and those that ended.

    References
    ----------
    .. [1] J. Choudhury, "Non-parametric confidence interval estimation for competing risks
       analysis", Stat. Med. 21, 1129-1144 (2002).
    .. [2] E. L. Korn, B. I. Graubard, "Confidence intervals for proportions with small expected
       number of positive counts estimated from survey data", Surv. Methodol. 24, 193-201 (1998).
    """
    share, variance = aalen_johansen(values, causes, entered, cause, time)
    upper = upper_probability(CONFIDENCE)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = np.log(-np.log1p(-share))
        half = normal(upper) * np.sqrt(variance) / ((1 - share) * -np.log1p(-share))
        low, high = (-np.expm1(-np.exp(middle + side * half)) for side in (-1, 1))
        worth = share * (1 - share) / variance
    ended = np.searchsorted(np.sort(values[causes == cause]), time, side="right")
    few = ended < _FEW_BY_CAUSE
    at_risk = _at_risk(values, entered, time)
    # Rows that ended by another cause are known not to end by this one.
    observed = at_risk + np.searchsorted(np.sort(values[causes >= 0]), time)
    size = np.where((share > 0) & (variance > 0), worth, np.maximum(observed, 1.0))
    hits, misses = size * share, size * (1 - share)
    exact_low = np.where(share > 0, special.betaincinv(hits, misses + 1, 1 - upper), 0.0)
    exact_high = np.where(share < 1, special.betaincinv(hits + 1, misses, upper), 1.0)
    return np.where(few, exact_low, low), np.where(few, exact_high, high)


def simultaneous_band(values: Floats, censored: Mask, time: Floats, *, known_at_once: bool) -> Ends:
    """Return the simultaneous 95 % confidence band of a survival curve.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Lives of independent rows; +inf for rows that never end.
    censored : ndarray of bool, shape (n,)
    time : ndarray, shape (k,)
        Ascending [s]
    known_at_once : bool
        Whether every censored row would end later.

    Returns
    -------
    low, high : ndarray, shape (k,)
        Valid from each time up to, but excluding, the next; NaN if no row ends.

    Notes
    -----
    The limits are quantiles of `BetaProducts` with the same tail probability at all times. This
    probability is chosen so that 5 % of simulated curves leave the band [1]_. The cumulative hazard
    between two ends, times the number of rows at risk, is exponential for any censoring, which
    makes the simulation possible. The band is exact without censored rows, and conservative for
    discontinuous laws.

    References
    ----------
    .. [1] S. Aldor-Noiman, L. D. Brown, A. Buja, W. Rolke, R. A. Stine, "The power to see: a new
       graphical test of normality", Am. Stat. 67, 249-260 (2013).
    """
    law = BetaProducts(values, censored, known_at_once=known_at_once)
    if not len(law.ends):
        return np.full(len(time), np.nan), np.full(len(time), np.nan)
    order = np.lexsort((censored, values))
    ranks = np.unique(values, return_inverse=True)[1].astype(float)
    ranks[np.isposinf(values)] = np.inf
    tail = _tail(ranks[order].tobytes(), censored[order].tobytes(), known_at_once)
    return 1 - law.ended_after(time).quantile(1 - tail), 1 - law.ended_by(time).quantile(tail)


@lru_cache(maxsize=8)
def _tail(ranks: bytes, censored: bytes, known_at_once: bool) -> float:
    """Return the pointwise tail probability for which 5 % of simulated curves leave the band.

    It depends only on the order of the rows: all elements without censored rows share one value.
    """
    rows = np.frombuffer(ranks), np.frombuffer(censored, dtype=bool)
    law = BetaProducts(*rows, known_at_once=known_at_once)
    last = law.ends[-1:]
    ended = law.ended_by(law.ends)
    with np.errstate(divide="ignore"):
        odds = np.log(ended.mean) - np.log1p(-ended.mean)
    wanted = np.linspace(odds[0], odds[-1], min(POINTS, len(odds)))
    chosen = np.unique(np.searchsorted(odds, wanted).clip(0, len(odds) - 1))
    if len(odds) <= POINTS:
        chosen = np.arange(len(odds))
    ended, after = law.ended_by(law.ends[chosen]), law.ended_after(last)

    rng = np.random.default_rng(0)
    mean, variance = np.diff(law.cumulative[chosen], axis=0, prepend=[[0.0, 0.0]]).T
    steps = rng.standard_gamma(mean**2 / variance, (DRAWS, len(chosen))) * (variance / mean)
    a, b = law.ending
    ever = rng.beta(a, b, (DRAWS, 1)) if b else np.ones((DRAWS, 1))
    logs = np.cumsum(steps, axis=1)
    curves = ever * -np.expm1(-logs)
    left = float(law.at_risk_after(last)[0])
    further = logs[:, -1] + rng.standard_exponential(DRAWS) / left if left else np.inf
    beyond = ever[:, 0] * -np.expm1(-further)

    def leaving(tail: float) -> float:
        outside = (curves < ended.quantile(tail)) | (curves > ended.quantile(1 - tail))
        past = beyond > after.quantile(1 - tail)
        return float((outside.any(axis=1) | past).mean())

    most = (1 - CONFIDENCE) / 2
    low, high = np.log(most / (len(chosen) + 1)), np.log(most)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if leaving(np.exp(middle)) <= 1 - CONFIDENCE:
            low = middle
        else:
            high = middle
    return float(np.exp(low))
