"""Confidence distribution of the share of failed rows, by products of beta variables."""

from typing import NamedTuple

import numpy as np
from scipy import special

from uq.contract import Floats, Mask


class MatchedBeta(NamedTuple):
    """Beta laws with given means and variances, each of shape (k,); a variance may be 0."""

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
    """Confidence distribution of the share that has ended, from lives some of which are censored.

    Parameters
    ----------
    values : ndarray, shape (n,)
        +inf for rows that never end.
    censored : ndarray of bool, shape (n,)
    known_at_once : bool
        Whether every censored row is one that ends: the share that ends is then estimated apart.

    Attributes
    ----------
    ends : ndarray, shape (k,)
        Distinct times at which rows ended, ascending.
    cumulative : ndarray, shape (k, 2)
        Mean and variance of -log S up to and including each end.
    ending : tuple of float
        Parameters a, b of the beta law of the share that ever ends; b is 0 where this is 1.

    Notes
    -----
    Where d of Y rows at risk end together, the probability of outliving that time falls by a factor
    whose confidence distribution is Beta(Y - d + 1, d); its product S over all ends so far bounds
    survival from above. A further row that ends right after the time, a factor of Beta(Y, 1),
    bounds it from below [1]_. The share that ever ends is Beta(m + 1, n - m) if m of n do. The
    share that has ended is the product of this and 1 - S, with a beta law of the same mean and
    variance. Without censored rows that is the exact law of Clopper and Pearson, that of an order
    statistic of uniform numbers.

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
        mean = special.digamma(at_risk + 1.0) - special.digamma(left)
        variance = special.polygamma(1, left) - special.polygamma(1, at_risk + 1.0)
        self.cumulative = np.cumsum(np.stack([mean, variance], axis=1), axis=0)

    def ended_by(self, time: Floats) -> MatchedBeta:
        """Return the law whose lower quantiles bound the share that has ended by each time."""
        place = np.searchsorted(self.ends, time, side="right")
        return self._law(self._log_mean[place], self._log_relative[place])

    def ended_after(self, time: Floats) -> MatchedBeta:
        """Return the law whose upper quantiles bound the share that has ended by each time."""
        place = np.searchsorted(self.ends, time, side="right")
        left = self.at_risk_after(time)
        with np.errstate(divide="ignore", invalid="ignore"):
            log_mean = self._log_mean[place] + np.log(left / (left + 1))
            log_relative = self._log_relative[place] + np.log1p(1 / (left * (left + 2)))
        return self._law(log_mean, np.where(left > 0, log_relative, 0.0))

    def at_risk_after(self, time: Floats) -> Floats:
        """Return the number of rows seen longer than each time, of those that end."""
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
