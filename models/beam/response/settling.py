"""The settled response at constant gaps: its regime and work-rate.

The tip is observed once per forcing period. Where its strobe points seem to approach an orbit of k
periods, Newton's method on the map of k periods searches for it; if a stable one exists nearby, the
response is that orbit and its work-rate is exact. A response that has not come near to a stable
orbit is aperiodic, and its work-rate is a time mean with the error of batch means. It is observed
for `SHORTEST` segments; the time is doubled repeatedly while the mean is uncertain, the start is
not yet forgotten, or a beam that can move without contact may still come to do so. Under a random
load it never settles; see `models.beam.response.averages`.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import LONGEST_PERIOD
from models.beam.response.approached_orbits import Approached, approached
from models.beam.response.averages import NINE_IN_TEN, time_mean
from models.beam.response.response import (
    APERIODIC,
    ASYMMETRIC,
    NO_IMPACT,
    PERIODIC,
    SYMMETRIC,
    Response,
)
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.numerics.batch_means import mean_and_bound
from models.numerics.jit import kernel

SEGMENT = 32  # periods between two checks; also the length of a batch
SHORTEST, LONGEST = 32, 512  # segments of a look
MOST_STEPS = 2**24  # of a look
RANDOM_ACCURACY = 0.05  # relative standard error of a mean work-rate under a random load
ACCURACY = NINE_IN_TEN * RANDOM_ACCURACY  # error of a mean above which a look is extended
TURNS = 2  # of the first mode without contact, after which there will be none
MEMORIES = 5  # memories of the beam after which it has forgotten its start
_NEAR = 0.05  # k times the distance of strobe points k periods apart, relative to the response
_SHRINKING = 0.9  # factor of that distance from one check to the next
_NEARER = 0.5  # that distance over the one at which a search for an orbit failed
_SYMMETRIC = 1e-3  # difference of the sites' work, relative to their sum


def settle(
    propagator: Propagator, system: System, state: Array, gaps: Array, shortest: int = SHORTEST
) -> Response:
    """Run n beams until they have settled.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    state : ndarray, shape (n, k)
        Updated in place: the state at the end.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    shortest : int
        Segments in which an aperiodic response is observed, at least.

    Returns
    -------
    Response
        NaN for a beam that no propagator can follow, or whose motion has neither come near to an
        orbit nor forgotten its start within the longest look.
    """
    out = Response.settling(len(state))
    never_touches = system.free_reach < gaps.min(axis=1)
    random = np.flatnonzero(system.beams.is_random)
    if len(random):
        _settle_random(propagator, system, state, gaps, never_touches, random, out)
    longest = min(LONGEST, max(SHORTEST, MOST_STEPS // (SEGMENT * system.steps)))
    harmonic = np.flatnonzero(~system.beams.is_random)
    look(propagator, system, state, gaps, harmonic, out, longest, shortest)
    remembers = ~system.beams.is_random & (MEMORIES * system.beams.memory > longest * SEGMENT)
    out.forget(np.flatnonzero(remembers & (out.regime == APERIODIC)))
    out.forget(np.flatnonzero(np.isnan(out.work).any(axis=1)))
    return out


def look(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    rows: NDArray[np.intp],
    out: Response,
    longest: int,
    shortest: int = SHORTEST,
) -> None:
    """Follow some of n beams until they are silent, on an orbit, or accurately averaged.

    Parameters
    ----------
    propagator, system, state, gaps
        As in `settle`.
    rows : ndarray of int
    out : Response
        Updated in place.
    longest, shortest : int
        Segments.
    """
    n = len(state)
    never_touches = system.free_reach < gaps.min(axis=1)
    batches = np.zeros((n, longest, 2))
    quiet = np.zeros(n)
    distance = np.full((n, LONGEST_PERIOD), np.inf)
    lag = np.arange(1, LONGEST_PERIOD + 1)
    tried = np.tile(_NEAR / _NEARER / lag, (n, 1))
    left, segment, total = rows, 0, shortest
    part = system.take(left)
    while len(left):
        now, here = state[left], gaps[left]
        record = propagator.advance(part, now, here, np.zeros_like(here), SEGMENT)
        state[left] = now
        batches[left, segment], size, apart, silence = _observe(record.work, record.strobe)
        if segment >= shortest // 4:
            out.peak[left] = np.maximum(out.peak[left], record.peak)
        before, distance[left] = distance[left], apart
        quiet[left] = np.where(silence, quiet[left] + SEGMENT, 0)
        silent = never_touches[left] & (quiet[left] >= np.maximum(SEGMENT, TURNS * part.beams.turn))
        _note_silence(out, left[silent])
        guess = np.zeros(len(left), int)
        if (segment + 1) % (1 + segment // 4) == 0:  # later rows wait, to be treated together
            guess = np.where(silent, 0, _guess(before, distance[left], tried[left]))
        for k in np.unique(guess[guess > 0]):
            candidates = left[guess == k]
            tried[candidates, k - 1] = distance[candidates, k - 1]
            orbit = approached(
                propagator,
                system.take(candidates),
                state[candidates],
                gaps[candidates],
                size[guess == k],
                int(k),
            )
            note_orbit(out, candidates, orbit, state)
        left = left[out.period[left] == 0]
        segment += 1
        if segment == total:
            out.work[left], out.error[left] = mean_and_bound(batches[left, total // 4 : total])
            remembers = MEMORIES * system.beams.memory[left] > total * SEGMENT
            enough = ACCURACY * out.work[left].max(axis=1, keepdims=True)
            uncertain = (out.error[left] > enough).any(axis=1)
            unsettled = remembers | uncertain | never_touches[left]
            if 2 * total > longest:
                break
            left, total = left[unsettled], 2 * total
        if len(left) < len(now):
            part = system.take(left)


def _settle_random(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    never_touches: NDArray[np.bool_],
    rows: NDArray[np.intp],
    out: Response,
) -> None:
    """Average over a random load: nothing repeats, so silence is the only other regime."""
    now = state[rows]
    mean = time_mean(propagator, system.take(rows), now, gaps[rows], RANDOM_ACCURACY, 0)
    state[rows] = now
    out.work[rows], out.peak[rows] = mean.work, mean.peak
    out.error[rows] = NINE_IN_TEN * mean.error
    silent = rows[never_touches[rows] & (mean.work == 0).all(axis=1)]
    out.regime[silent], out.period[silent] = NO_IMPACT, 1


@kernel
def _observe(work, strobe):
    """Return statistics of a segment of n responses.

    Returns
    -------
    mean : ndarray, shape (n, 2)
        Work per period.
    size : ndarray, shape (n,)
        Largest displacement or velocity.
    distance : ndarray, shape (n, LONGEST_PERIOD)
        Of strobe points k periods apart, relative to the size; for each k, the largest of the last
        `LONGEST_PERIOD`.
    silence : ndarray of bool, shape (n,)
        Whether neither stop has been touched.
    """
    n, periods, _ = strobe.shape
    mean, size, silence = np.zeros((n, 2)), np.zeros(n), np.ones(n, np.bool_)
    distance = np.zeros((n, LONGEST_PERIOD))
    for row in range(n):
        for s in range(2):
            for at in range(periods):
                mean[row, s] += work[row, at, s]
                silence[row] &= work[row, at, s] == 0
                size[row] = max(size[row], abs(strobe[row, at, s]))
            mean[row, s] /= periods
        for at in range(periods - LONGEST_PERIOD, periods):
            x, v = strobe[row, at]
            for k in range(1, LONGEST_PERIOD + 1):
                apart = max(abs(x - strobe[row, at - k, 0]), abs(v - strobe[row, at - k, 1]))
                distance[row, k - 1] = max(distance[row, k - 1], apart)
        for k in range(LONGEST_PERIOD):
            distance[row, k] /= size[row]
    return mean, size, distance, silence


def _guess(before: Array, now: Array, tried: Array) -> NDArray[np.int64]:
    """Return the shortest period of an orbit that a response may approach, 0 if none."""
    shrinking = now < _SHRINKING * before
    first = shrinking.argmax(axis=1)
    rows = np.arange(len(now))
    near = shrinking[rows, first] & (now[rows, first] < _NEARER * tried[rows, first])
    return np.where(near, first + 1, 0)


def _note_silence(out: Response, rows: NDArray[np.intp]) -> None:
    out.work[rows] = out.error[rows] = 0
    out.regime[rows] = NO_IMPACT
    out.period[rows] = 1
    out.peak[rows] = 0
    out.multiplier[rows] = np.nan


def note_orbit(out: Response, rows: Any, orbit: Approached, state: Array) -> None:
    """Record the orbits that some beams approach, and put the beams onto them."""
    good = orbit.exists
    rows, work = rows[good], orbit.work[good]
    state[rows] = orbit.state[good]
    out.work[rows], out.error[rows] = work, 0.0
    out.peak[rows] = orbit.peak[good]
    out.period[rows] = orbit.period[good]
    out.multiplier[rows] = orbit.multiplier[good]
    symmetric = np.abs(work[:, 0] - work[:, 1]) <= _SYMMETRIC * work.sum(axis=1)
    single = np.where(symmetric, SYMMETRIC, ASYMMETRIC)
    out.regime[rows] = np.where(orbit.period[good] == 1, single, PERIODIC)
    _note_silence(out, rows[(work == 0).all(axis=1)])
