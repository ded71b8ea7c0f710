"""Group-sequential confidence levels: the level of each interim check that preserves coverage.

An interval that is recomputed after each check is narrow by chance at some check, and the run stops
there. The resulting loss of coverage depends on the correlation between the width of the interval
and its error. docs/statistics.md explains the method and reports the measured coverage.
"""

from functools import lru_cache

import numpy as np
from scipy import special

from uq.stats.intervals import CONFIDENCE, upper_probability
from uq.stats.quantile_functions import root, student

MOST_AT_STAKE = 2
"""Most successive checks at which independent rows may stop, for a given half-width."""

_INDEPENDENT = (0.95, 0.970_614)
"""Confidence level of each interval for a joint coverage of 95 %: of one interval, and of two, the
second of which uses twice the rows."""

_STEPS = 32  # grid steps between two checks
_SMALLEST, _LARGEST = 1e-6, 16.0  # standard deviation of replicates over its expectation


def of_independent_rows(checks: int) -> float:
    """Return the confidence level of each interim check of independent rows.

    Parameters
    ----------
    checks : int
        Number of checks; each uses twice the rows of the previous one.

    Returns
    -------
    float
        Level by Pocock's rule [1]_ for at most `MOST_AT_STAKE` checks: the interval covers the true
        value in 95 % of cases, whichever of these checks stops the run. From a few hundred rows
        on, the width varies so little that the run cannot stop at any other check.

    References
    ----------
    .. [1] S. J. Pocock, "Group sequential methods in the design and analysis of clinical trials",
       Biometrika 64, 191-199 (1977).
    """
    return _INDEPENDENT[min(checks, MOST_AT_STAKE) - 1]


@lru_cache(maxsize=32)
def of_replicates(replicates: int, checks: int) -> float:
    """Return the confidence level of each interim check of replicates, by Student's t.

    Parameters
    ----------
    replicates : int
        At least two.
    checks : int
        Number of checks; each uses twice the samples of the previous one.

    Returns
    -------
    float
        Level at which the interval at the stop misses the true value in 5 % of cases, for the worst
        half-width. Assumptions: errors are normal, so that the scatter of replicates is independent
        of the error of their mean; the run stops when the scatter is small by chance; checks are
        independent; errors decrease at least with the square root of the number of samples.
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
    """Return the non-coverage probability of the interval at the stop, for the worst half-width.

    At each check the ratio of the scatter to its expectation is v = sqrt(chi^2 / freedom). The run
    stops at the first v below a limit, which grows by sqrt(2) from check to check. The interval
    then misses with probability 2 Phi(-wide v).
    """
    step = np.log(2) / 2 / _STEPS
    v = np.exp(np.arange(np.log(_SMALLEST), np.log(_LARGEST), step))
    below = np.asarray(special.gammainc(freedom / 2, freedom * v**2 / 2), dtype=float)
    missed_in_step = 2 * special.ndtr(-wide * v * np.exp(-step / 2)) * np.diff(below, prepend=0.0)
    misses = np.cumsum(missed_in_step)
    total, goes_on = np.zeros_like(v), np.ones_like(v)
    for check in range(checks):
        # Limit at this check, for each limit at the first check.
        limit = np.minimum(np.arange(len(v)) + check * _STEPS, len(v) - 1)
        ends_anyway = check == checks - 1  # the last check ends the run, whatever the width
        total += goes_on * (misses[-1] if ends_anyway else misses[limit])
        goes_on *= 1 - below[limit]
    return float(total.max())
