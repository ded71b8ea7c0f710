"""Times to disphasing of n machines, with causes and numerical errors."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.parameters import Rows, Settings
from models.vibrator.service import steady
from models.vibrator.service.course import (
    ANGLE,
    LATE,
    LOST,
    NOT_ENDED,
    SPRING,
    Answer,
    Life,
    Query,
    Task,
    course,
)
from models.vibrator.service.slow_states import (
    Array,
    Springs,
    changes,
    in_service,
    rows_of,
    spring_breaks,
    stopped_by_friction,
)
from models.vibrator.start.regimes import LOCKED_0, LOCKED_PI


class Lives(NamedTuple):
    """Lives of n machines.

    Attributes
    ----------
    time, error : ndarray, shape (n,)
        [s]; the error is NaN of a life that is infinite or censored.
    censored : ndarray of bool, shape (n,)
    cause : ndarray of int8, shape (n,)
        Index into `models.vibrator.parameters.CAUSES`, -1 of a life that has not ended.
    """

    time: Array
    error: Array
    censored: NDArray[np.bool_]
    cause: NDArray[np.int8]


def lives(
    p: Rows,
    seed: NDArray[np.uint64],
    regime: NDArray[np.int8],
    angle: Array,
    undecided: NDArray[np.bool_],
    quick: NDArray[np.bool_],
    settings: Settings,
) -> Lives:
    """Find when n machines exceed the limit of the disphasing angle, or lose synchronisation.

    Parameters
    ----------
    p : Params
        When new, each field an ndarray of shape (n,).
    seed : ndarray of uint64, shape (n,)
        Of the times at which springs break.
    regime : ndarray of int8, shape (n,)
        When new, -1 if unknown.
    angle : ndarray, shape (n,)
        Disphasing angle when new [rad].
    undecided : ndarray of bool, shape (n,)
        Where a run-up ended too early to show whether the motors lock.
    quick : ndarray of bool, shape (n,)
        Which machines lanes can follow.
    settings : Settings

    Returns
    -------
    Lives
        0 of a machine beyond the limit, or not synchronous, when new; infinite of one within
        it that does not change; censored at the horizon, or at 0 where the run-up does not show
        whether the motors lock; NaN where nothing is known.
    """
    n = len(regime)
    locked = (regime == LOCKED_0) | (regime == LOCKED_PI)
    decided = (regime >= 0) & (locked | ~undecided)
    time = np.where(regime >= 0, 0.0, np.nan)
    out = Lives(time, np.full(n, np.nan), (regime >= 0) & ~decided, np.full(n, -1, np.int8))
    within = locked & (np.abs(angle) <= settings.angle_limit)
    over = decided & ~within
    out.error[over] = 0.0
    out.cause[over] = np.where(locked, ANGLE, LOST)[over]
    lasting = within & ~changes(p)
    out.time[lasting] = np.inf
    rows = np.flatnonzero(within & changes(p))
    if len(rows):
        fleet = _Fleet.new(rows_of(p, rows), seed[rows], angle[rows], quick[rows], settings)
        for i, life in zip(rows.tolist(), _follow(fleet, settings), strict=True):
            out.time[i], out.error[i] = life.time, life.error
            out.censored[i] = life.cause == LATE
            out.cause[i] = NOT_ENDED if life.cause == LATE else life.cause
    return out


def angles_in_service(
    p: Rows,
    seed: NDArray[np.uint64],
    regime: NDArray[np.int8],
    angle: Array,
    quick: NDArray[np.bool_],
    settings: Settings,
) -> Array:
    """Return the disphasing angles of n machines at the times in service that are asked for.

    Arguments as for `lives`.

    Returns
    -------
    ndarray, shape (n, len(settings.service_times))
        [rad]; NaN of a machine that does not lock when new, or has no synchronous running then.
    """
    out = np.full((len(regime), len(settings.service_times)), np.nan)
    rows = np.flatnonzero((regime == LOCKED_0) | (regime == LOCKED_PI))
    if not len(rows):
        return out
    out[rows] = angle[rows, None]
    rows = rows[changes(rows_of(p, rows))]
    if not len(rows):
        return out
    fleet = _Fleet.new(rows_of(p, rows), seed[rows], angle[rows], quick[rows], settings)
    springs, each = fleet.springs, np.arange(len(rows))
    for j, time in enumerate(settings.service_times):
        broken = (springs.time <= time).sum(axis=1)
        stands = (springs.left[each, broken] > 0) & (springs.right[each, broken] > 0)
        out[rows, j] = np.nan
        asked = {i: Query(True, time, int(broken[i])) for i in each[stands].tolist()}
        if asked:
            answers = fleet.answers(asked, settings)
            out[rows[stands], j] = [answer.angle for answer in answers]
    return out


class _Fleet(NamedTuple):
    """n machines in service, and what is remembered of them.

    Attributes
    ----------
    p : Params
        When new.
    springs : Springs
    quick : ndarray of bool, shape (n,)
        Which machines lanes can follow.
    shift : ndarray, shape (n,)
        Angle less that of the averaged theory when new [rad]; NaN if it predicts none.
    aperiodic : ndarray of bool, shape (n,)
        Locked without a periodic orbit, as a feed that flies may be: the theory has to do.
    angle, speed : ndarray, shape (n,)
        Of the last orbit, updated in place [rad, rad s-1].
    """

    p: Rows
    springs: Springs
    quick: NDArray[np.bool_]
    shift: Array
    aperiodic: NDArray[np.bool_]
    angle: Array
    speed: Array

    @staticmethod
    def new(
        p: Rows,
        seed: NDArray[np.uint64],
        angle: Array,
        quick: NDArray[np.bool_],
        settings: Settings,
    ) -> "_Fleet":
        """Return machines that have just been put in service; see `lives`."""
        speed = np.maximum(p.synchronous_speed_1, p.synchronous_speed_2)
        aperiodic, slow = np.zeros(len(angle), bool), np.flatnonzero(~quick)
        if len(slow):
            when_new = steady.find(
                rows_of(p, slow), quick[slow], angle[slow], speed[slow], settings
            )
            aperiodic[slow] = np.isnan(when_new.angle)
        springs = spring_breaks(p, seed, settings.springs)
        shift = angle - steady.in_theory(p)[0]
        return _Fleet(p, springs, quick, shift, aperiodic, angle.copy(), speed)

    def tasks(self, settings: Settings) -> list[Task]:
        """Return what is asked of each machine."""
        angle, shift = self.angle.tolist(), np.nan_to_num(self.shift).tolist()
        stopped = stopped_by_friction(self.p).tolist()
        gone = (self.springs.left[:, 1:] <= 0) | (self.springs.right[:, 1:] <= 0)
        fallen = np.where(gone, self.springs.time, np.inf).min(axis=1).tolist()
        tasks = []
        for i, times in enumerate(self.springs.time.tolist()):
            ends = (settings.horizon, LATE), (stopped[i], LOST), (fallen[i], SPRING)
            end, cause = min(ends)
            breaks = tuple(t for t in times if t < end)
            tasks.append(Task(settings.angle_limit, angle[i], 0.0, shift[i], breaks, end, cause))
        return tasks

    def answers(self, wanted: dict[int, Query], settings: Settings) -> list[Answer]:
        """Answer queries of some machines."""
        rows = np.array(list(wanted))
        time = np.array([query.time for query in wanted.values()])
        broken = np.array([query.broken for query in wanted.values()])
        is_exact = np.array([query.is_exact for query in wanted.values()])
        springs = self.springs
        left, right = springs.left[rows, broken], springs.right[rows, broken]
        aged = in_service(rows_of(self.p, rows), time, left, right)
        angle, error = np.full((2, len(rows)), np.nan)
        rough = np.flatnonzero(~is_exact | self.aperiodic[rows])
        if len(rough):
            angle[rough] = steady.in_theory(rows_of(aged, rough))[0]
            off = np.where(is_exact, self.shift[rows], 0.0)[rough]
            angle[rough] += off
            error[rough] = np.abs(off)
        sure = np.flatnonzero(is_exact & ~self.aperiodic[rows])
        if len(sure):
            i = rows[sure]
            last = self.angle[i], self.speed[i]
            running = steady.find(rows_of(aged, sure), self.quick[i], *last, settings)
            angle[sure], error[sure] = running.angle, running.error
            exists = np.isfinite(running.angle)
            self.angle[i[exists]] = running.angle[exists]
            self.speed[i[exists]] = running.speed[exists]
        return [Answer(*each) for each in zip(angle.tolist(), error.tolist(), strict=True)]


def _follow(fleet: _Fleet, settings: Settings) -> list[Life]:
    """Let machines that change look at their angles, all at once."""
    courses = [course(task) for task in fleet.tasks(settings)]
    lives_of: dict[int, Life] = {}
    wanted = {i: next(each) for i, each in enumerate(courses)}
    while wanted:
        for i, answer in zip(list(wanted), fleet.answers(wanted, settings), strict=True):
            try:
                wanted[i] = courses[i].send(answer)
            except StopIteration as ended:
                lives_of[i] = ended.value
                del wanted[i]
    return [lives_of[i] for i in range(len(courses))]
