"""The confidence of each of several checks, so that the interval at which a run stops holds.

An interval that is recomputed is narrow by chance at some point, and a run stops at it. How often
it then misses depends on what its width says of its error; docs/statistics.md has the reasoning
and what was measured.
"""

from functools import lru_cache

import numpy as np
from scipy import special

from uq.stats.intervals import CONFIDENCE, upper_probability
from uq.stats.quantile_functions import student
from uq.stats.roots import root

MOST_AT_STAKE = 2
"""Successive checks at which a run of independent rows may stop, for a given half-width."""

_INDEPENDENT = (0.95, 0.970_614)
"""Confidence of one and of two intervals, the second from twice the rows, both of which hold in
95 % of cases."""

_STEPS = 32  # of the grid from one check to the next
_SMALLEST, _LARGEST = 1e-6, 16.0  # spread of replicates over what is expected


def of_independent_rows(checks: int) -> float:
    """Return the confidence of each check of independent rows.

    Parameters
    ----------
    checks : int
        Each from twice the rows of the one before.

    Returns
    -------
    float
        By Pocock's rule [1]_ for at most `MOST_AT_STAKE` checks: whatever decides at which of these
        a run stops, the interval holds in 95 % of cases. From a few hundred rows on, the width is
        known well enough that no other check has a chance.

    References
    ----------
    .. [1] S. J. Pocock, "Group sequential methods in the design and analysis of clinical trials",
       Biometrika 64, 191-199 (1977).
    """
    return _INDEPENDENT[min(checks, MOST_AT_STAKE) - 1]


@lru_cache(maxsize=32)
def of_replicates(replicates: int, checks: int) -> float:
    """Return the confidence of each check of replicates, by Student's t.

    Parameters
    ----------
    replicates : int
        At least two.
    checks : int
        Each from twice the samples of the one before.

    Returns
    -------
    float
        Such that the interval at the stop misses in 5 % of cases for the worst half-width. Errors
        are normal, so that the scatter of replicates says nothing of the error of their mean, and a
        run stops where they scatter little by chance; each check has a chance of its own, and
        errors fall no more slowly than with the root of the samples.
    """
    freedom = replicates - 1
    if checks == 1:
        return CONFIDENCE

    def excess(confidence: float) -> float:
        return _wrong(student(upper_probability(confidence), freedom), freedom, checks) - (
            1 - CONFIDENCE
        )

    return root(excess, (CONFIDENCE, 1 - (1 - CONFIDENCE) / checks), 1e-9)


def _wrong(wide: float, freedom: int, checks: int) -> float:
    """Return the largest probability, over half-widths, that the interval at the stop misses.

    The spread over its expectation is v at each check, sqrt(chi^2 / freedom); a run stops at the
    first v below a limit, which grows by sqrt(2) from check to check, and misses there with
    probability 2 Phi(-wide v).
    """
    step = np.log(2) / 2 / _STEPS
    v = np.exp(np.arange(np.log(_SMALLEST), np.log(_LARGEST), step))
    below = np.asarray(special.gammainc(freedom / 2, freedom * v**2 / 2), dtype=float)
    missed_in_step = 2 * special.ndtr(-wide * v * np.exp(-step / 2)) * np.diff(below, prepend=0.0)
    misses = np.cumsum(missed_in_step)
    total, goes_on = np.zeros_like(v), np.ones_like(v)
    for check in range(checks):
        # The limit of a later check, for each limit at the first.
        limit = np.minimum(np.arange(len(v)) + check * _STEPS, len(v) - 1)
        ends_anyway = check == checks - 1  # however wide the interval is
        total += goes_on * (misses[-1] if ends_anyway else misses[limit])
        goes_on *= 1 - below[limit]
    return float(total.max())
