"""Dormand and Prince's method of order 8(5,3), with dense output and guarded modes.

`integrator` compiles the method for one system. Between mode changes a system obeys smooth
equations; its guards are functions of the state that are positive while the mode lasts. The
integrator stops where the first of them becomes negative, an event located on the dense output, and
returns to the machine, which changes the mode and continues.

The kernels compiled here are cached on disk only as part of a module-level kernel that calls them:
call them from such a kernel, never from Python.

The step control is that of E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential
Equations I", Sec. II.4, as in scipy's ``DOP853``; see `models.numerics.dop853_step`.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from models.numerics.blocks import copy
from models.numerics.dop853_step import ALL_STAGES, POWER, STAGES, interpolate, stepper
from models.numerics.jit import kernel

REACHED_END, GUARDED, OUT_OF_BUDGET, STUCK = 0, 1, 2, 3
"""Why an integration stopped. Stuck: the error control requires steps below the resolution of
time."""

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 10.0
_RESOLUTION = 4e-16  # of an event, relative to the time since the step began
_HALVINGS = 60


class Outcome(NamedTuple):
    """How an integration ended.

    Attributes
    ----------
    status : int
        `REACHED_END`, `GUARDED`, `OUT_OF_BUDGET` or `STUCK`.
    time : float
        Time reached.
    guard : int
        The guard that became negative, -1 if none.
    step : float
        To try next.
    steps : int
        Steps tried, including rejected ones.
    sampled : int
        Number of samples taken.
    """

    status: int
    time: float
    guard: int
    step: float
    steps: int
    sampled: int


@kernel
def _no_guards(t, y, p, guard):
    pass


@kernel
def _of_any_length(t, y, p):
    return np.inf


def integrator(
    rhs: Callable[..., None],
    guards: Callable[..., None] = _no_guards,
    guard_count: int = 0,
    looks: int = 4,
    longest: Callable[..., float] = _of_any_length,
) -> Callable[..., Outcome]:
    """Compile the method for one system.

    Parameters
    ----------
    rhs : kernel
        ``rhs(t, y, p, dy)`` sets dy to the time derivative of y.
    guards : kernel
        ``guards(t, y, p, guard)`` sets guard[i], i < guard_count, positive while the mode lasts. A
        guard may start at zero if it then becomes positive.
    guard_count : int
    looks : int
        Instants in each step at which the guards are evaluated. A guard that is negative only
        between two of them goes unnoticed.
    longest : kernel
        ``longest(t, y, p)`` returns the longest step to try from there.

    Returns
    -------
    kernel
        ``integrate(t, end, y, step, p, relative, absolute, budget, times, samples)`` advances y in
        place from t to end > t or to where a guard becomes negative, and returns an `Outcome`.
        `step` is tried first, 0 for a guess; p is passed to `rhs` and `guards` as it is. The error
        of a step in y[i], relative to absolute[i] + relative |y[i]|, is kept below 1 in root mean
        square over i. At most `budget` steps are tried. samples[j] is set to the state at times[j],
        ascending and not before t, as far as the integration gets; a sample at the end of a mode is
        the state before the change.
    """
    guess, attempt, densify = stepper(rhs)

    @kernel
    def leaving(which, low, high, f_low, f_high, t, h, y, p, dense, trial, guard):
        """Return where in (low, high] a guard that is negative at high becomes negative.

        The bracket is narrowed by the ITP method of I. F. D. Oliveira and R. H. C. Takahashi, ACM
        Trans. Math. Softw. 47 (2020) 5, which needs at most one evaluation more than bisection.
        """
        start = low
        for _ in range(_HALVINGS):
            if f_low > 0:
                break
            middle = start + 0.5 * (high - start)
            interpolate(middle, y, dense, trial)
            guards(t + middle * h, trial, p, guard)
            if guard[which] > 0:
                low, f_low = middle, guard[which]
            else:
                high, f_high = middle, guard[which]
        if not f_low > 0:
            return start
        width = high - low
        resolution = _RESOLUTION * high
        slack = resolution * 2.0 ** math.ceil(math.log2(width / resolution))
        strength = 0.2 / width
        while high - low > 2 * resolution:
            middle = 0.5 * (low + high)
            secant = (f_low * high - f_high * low) / (f_low - f_high)
            inward = math.copysign(1.0, middle - secant)
            push = min(strength * (high - low) ** 2, abs(middle - secant))
            radius = max(slack - 0.5 * (high - low), 0.0)
            at = secant + inward * push
            if abs(at - middle) > radius:
                at = middle - inward * radius
            interpolate(at, y, dense, trial)
            guards(t + at * h, trial, p, guard)
            if guard[which] > 0:
                low, f_low = at, guard[which]
            else:
                high, f_high = at, guard[which]
            slack *= 0.5
        return high

    @kernel
    def integrate(t, end, y, step, p, relative, absolute, budget, times, samples):
        k = np.empty((ALL_STAGES, len(y)))
        dense = np.empty((POWER, len(y)))
        new, trial = np.empty((2, len(y)))
        before, after, guard = np.empty((3, max(guard_count, 1)))
        sampled = steps = 0
        status, which = OUT_OF_BUDGET, -1
        while sampled < len(times) and times[sampled] <= t:
            copy(y, samples[sampled])
            sampled += 1
        rhs(t, y, p, k[0])
        guards(t, y, p, before)
        if step <= 0:
            step = guess(t, end, y, p, relative, absolute, k, trial)
        held = False  # after a rejection the next step may not grow
        while steps < budget:
            if t >= end:
                status = REACHED_END
                break
            step = min(step, longest(t, y, p))
            shortest = 10 * np.spacing(abs(t))
            if not step > shortest:
                status = STUCK
                break
            last = end - t <= step * (1 + 1e-12)
            h = end - t if last else step
            reached = end if last else t + h
            steps += 1
            error = attempt(t, h, y, p, relative, absolute, k, new)
            if not error < 1:
                factor = _SAFETY * error**-0.125
                step = h * (factor if factor > _SHRINK else _SHRINK)
                held = True
                continue
            factor = _GROW if error == 0 else min(_GROW, _SAFETY * error**-0.125)
            factor = min(factor, 1.0) if held else factor
            held = False
            # A step cut short by the end is no guide to the next one.
            step = max(step, h * factor) if last else h * factor
            rhs(t + h, new, p, k[STAGES])

            dense_wanted = guard_count > 0 and looks > 1
            if not dense_wanted:
                guards(t + h, new, p, after)
                for i in range(guard_count):
                    dense_wanted |= after[i] < 0
            dense_wanted |= sampled < len(times) and times[sampled] <= reached
            if dense_wanted:
                densify(t, h, y, p, k, new, dense, trial)

            leave = left = 0.0
            for look in range(looks if dense_wanted and guard_count > 0 else 0):
                right = (look + 1) / looks
                interpolate(right, y, dense, trial)
                guards(t + right * h, trial, p, after)
                for i in range(guard_count):
                    if after[i] < 0:
                        at = leaving(
                            i, left, right, before[i], after[i], t, h, y, p, dense, trial, guard
                        )
                        if which < 0 or at < leave:
                            which, leave = i, at
                if which >= 0:
                    break
                left = right
                copy(after, before)
            copy(after, before)

            if which >= 0:
                reached = t + leave * h
            while sampled < len(times) and times[sampled] <= reached:
                interpolate((times[sampled] - t) / h, y, dense, samples[sampled])
                sampled += 1
            if which >= 0:
                interpolate(leave, y, dense, trial)
                t = reached
                copy(trial, y)
                status = GUARDED
                break
            t = reached
            copy(new, y)
            copy(k[STAGES], k[0])
        if status == OUT_OF_BUDGET and t >= end:
            status = REACHED_END
        return Outcome(status, t, which, step, steps, sampled)

    return integrate
