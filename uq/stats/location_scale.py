"""Maximum likelihood for censored Weibull and lognormal lives, for many samples at once.

The logarithm of such a life is m + s w, where w follows a known law (the smallest extreme value or
the normal law). The log-likelihood is concave in a = m/s and b = 1/s [1]_, so that Newton's method
finds its only maximum. scipy fits one sample at a time, which is too slow for a bootstrap.

References
----------
.. [1] J. Burridge, "A note on maximum likelihood estimation for regression models using grouped
   data", J. R. Stat. Soc. B 43, 41-45 (1981).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # which imports scipy.stats when it is first used

from uq.contract import Floats, Mask

_STEPS = 60
_CLOSE = 1e-9


@dataclass(frozen=True)
class Family:
    """A log-location-scale family of lives.

    Attributes
    ----------
    name : str
        Name of the law of w in `scipy.stats`.
    slopes : callable
        ``slopes(w, ended)`` -> first and second derivative of the log-likelihood with respect to w:
        of the log density where `ended`, otherwise of the log survival function.
    """

    name: str
    slopes: Callable[[Floats, Mask], tuple[Floats, Floats]]

    @property
    def standard(self) -> Any:
        """The law of w."""
        return getattr(scipy.stats, self.name)


def _extreme(w: Floats, ended: Mask) -> tuple[Floats, Floats]:
    hazard = np.exp(w)
    return ended - hazard, -hazard


def _normal(w: Floats, ended: Mask) -> tuple[Floats, Floats]:
    if ended.all():
        return -w, np.full_like(w, -1.0)
    hazard = np.exp(scipy.stats.norm.logpdf(w) - scipy.stats.norm.logsf(w))
    first = np.where(ended, -w, -hazard)
    return first, np.where(ended, -1.0, -hazard * (hazard - w))


FAMILIES = {"weibull": Family("gumbel_l", _extreme), "lognormal": Family("norm", _normal)}
"""The laws, by the names that study files give them."""


def fit(family: Family, x: Floats, ended: Mask) -> tuple[Floats, Floats]:
    """Return the maximum likelihood estimates of location and scale of each sample.

    Parameters
    ----------
    family : Family
    x : ndarray, shape (k, n)
        Logarithms of lives; each sample has at least two different values.
    ended : ndarray of bool, shape (k, n)
        False if the life was censored at x.

    Returns
    -------
    location, scale : ndarray, shape (k,)
        NaN if Newton's method did not converge.
    """
    centre, spread = x.mean(axis=1, keepdims=True), x.std(axis=1, keepdims=True)
    z = (x - centre) / spread
    count = ended.sum(axis=1)
    a, b = np.zeros(len(x)), np.ones(len(x))
    change = np.full(len(x), np.inf)
    for _ in range(_STEPS):
        first, second = family.slopes(b[:, None] * z - a[:, None], ended)
        by_a, by_b = -first.sum(axis=1), count / b + (z * first).sum(axis=1)
        aa, ab = second.sum(axis=1), -(z * second).sum(axis=1)
        bb = -count / b**2 + (z**2 * second).sum(axis=1)
        determinant = aa * bb - ab**2
        step_a = -(bb * by_a - ab * by_b) / determinant
        step_b = -(aa * by_b - ab * by_a) / determinant
        # Far from the maximum a full step may overshoot to where exp(w) overflows.
        shorter = 1 / np.maximum(1, np.maximum(np.abs(step_a), 2 * np.abs(step_b) / b))
        a, b = a + shorter * step_a, b + shorter * step_b
        change = np.maximum(np.abs(step_a), np.abs(step_b) / b)
        if (change < _CLOSE).all():
            break
    scale = np.where(change < _CLOSE, spread[:, 0] / b, np.nan)
    return centre[:, 0] + scale * a, scale


def anderson_darling(share: Floats, ended: Mask) -> Floats:
    """Return the Anderson-Darling statistic of censored samples.

    Parameters
    ----------
    share : ndarray, shape (k, n)
        The law's distribution function at the lives, or at the times of censoring; ascending in
        each sample.
    ended : ndarray of bool, shape (k, n)

    Returns
    -------
    ndarray, shape (k,)
        n times the integral of (F_n - F)^2 / (F (1 - F)) over F up to the last row, where F_n is
        the Kaplan-Meier estimate. Without censored rows it is the statistic of Anderson and
        Darling [1]_.

    References
    ----------
    .. [1] T. W. Anderson, D. A. Darling, "A test of goodness of fit", J. Am. Stat. Assoc. 49,
       765-769 (1954).
    """
    k, n = share.shape
    tiny = np.finfo(float).tiny
    u = np.clip(share, tiny, 1 - np.finfo(float).epsneg)
    left = np.cumprod(1 - ended / np.arange(n, 0, -1), axis=1)
    step = 1 - np.concatenate([np.ones((k, 1)), left[:, :-1]], axis=1)  # F_n up to each row
    start = np.concatenate([np.zeros((k, 1)), u[:, :-1]], axis=1)

    def integral(at: Floats) -> Floats:  # of (c - u)^2 / (u (1 - u)), c = step
        return step**2 * np.log(np.maximum(at, tiny)) - (1 - step) ** 2 * np.log1p(-at) - at

    total = (integral(u) - integral(start)).sum(axis=1)
    last = u[:, -1]
    # Beyond the last row F_n is 1 if that row ended; otherwise F_n is unknown: nothing is added.
    return n * (total + np.where(ended[:, -1], -np.log(last) - (1 - last), 0.0))
