"""Lifetimes: the gaps grow while the beam rattles, only many times faster than in life.

Archard's law with impact work (eqs 5, 9 to 12 of Knudsen & Massih 2002) makes a gap grow by a
constant times the work done on its site. Life lasts some 1e9 forcing periods; with the wear
coefficient multiplied by an acceleration K it takes N periods, and the life is K times as long as
what was simulated. K follows the running work-rate, so that the gap which grows faster grows by
the same amount per period all along: N is known beforehand, whatever the work-rate does.

The limit of infinitely slow wear is what a lifetime means. Each run lasts twice as long as the one
before and is nearer to it; how the differences fall tells how near: see `extrapolate`.
"""

import math
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.modal import Array

SHORTEST = 64  # N of the first run; each further one lasts twice as long
LONGEST = 660  # over the accuracy: N of the last run at most
LOOKS = 32  # changes of the acceleration in N periods
OVERTIME = 4  # a run may last this many times N periods
_MEMORY = 0.25  # weight of the newest look in the running work-rate
_SILENCE = 64  # periods without contact after which a beam that need not touch never will
_EXTINCT = 1e-6  # of the first work-rate: what is left when the gaps approach the free amplitude


class Run(NamedTuple):
    """One accelerated life of n beams.

    Attributes
    ----------
    time : ndarray, shape (n, 2, D)
        Life of each site to each growth, in forcing periods over the wear per work of the right
        site [X0 per nondimensional work]; inf if never, else the time reached.
    reached : ndarray of bool, shape (n, 2, D)
    ended : ndarray of bool, shape (n,)
        Whether wear has stopped for good: what was not reached never will be.
    ratio : ndarray, shape (n, D)
        Gap of the other site over that of the first to reach the growth, then; NaN if never.
    """

    time: Array
    reached: NDArray[np.bool_]
    ended: NDArray[np.bool_]
    ratio: Array


def run(
    propagator: ModuleType,
    system: Any,
    state: Array,
    gaps: Array,
    work: Array,
    share: Array,
    growths: Array,
    periods: int,
) -> Run:
    """Let the gaps of n beams grow in about `periods` forcing periods.

    Parameters
    ----------
    propagator : module
        `models.beam.lanes` or `models.beam.exact`.
    system
        What the propagator prepared.
    state : ndarray, shape (n, k)
        Settled at the initial gaps; not changed.
    gaps : ndarray, shape (n, 2)
        Initial, in X0; not changed.
    work : ndarray, shape (n, 2)
        Mean nondimensional work per period at the initial gaps.
    share : ndarray, shape (n, 2)
        Wear coefficient of each site over that of the right site.
    growths : ndarray, shape (n, D)
        Gap growths to reach, increasing, in X0.
    periods : int
        N: what the faster site takes to the last growth.

    Returns
    -------
    Run
    """
    n, depths = growths.shape
    out = Run(
        np.zeros((n, 2, depths)),
        np.zeros((n, 2, depths), bool),
        np.zeros(n, bool),
        np.full((n, depths), np.nan),
    )
    state, now = state.copy(), gaps.copy()
    look = periods // LOOKS
    head_start = growths[:, 0] / 2
    pace = np.log1p(growths[:, -1] / head_start) / periods
    rate = work * share
    first = rate.max(axis=1)
    silence = np.zeros(n, np.int64)
    clock = np.zeros(n)
    reach = np.abs(system.modal.sum(axis=1))
    left = np.arange(n)
    for _ in range(LOOKS * OVERTIME):
        control = np.where(out.reached[left, :, -1], 0.0, rate[left]).max(axis=1)
        before, here, x = now[left], now[left], state[left]
        grown = (here - gaps[left]).max(axis=1)
        step = pace[left] * (grown + head_start[left])
        acceleration = np.divide(step, control, out=np.zeros_like(step), where=control > 0)
        record = propagator.advance(
            system.take(left), x, here, acceleration[:, None] * share[left], look
        )
        state[left], now[left] = x, here
        _note_crossings(out, left, record.work, acceleration, share, before, gaps, growths, clock)
        clock[left] += acceleration * look
        mean = record.work.mean(axis=1) * share[left]
        rate[left] += _MEMORY * (mean - rate[left])
        quiet = (record.work == 0).all(axis=(1, 2))
        silence[left] = np.where(quiet, silence[left] + look, 0)
        out.ended[left] = _has_ended(silence[left], rate[left], first[left], reach[left], here)
        left = left[~(out.ended[left] | out.reached[left, :, -1].all(axis=1))]
        if not len(left):
            break
    missing = ~out.reached
    never = out.ended[:, None, None]
    out.time[missing] = np.where(never, np.inf, clock[:, None, None] + 0 * out.time)[missing]
    return out


def _has_ended(silence: Any, rate: Array, first: Array, reach: Array, gaps: Array) -> Any:
    """Tell where no contact is left, or so little that no greater depth is ever reached.

    A gap that grows towards the free amplitude comes near it like 1/t, not in finite time.
    """
    narrow = gaps.min(axis=1)
    silent = (silence >= _SILENCE) & (reach < narrow)
    fading = (rate.max(axis=1) <= _EXTINCT * first) & (reach < 1.01 * narrow)
    return silent | fading


def _note_crossings(
    out: Run,
    rows: Any,
    work: Array,
    acceleration: Array,
    share: Array,
    before: Array,
    gaps: Array,
    growths: Array,
    clock: Array,
) -> None:
    """Note when, in the periods just simulated, a growth was reached; linear within a period."""
    steps = (acceleration[:, None] * share[rows])[:, None, :] * work
    grown = np.cumsum(np.concatenate([(before - gaps[rows])[:, None], steps], axis=1), axis=1)
    for depth in range(growths.shape[1]):
        goal = growths[rows, depth]
        earliest = np.where(out.reached[rows, :, depth].any(axis=1), -np.inf, np.inf)
        for site in range(2):
            new = ~out.reached[rows, site, depth] & (grown[:, -1, site] >= goal)
            at, path = rows[new], grown[new]
            j = (path[:, :, site] < goal[new, None]).sum(axis=1) - 1
            i = np.arange(len(j))
            low, high = path[i, j, site], path[i, j + 1, site]
            part = (goal[new] - low) / (high - low)
            when = acceleration[new] * (j + part)
            out.time[at, site, depth] = clock[at] + when
            out.reached[at, site, depth] = True
            both = gaps[at] + path[i, j] + part[:, None] * (path[i, j + 1] - path[i, j])
            first = when < earliest[new]
            out.ratio[at[first], depth] = (both[:, 1 - site] / both[:, site])[first]
            earliest[new] = np.minimum(earliest[new], when)


class Lives(NamedTuple):
    """Lifetimes of n beams in the limit of slow wear, with their numerical errors.

    Attributes
    ----------
    time : ndarray, shape (n, 3, D)
        Right site, left site and the earlier of the two, in the unit of `Run.time`.
    error : ndarray, shape (n, 3, D)
        Estimated numerical error, NaN where the growth is not reached.
    reached : ndarray of bool, shape (n, 3, D)
        False where the time is infinite, or only the time simulated.
    ratio : ndarray, shape (n, D)
        As in `Run`.
    """

    time: Array
    error: Array
    reached: NDArray[np.bool_]
    ratio: Array

    @staticmethod
    def nothing(n: int, depths: int) -> "Lives":
        """Return what is known of n beams before they are run."""
        unknown = np.full((2, n, 3, depths), np.nan)
        ratio = np.full((n, depths), np.nan)
        return Lives._make([*unknown, np.zeros((n, 3, depths), bool), ratio])


def lives(
    propagator: ModuleType,
    system: Any,
    state: Array,
    gaps: Array,
    work: Array,
    share: Array,
    growths: Array,
    accuracy: float,
) -> Lives:
    """Repeat the accelerated life ever more slowly until it no longer depends on the pace.

    Parameters
    ----------
    propagator, system, state, gaps, work, share, growths
        As in `run`.
    accuracy : float
        Relative error at which a beam's lives are good enough. It also sets the longest run: where
        that does not suffice, the error says so.

    Returns
    -------
    Lives
    """
    n, depths = growths.shape
    out = Lives.nothing(n, depths)
    levels = max(3, 1 + int(math.log2(LONGEST / (SHORTEST * accuracy))))
    times = np.empty((levels, n, 2, depths))
    left = np.arange(n)
    for level in range(levels):
        one = run(
            propagator,
            system.take(left),
            state[left],
            gaps[left],
            work[left],
            share[left],
            growths[left],
            SHORTEST * 2**level,
        )
        times[level, left] = one.time
        before, out.reached[left, :2] = out.reached[left, :2], one.reached
        out.ratio[left] = one.ratio
        if level < 2:
            continue
        time, error = extrapolate(times[level - 2 : level + 1, left])
        # A life that one of the runs did not reach is known no better than by its own size.
        error = np.where(before & np.isfinite(error), np.minimum(error, time), time)
        out.time[left, :2] = np.where(one.reached, time, one.time)
        out.error[left, :2] = np.where(one.reached, error, np.nan)
        good = (one.reached == before) & (~one.reached | (error <= accuracy * time))
        left = left[~good.all(axis=(1, 2))]
        if not len(left):
            break
    _take_the_earlier(out)
    return out


def _take_the_earlier(out: Lives) -> None:
    sites = np.where(out.reached[:, :2], out.time[:, :2], np.inf)
    earlier = sites.argmin(axis=1)[:, None]
    for field in (out.time, out.error, out.reached):
        field[:, 2] = np.take_along_axis(field[:, :2], earlier, axis=1)[:, 0]


def extrapolate(times: Array) -> tuple[Array, Array]:
    """Estimate the life at infinitely slow wear from lives at N, 2 N and 4 N periods.

    Where the response follows the gaps smoothly it lags behind by a time that does not depend on
    the pace, so that the error falls like 1/N; through a change of branch (a slow passage) it
    falls like N^(-2/3). In both cases the differences of the lives are a geometric series of
    ratio 2 or 1.6, whose rest is added; a third of that rest is kept as the error. Differences
    that grow say that a change is not resolved yet, and their error is several times the last;
    any other sequence is that of an aperiodic response, whose error is statistical.

    Parameters
    ----------
    times : ndarray, shape (3, ...)
        Lives, the slowest wear last.

    Returns
    -------
    time, error : ndarray, shape (...)
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        previous, last = times[1] - times[0], times[2] - times[1]
        ratio = previous / last
        regular = (ratio > 1.4) & (ratio < 2.4)
        growing = (ratio > 0) & (ratio < 1)
        rest = np.where(regular, last / (ratio - 1), 0.0)
        statistical = np.maximum(np.abs(last), 0.7 * np.abs(previous))
        error = np.where(growing, 4 * np.abs(last), statistical)
        return times[2] + rest, np.where(regular, np.abs(rest) / 3, error)
