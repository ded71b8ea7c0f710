"""The settled response at constant gaps: which regime it is, and its work-rate.

The tip is looked at once per forcing period. Where its strobe points seem to approach an orbit of
k periods, Newton's method on the map of k periods looks for it; if it is there, near and stable,
the response is that orbit and its work-rate is exact. A response that has not come near a stable
orbit within the budget is aperiodic, and its work-rate is a time mean with the standard error of
batch means. Under a random load it never settles, see `models.beam.averages`.
"""

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.approach import Approached, approached
from models.beam.averages import time_mean
from models.beam.modal import Array
from models.beam.parameters import REGIMES
from models.numerics.batch_means import mean_and_error
from models.numerics.jit import kernel

SEGMENT = 32  # periods between two looks; also the length of a batch
LONGEST_PERIOD = 16
TRANSIENT = 4  # segments left out of a time mean
BUDGET = 32  # segments
RANDOM_ACCURACY = 0.05  # relative error of a mean work-rate under a random load
MEMORIES = 5  # times what the beam remembers: a budget within which it forgets its start
_NEAR = 0.05  # k times the distance of strobe points k periods apart, relative to the response
_SHRINKING = 0.9  # factor of that distance from one look to the next
_NEARER = 0.5  # that distance over the one at which an orbit was looked for in vain
_SYMMETRIC = 1e-3  # difference of the sites' work, relative to their sum

NO_IMPACT, SYMMETRIC, ASYMMETRIC, PERIODIC, APERIODIC = range(len(REGIMES))


class Response(NamedTuple):
    """The settled response of n beams at constant gaps.

    Attributes
    ----------
    work : ndarray, shape (n, 2)
        Mean dimensionless work per forcing period at the right and the left site.
    error : ndarray, shape (n, 2)
        Its standard error, 0 if periodic.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    regime : ndarray of int8, shape (n,)
        Index into `models.beam.parameters.REGIMES`.
    period : ndarray, shape (n,)
        In forcing periods, 0 if aperiodic.
    multiplier : ndarray, shape (n,)
        Largest modulus of the orbit's Floquet multipliers, over its period; NaN if aperiodic or
        without impacts.
    """

    work: Array
    error: Array
    peak: Array
    regime: NDArray[np.int8]
    period: Array
    multiplier: Array

    @staticmethod
    def nothing(n: int) -> "Response":
        """Return what is known of n beams before they are run."""
        regime = np.full(n, APERIODIC, np.int8)
        unknown = np.full((2, n), np.nan)
        return Response._make([*np.full((3, n, 2), np.nan), regime, *unknown])

    def forget(self, rows: NDArray[np.intp]) -> None:
        """Know nothing of some beams."""
        fields: tuple[Any, ...] = self
        for mine, unknown in zip(fields, Response.nothing(len(rows)), strict=True):
            mine[rows] = unknown


def settle(propagator: ModuleType, system: Any, state: Array, gaps: Array) -> Response:
    """Run n beams until they have settled.

    Parameters
    ----------
    propagator : module
        `models.beam.lanes` or `models.beam.exact`.
    system
        What the propagator prepared.
    state : ndarray, shape (n, k)
        Updated in place: the state at the end.
    gaps : ndarray, shape (n, 2)
        In initial gaps.

    Returns
    -------
    Response
        NaN for a beam that no propagator can follow, or whose motion has neither come near an orbit
        nor forgotten its start within the budget.
    """
    n = len(state)
    out = Response(
        np.zeros((n, 2)),
        np.zeros((n, 2)),
        np.zeros((n, 2)),
        np.full(n, APERIODIC, np.int8),
        np.zeros(n),
        np.full(n, np.nan),
    )
    never_touches = system.reach < gaps.min(axis=1)
    batches = np.zeros((n, BUDGET, 2))
    distance = np.full((n, LONGEST_PERIOD), np.inf)
    random = np.flatnonzero(system.is_random)
    if len(random):
        _settle_random(propagator, system, state, gaps, never_touches, random, out)
    lag = np.arange(1, LONGEST_PERIOD + 1)
    tried = np.tile(_NEAR / _NEARER / lag, (n, 1))
    left = np.flatnonzero(~system.is_random)
    for segment in range(BUDGET):
        if not len(left):
            break
        part, now, here = system.take(left), state[left], gaps[left].copy()
        record = propagator.advance(part, now, here, np.zeros_like(here), SEGMENT)
        state[left] = now
        batches[left, segment] = record.work.mean(axis=1)
        if segment >= TRANSIENT:
            out.peak[left] = np.maximum(out.peak[left], record.peak)
        size = np.abs(record.strobe).max(axis=(1, 2))
        before, distance[left] = distance[left], _distances(record.strobe, size)
        silent = never_touches[left] & (record.work == 0).all(axis=(1, 2))
        _note_silence(out, left[silent])
        guess = np.zeros(len(left), int)
        if (segment + 1) % (1 + segment // 4) == 0:  # late ones wait for company
            guess = np.where(silent, 0, _guess(before, distance[left], tried[left]))
        for k in np.unique(guess[guess > 0]):
            rows = left[guess == k]
            tried[rows, k - 1] = distance[rows, k - 1]
            orbit = approached(
                propagator, system.take(rows), state[rows], gaps[rows], size[guess == k], int(k)
            )
            _note_orbit(out, rows, orbit, state)
        left = left[out.period[left] == 0]
    _note_aperiodic(out, left, batches)
    forgetful = MEMORIES * system.memory[left] <= BUDGET * SEGMENT
    out.forget(left[~forgetful])
    out.forget(np.flatnonzero(np.isnan(out.work).any(axis=1)))
    return out


def _settle_random(
    propagator: ModuleType,
    system: Any,
    state: Array,
    gaps: Array,
    never_touches: NDArray[np.bool_],
    rows: NDArray[np.intp],
    out: Response,
) -> None:
    """Average over a random load: nothing repeats, so only silence can be told from the rest."""
    now = state[rows]
    mean = time_mean(propagator, system.take(rows), now, gaps[rows], RANDOM_ACCURACY, 0)
    state[rows] = now
    out.work[rows], out.error[rows], out.peak[rows] = mean
    silent = rows[never_touches[rows] & (mean.work == 0).all(axis=1)]
    out.regime[silent], out.period[silent] = NO_IMPACT, 1


@kernel
def _distances(strobe, size):
    """Return how far strobe points k periods apart lie from each other, over the response's size.

    For each k, the largest of the last `LONGEST_PERIOD` distances.
    """
    n, periods, _ = strobe.shape
    distance = np.zeros((n, LONGEST_PERIOD))
    for row in range(n):
        for at in range(periods - LONGEST_PERIOD, periods):
            x, v = strobe[row, at]
            for k in range(1, LONGEST_PERIOD + 1):
                apart = max(abs(x - strobe[row, at - k, 0]), abs(v - strobe[row, at - k, 1]))
                distance[row, k - 1] = max(distance[row, k - 1], apart)
        distance[row] /= size[row]
    return distance


def _guess(before: Array, now: Array, tried: Array) -> NDArray[np.int64]:
    """Return the shortest period an orbit may have that a response comes near, 0 if none."""
    shrinking = now < _SHRINKING * before
    first = shrinking.argmax(axis=1)
    rows = np.arange(len(now))
    near = shrinking[rows, first] & (now[rows, first] < _NEARER * tried[rows, first])
    return np.where(near, first + 1, 0)


def _note_silence(out: Response, rows: NDArray[np.intp]) -> None:
    out.regime[rows] = NO_IMPACT
    out.period[rows] = 1
    out.peak[rows] = 0
    out.multiplier[rows] = np.nan


def _note_orbit(out: Response, rows: Any, orbit: Approached, state: Array) -> None:
    good = orbit.found
    rows, work = rows[good], orbit.work[good]
    state[rows] = orbit.state[good]
    out.work[rows] = work
    out.peak[rows] = orbit.peak[good]
    out.period[rows] = orbit.period[good]
    out.multiplier[rows] = orbit.multiplier[good]
    symmetric = np.abs(work[:, 0] - work[:, 1]) <= _SYMMETRIC * work.sum(axis=1)
    single = np.where(symmetric, SYMMETRIC, ASYMMETRIC)
    out.regime[rows] = np.where(orbit.period[good] == 1, single, PERIODIC)
    _note_silence(out, rows[(work == 0).all(axis=1)])


def _note_aperiodic(out: Response, rows: Any, batches: Array) -> None:
    out.work[rows], out.error[rows] = mean_and_error(batches[rows, TRANSIENT:])
