"""The settled response at constant gaps: which regime it is, and its work-rate.

The tip is looked at once per forcing period. A response whose strobe points return after k periods
is periodic, and its work-rate is exact; one that has not settled within the budget is aperiodic,
and its work-rate is a time mean with the standard error of batch means. Under a random load it
never settles, see `models.beam.averages`.
"""

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.averages import time_mean
from models.beam.modal import Array
from models.beam.parameters import REGIMES
from models.numerics.batch_means import mean_and_error

SEGMENT = 32  # periods between two looks; also the length of a batch
LONGEST_PERIOD = 16
TRANSIENT = 4  # segments left out of a time mean
BUDGET = 32  # segments
RANDOM_ACCURACY = 0.05  # relative error of a mean work-rate under a random load
RANDOM_BUDGET = 16_384  # periods
_SETTLED = 1e-4  # distance to the orbit, relative to the response
_SHRINKING = 0.9  # factor of that distance from one look to the next
_SYMMETRIC = 1e-3  # difference of the sites' work, relative to their sum

NO_IMPACT, SYMMETRIC, ASYMMETRIC, PERIODIC, APERIODIC = range(len(REGIMES))


class Response(NamedTuple):
    """The settled response of n beams at constant gaps.

    Attributes
    ----------
    work : ndarray, shape (n, 2)
        Mean nondimensional work per forcing period at the right and the left site.
    error : ndarray, shape (n, 2)
        Its standard error, 0 if periodic.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    regime : ndarray of int8, shape (n,)
        Index into `models.beam.parameters.REGIMES`.
    period : ndarray, shape (n,)
        In forcing periods, 0 if aperiodic.
    """

    work: Array
    error: Array
    peak: Array
    regime: NDArray[np.int8]
    period: Array

    @staticmethod
    def nothing(n: int) -> "Response":
        """Return what is known of n beams before they are run."""
        regime = np.full(n, APERIODIC, np.int8)
        return Response._make([*np.full((3, n, 2), np.nan), regime, np.full(n, np.nan)])


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
    """
    n = len(state)
    out = Response(
        np.zeros((n, 2)),
        np.zeros((n, 2)),
        np.zeros((n, 2)),
        np.full(n, APERIODIC, np.int8),
        np.zeros(n),
    )
    never_touches = system.reach < gaps.min(axis=1)
    batches = np.zeros((n, BUDGET, 2))
    distance = np.full((n, LONGEST_PERIOD), np.inf)
    random = np.flatnonzero(system.is_random)
    if len(random):
        _settle_random(propagator, system, state, gaps, never_touches, random, out)
    left = np.flatnonzero(~system.is_random)
    for segment in range(BUDGET):
        if not len(left):
            break
        now, here = state[left], gaps[left].copy()
        record = propagator.advance(system.take(left), now, here, np.zeros_like(here), SEGMENT)
        state[left] = now
        batches[left, segment] = record.work.mean(axis=1)
        if segment >= TRANSIENT:
            out.peak[left] = np.maximum(out.peak[left], record.peak)
        silent = never_touches[left] & (record.work == 0).all(axis=(1, 2))
        before, distance[left] = distance[left], _distances(record.strobe)
        period = _period(before, distance[left], record.strobe)
        period[silent] = 1
        _note_periodic(out, left, period, silent, record)
        left = left[period == 0]
    _note_aperiodic(out, left, batches)
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
    mean = time_mean(propagator, system.take(rows), now, gaps[rows], RANDOM_ACCURACY, RANDOM_BUDGET)
    state[rows] = now
    out.work[rows], out.error[rows], out.peak[rows] = mean
    silent = rows[never_touches[rows] & (mean.work == 0).all(axis=1)]
    out.regime[silent], out.period[silent] = NO_IMPACT, 1


def _distances(strobe: Array) -> Array:
    """Return the largest distance of strobe points k periods apart, for each k."""
    half = strobe[:, -LONGEST_PERIOD:]
    lags = [
        np.abs(half - strobe[:, SEGMENT - LONGEST_PERIOD - k : SEGMENT - k]).max(axis=(1, 2))
        for k in range(1, LONGEST_PERIOD + 1)
    ]
    return np.stack(lags, axis=1)


def _period(before: Array, now: Array, strobe: Array) -> NDArray[np.int64]:
    """Return the shortest period to which a response has settled, 0 if none.

    With distances falling by a constant factor per period, what is left to the orbit is the sum of
    a geometric series.
    """
    scale = np.abs(strobe).max(axis=(1, 2))[:, None]
    lag = np.arange(1, LONGEST_PERIOD + 1)
    exact = now <= 1e-10 * scale
    with np.errstate(divide="ignore", invalid="ignore"):
        contraction = np.where(exact, 0.0, np.where(np.isinf(before), 1.0, now / before))
        remaining = np.where(exact, 0.0, now / (1 - contraction ** (lag / SEGMENT)))
    settling = contraction < _SHRINKING
    settled = settling & (remaining < _SETTLED * scale)
    # Distances over every multiple of the period shrink alike; over any other lag they do not.
    return np.where(settled.any(axis=1), settling.argmax(axis=1) + 1, 0)


def _note_periodic(out: Response, rows: Any, period: Any, silent: Any, record: Any) -> None:
    for k in np.unique(period[period > 0]):
        chosen = period == k
        whole = SEGMENT // k * k
        work = record.work[chosen, -whole:].mean(axis=1)
        out.work[rows[chosen]] = work
        out.peak[rows[chosen]] = record.peak[chosen]
        out.period[rows[chosen]] = k
        if k == 1:
            symmetric = np.abs(work[:, 0] - work[:, 1]) <= _SYMMETRIC * work.sum(axis=1)
            regime = np.where(symmetric, SYMMETRIC, ASYMMETRIC)
            out.regime[rows[chosen]] = np.where(silent[chosen], NO_IMPACT, regime)
        else:
            out.regime[rows[chosen]] = PERIODIC


def _note_aperiodic(out: Response, rows: Any, batches: Array) -> None:
    out.work[rows], out.error[rows] = mean_and_error(batches[rows, TRANSIENT:])
