"""One machine in service: when its disphasing angle passes a limit, or its motors lose each other.

The averaged theory, less its error when new, looks about twenty times; where it finds the limit
passed, or no stable running, exact orbits decide, and locate the time. The machine is a coroutine
that asks for angles, so that many machines look at once.
"""

import math
from collections.abc import Generator
from typing import NamedTuple

from models.vibrator.parameters import CAUSES

ANGLE, LOST, SPRING = range(len(CAUSES))
NOT_ENDED, LATE = -1, -2  # never, and not until the horizon

LOOKS = 20
_POWER = 4  # of the looks' numbers, with which their times grow
_CLOSE = 1e-9  # to the limit, when the time is located [rad]
_NARROW, _SUDDEN = 1e-12, 1e-6  # brackets of a time over it: of an angle, and of a lost orbit
_MOST = 100  # angles to locate a time


class Task(NamedTuple):
    """What is asked of one machine.

    Attributes
    ----------
    limit : float
        Of the angle's magnitude [rad].
    new, error : float
        Angle when new and its numerical error [rad].
    shift : float
        Angle less that of the averaged theory when new [rad].
    breaks : tuple of float
        Times at which springs break and leave some at each side, ascending [s].
    end : float
        Last time that matters [s].
    cause : int
        Cause of the end of a life then: an index into `CAUSES`, or `LATE`.
    """

    limit: float
    new: float
    error: float
    shift: float
    breaks: tuple[float, ...]
    end: float
    cause: int


class Query(NamedTuple):
    """An angle wanted: of the averaged theory or of an orbit, at a time [s] after some breaks."""

    is_exact: bool
    time: float
    broken: int


class Answer(NamedTuple):
    """An angle and its error [rad]; NaN where there is no stable running."""

    angle: float
    error: float


class Life(NamedTuple):
    """When a life ends [s], its numerical error [s], and its cause: of `CAUSES`, or `LATE`."""

    time: float
    error: float
    cause: int


Course = Generator[Query, Answer, Life]


class _Stretch(NamedTuple):
    """A time during which no spring breaks, between two looks."""

    begin: float
    end: float
    broken: int


def course(task: Task) -> Course:
    """Follow one machine that is synchronous, within the limit, when new."""
    stretches = _stretches(task)
    for i, stretch in enumerate(stretches):
        if i and stretch.broken > stretches[i - 1].broken:
            # A spring has just broken.
            guess = yield Query(False, stretch.begin, stretch.broken)
            if not _within(task, guess.angle + task.shift):
                sure = yield Query(True, stretch.begin, stretch.broken)
                if not _within(task, sure.angle):
                    return (yield from _go_back(task, stretches, i, sure))
        guess = yield Query(False, stretch.end, stretch.broken)
        if not _within(task, guess.angle + task.shift):
            sure = yield Query(True, stretch.end, stretch.broken)
            if not _within(task, sure.angle):
                return (yield from _go_back(task, stretches, i + 1, sure))
    return Life(task.end, math.nan if task.cause == LATE else 0.0, task.cause)


def _stretches(task: Task) -> list[_Stretch]:
    looks = [task.end * (k / LOOKS) ** _POWER for k in range(LOOKS + 1)]
    times = sorted({*looks, *task.breaks})
    return [
        _Stretch(begin, end, sum(t <= begin for t in task.breaks))
        for begin, end in zip(times, times[1:], strict=False)
    ]


def _within(task: Task, angle: float) -> bool:
    return abs(angle) <= task.limit  # not if it is NaN


def _go_back(task: Task, stretches: list[_Stretch], i: int, after: Answer) -> Course:
    """Find when the limit was passed, given the answer at the beginning of stretch i or after it.

    From stretch to stretch backwards, to one that begins within the limit.
    """
    broken = stretches[i].broken if i < len(stretches) else stretches[-1].broken
    while True:
        i -= 1
        stretch = stretches[i]
        if stretch.broken < broken:
            before = yield Query(True, stretch.end, stretch.broken)
            if _within(task, before.angle):
                return Life(stretch.end, 0.0, SPRING)
            after, broken = before, stretch.broken
        if i == 0:
            first = Answer(task.new, task.error)
        else:
            first = yield Query(True, stretch.begin, stretch.broken)
        if i == 0 or _within(task, first.angle):
            return (yield from _locate(task, stretch, first, after))
        after = first


def _locate(task: Task, stretch: _Stretch, first: Answer, last: Answer) -> Course:
    """Locate the time at which the limit is passed, by the Illinois method; see `_go_back`.

    While there is no orbit at the upper end, the bracket is halved.
    """
    low, high = stretch.begin, stretch.end
    below, above = abs(first.angle) - task.limit, abs(last.angle) - task.limit
    weight_low = weight_high = 1.0
    places = [(low, below)] + [(high, above)] * math.isfinite(above)
    error, at, off = max(first.error, 0.0), low, below
    for _ in range(_MOST):
        is_sudden = not math.isfinite(above)
        if high - low <= (_SUDDEN if is_sudden else _NARROW) * high:
            break
        at = 0.5 * (low + high)
        if not is_sudden:
            down, up = weight_low * below, weight_high * above
            secant = (low * up - high * down) / (up - down)
            at = secant if low < secant < high else at
        answer = yield Query(True, at, stretch.broken)
        off = abs(answer.angle) - task.limit
        if math.isfinite(off):
            places.append((at, off))
            error = answer.error
        if off <= 0:
            low, below = at, off
            weight_low, weight_high = 1.0, 0.5 * weight_high if weight_low == 1.0 else 1.0
        else:
            high, above = at, off
            weight_high, weight_low = 1.0, 0.5 * weight_low if weight_high == 1.0 else 1.0
        if abs(off) <= _CLOSE:
            break
    if not math.isfinite(above):
        return Life(0.5 * (low + high), 0.5 * (high - low), LOST)
    (t_1, off_1), (t_2, off_2) = sorted(places, key=lambda place: abs(place[1]))[:2]
    slope = abs((off_2 - off_1) / (t_2 - t_1)) if off_2 != off_1 else 0.0
    spread = (error + abs(off_1)) / slope if slope > 0 else high - low
    return Life(t_1, spread, ANGLE)
