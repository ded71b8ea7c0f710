"""The regime of a wearing beam, look by look, despite the drift, and its changes.

The strobe points of a beam whose gaps grow never return exactly: they drift. But those of a
response of period k drift uniformly: the step from each to the k-th after it is constant within a
look. That is the criterion here; the result hardly depends on its tolerance.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import APERIODIC, ASYMMETRIC, NO_IMPACT, PERIODIC, SYMMETRIC
from models.beam.response.settling import LONGEST_PERIOD
from models.beam.structure.modal import Array
from models.numerics.jit import kernel

WINDOW = 2 * LONGEST_PERIOD  # periods of a look, at least, for its regime to be known
CONFIRMED = 3  # looks in a row that a regime must last to count
UNKNOWN = -1
_STEADY = 1e-2  # unevenness of the drift, relative to the response
_SYMMETRIC = 1e-2  # difference of the sites' work, relative to their sum: looser because of wear


class History(NamedTuple):
    """A life of n beams, at the end of each of L looks.

    Attributes
    ----------
    time : ndarray, shape (n, L)
        In the unit of `models.beam.wear.accelerated_life.Run.time`; NaN after the end of the run.
    gaps : ndarray, shape (n, L, 2)
        [X0]
    work : ndarray, shape (n, L, 2)
        Mean dimensionless work per period during the look.
    regime : ndarray of int8, shape (n, L)
        Index into `models.beam.parameters.REGIMES`, `UNKNOWN` where the look was too short.
    """

    time: Array
    gaps: Array
    work: Array
    regime: NDArray[np.int8]

    @staticmethod
    def nothing(n: int, looks: int) -> "History":
        """Return the history of n beams before they are run: unknown."""
        time = np.full((n, looks), np.nan)
        gaps, work = np.full((2, n, looks, 2), np.nan)
        return History(time, gaps, work, np.full((n, looks), UNKNOWN, np.int8))


@kernel
def regime_of(strobe, work):
    """Return the regime from the last `WINDOW` strobe points and works of one beam."""
    periods = len(strobe)
    scale = right = left = 0.0
    for j in range(periods - WINDOW, periods):
        scale = max(scale, abs(strobe[j, 0]), abs(strobe[j, 1]))
        right += work[j, 0]
        left += work[j, 1]
    if right + left == 0.0:
        return NO_IMPACT
    if _drifts_evenly(strobe, 1, _STEADY * scale):
        return SYMMETRIC if abs(right - left) <= _SYMMETRIC * (right + left) else ASYMMETRIC
    for lag in range(2, LONGEST_PERIOD + 1):
        if _drifts_evenly(strobe, lag, _STEADY * scale):
            return PERIODIC
    return APERIODIC


@kernel
def _drifts_evenly(strobe, lag, tolerance):
    first = len(strobe) - LONGEST_PERIOD
    for c in range(2):
        drift = strobe[first, c] - strobe[first - lag, c]
        for j in range(first + 1, len(strobe)):
            if not abs(strobe[j, c] - strobe[j - lag, c] - drift) <= tolerance:
                return False
    return True


@kernel
def confirmed_regimes(regime, confirmed=CONFIRMED):
    """Return the regime of each look, without regimes that did not last.

    Parameters
    ----------
    regime : ndarray of int8, shape (n, L)
        `UNKNOWN` after the end of a run.
    confirmed : int
        Looks in a row that a regime must last.

    Returns
    -------
    ndarray of int8, shape (n, L)
        A regime begins with the first of this many equal looks in a row; that of no impact, which
        is the end of wear, needs only one. `UNKNOWN` before the first, and after the end.
    """
    out = np.full_like(regime, UNKNOWN)
    for i in range(len(regime)):
        known = 0
        while known < regime.shape[1] and regime[i, known] != UNKNOWN:
            known += 1
        now, streak = UNKNOWN, 0
        for look in range(known):
            seen = regime[i, look]
            streak = streak + 1 if look > 0 and seen == regime[i, look - 1] else 1
            is_end = seen == NO_IMPACT and look == known - 1
            if seen != now and (streak >= confirmed or is_end):
                now = seen
                out[i, look - streak + 1 : look] = now
            out[i, look] = now
    return out


def changes_of(regime: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Return in which looks a confirmed regime follows another, shape (n, L).

    Parameters
    ----------
    regime : ndarray of int8, shape (n, L)
        As `confirmed_regimes` returns them.
    """
    changes = np.zeros(regime.shape, bool)
    before, after = regime[:, :-1], regime[:, 1:]
    changes[:, 1:] = (before != after) & (before != UNKNOWN) & (after != UNKNOWN)
    return changes
