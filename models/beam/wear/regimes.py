"""The regime of a wearing beam, and its changes.

A response near an orbit of k periods returns nearly to where it was k periods before. How nearly,
and whether the distance shrinks, shows if it approaches one; the slow drift due to wear is far
smaller than the distances of a response that approaches none.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import APERIODIC, ASYMMETRIC, NO_IMPACT, PERIODIC, SYMMETRIC
from models.beam.structure.modal import Array
from models.numerics.jit import inlined, kernel

ROUND = 16  # periods between two judgements of a response
LONGEST_PERIOD = ROUND // 2
CONFIRMED = 3  # looks in a row that a regime must last to count
UNKNOWN = -1
_NEAR = 2e-2  # distance from the point k periods before, relative to the response
_ALIKE = 4.0  # ratio of distances that do not tell periods apart: a spiral onto an orbit of one
_SHRINKING = 0.9  # factor of that distance from one round to the next
_STILL = 1e-7  # distance that need not shrink
_SYMMETRIC = 1e-2  # difference of the sites' work, relative to their sum: looser because of wear


class History(NamedTuple):
    """A life of n beams, at the end of each of L looks.

    Attributes
    ----------
    time : ndarray, shape (n, L)
        In the unit of `models.beam.wear.worn_beams.Worn.time`; NaN after the end of the run.
    gaps : ndarray, shape (n, L, 2)
        [X0]
    work : ndarray, shape (n, L, 2)
        Mean dimensionless work per period.
    regime : ndarray of int8, shape (n, L)
        Index into `models.beam.parameters.REGIMES`, `UNKNOWN` after the end of the run.
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


@inlined
def watch(strobe, apart):
    """Compare the strobe points of a round with those k periods before.

    Parameters
    ----------
    strobe : ndarray, shape (`ROUND`, 2)
    apart : ndarray, shape (`LONGEST_PERIOD`,)
        Largest distances of points 1, 2, ... periods apart in the round before; updated.

    Returns
    -------
    period : int
        Of the orbit that the response is near to, 0 if there is none.
    nearing : bool
        Whether it comes closer to an orbit.
    """
    size = 0.0
    for t in range(ROUND):
        size = max(size, abs(strobe[t, 0]), abs(strobe[t, 1]))
    period, nearing, nearest = 0, False, np.inf
    for k in range(LONGEST_PERIOD, 0, -1):
        distance = 0.0
        for t in range(LONGEST_PERIOD, ROUND):
            x = abs(strobe[t, 0] - strobe[t - k, 0])
            v = abs(strobe[t, 1] - strobe[t - k, 1])
            distance = max(distance, x, v)
        distance /= size
        nearest = min(nearest, distance)
        if distance <= _NEAR:
            nearing |= distance <= _STILL or distance < _SHRINKING * apart[k - 1]
        apart[k - 1] = distance
    if nearest <= _NEAR:
        for k in range(LONGEST_PERIOD, 0, -1):
            if apart[k - 1] <= max(_NEAR, _ALIKE * nearest):
                period = k
    return period, nearing


@inlined
def regime_of(period, right, left):
    """Return the regime of a response near an orbit of k periods, from the work at each site."""
    if right + left == 0.0:
        return NO_IMPACT
    if period == 1:
        return SYMMETRIC if abs(right - left) <= _SYMMETRIC * (right + left) else ASYMMETRIC
    return PERIODIC if period > 1 else APERIODIC


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
        looks = 0
        while looks < regime.shape[1] and regime[i, looks] != UNKNOWN:
            looks += 1
        now, streak = UNKNOWN, 0
        for look in range(looks):
            seen = regime[i, look]
            streak = streak + 1 if look > 0 and seen == regime[i, look - 1] else 1
            is_end = seen == NO_IMPACT and look == looks - 1
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
