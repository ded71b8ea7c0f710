"""Slow time: quantities that grow at rates which depend on gaps, and the times of events.

`integrator` compiles the method of `models.numerics.slow_step` for one machine. Time is the
independent variable; a step is the shortest of

    h = accuracy scale/|dX/dt|,    h = accuracy tau,    h = end of the duty state - t,

and is taken back and halved where its error is too large. A quantity does not grow while its gap is
closed, X <= 0; a step ends where a gap opens or closes, where a quantity reaches a value at which
its rate jumps, and at kinks of its growth. In silence, when no rate is positive, the clock jumps to
the earliest time at which one can be, and events that can no longer occur are marked as such.

The error of the times is of second order in the accuracy.

The kernels compiled here are cached on disk only as part of a module-level kernel that calls them:
call them from such a kernel, never from Python.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from models.numerics.blocks import copy
from models.numerics.jit import kernel
from models.numerics.slow_step import (
    BEFORE,
    ERROR,
    FIRST,
    NOISE,
    RATE,
    RATE_END,
    RATE_STAR,
    V_END,
    V_STAR,
    VARIANCE,
    X_END,
    X_STAR,
    V,
    X,
    accumulate,
    extrapolate,
    stepper,
)

ENDED, OUT_OF_BUDGET = 0, 1
"""Whether all events were decided or the end was reached, or the steps ran out before."""

PENDING, REACHED, NEVER = 0, 1, 2
"""What is known of an event: not before the end, at a time, or that it cannot occur."""

_GENEROUS = 0.125  # of the error allowed, below which the next step is twice as long
_BISECTIONS = 120
_BELOW = 1 - 1e-15  # of a value at which a rate jumps
_NEAR = 1e-3  # part of a step over which the slope of a mark is measured
_CONFIDENT = 1.6449  # half-width of a 90 % interval over the standard error


class Outcome(NamedTuple):
    """How an integration ended.

    Attributes
    ----------
    status : int
        `ENDED` or `OUT_OF_BUDGET`.
    time : float
        Time reached.
    steps : int
        Steps tried, including those taken back.
    """

    status: int
    time: float
    steps: int


@kernel
def _one_state(state, p):
    return np.inf


@kernel
def _no_clock(t, p):
    return np.inf


@kernel
def _at_once(v, t, p):
    return t


@kernel
def _smooth(t, p):
    return np.inf


@kernel
def _no_jumps(v, p, level):
    level[:] = np.inf


def integrator(
    coordinates: Callable[..., None],
    rates: Callable[..., None],
    marks: Callable[..., None],
    ends: Callable[..., float] = _one_state,
    clock: Callable[..., float] = _no_clock,
    awakes: Callable[..., float] = _at_once,
    kinks: Callable[..., float] = _smooth,
    jumps: Callable[..., None] = _no_jumps,
) -> Callable[..., Outcome]:
    """Compile the method for one machine.

    Parameters
    ----------
    coordinates : kernel
        ``coordinates(v, t, state, p, x)`` sets the coordinate x[i] of each quantity v[i]; at
        t = inf to its limit.
    rates : kernel
        ``rates(v, x, t, state, p, rate, noise)`` sets the rate of each quantity; where it is a mean
        over a time, also the standard error `noise`, which is 0 beforehand. A rate is not used
        where its gap is closed.
    marks : kernel
        ``marks(v, x, t, p, mark)`` sets mark[j], which becomes positive where event j occurs. One
        that is positive only within a step goes unnoticed.
    ends : kernel
        ``ends(state, p)`` returns the end of duty state number 0, 1, 2, ...: ascending times, inf
        for the last. By default there is one state.
    clock : kernel
        ``clock(t, p)`` returns the time tau in which the machine changes by itself, inf if it does
        not.
    awakes : kernel
        ``awakes(v, t, p)``, called in silence, returns the earliest time at which a rate may become
        positive, in any duty state, or at which a mark becomes positive; inf for never. By default
        there are no jumps.
    kinks : kernel
        ``kinks(t, p)`` returns the next time at which a coordinate or a rate, as functions of time,
        have a kink or a jump; inf by default.
    jumps : kernel
        ``jumps(v, p, level)`` sets level[i] > 0 to the next value above v[i] at which rate i jumps;
        inf by default. Up to there the rate is asked for quantities below it.

    Returns
    -------
    kernel
        ``integrate(t, end, v, p, accuracy, floor, budget, fate, times, errors, instants, seen)``
        advances v (k,) in place from t to a finite end, or until all events are decided and all
        instants passed, and returns an `Outcome`. p is passed on as it is. A coordinate moves in a
        step by at most the accuracy times its scale: the smaller of itself and its growth so far,
        but no less than floor[i] > 0. At most `budget` steps are tried. For each event, fate (q,)
        of int8 becomes `PENDING`, `REACHED` or `NEVER`, times (q,) its time, where it is reached,
        and errors (q,) a bound of the error of this time, which nine in ten errors do not exceed.
        seen (n, k) becomes v at the n ascending instants, NaN at those not reached.
    """
    step_of = stepper(coordinates)
    propose, correct, judge = step_of.propose, step_of.correct, step_of.judge

    @kernel
    def fill_rates(v, x, t, state, p, is_open, level, held, rate, noise):
        """Set the rates, which are 0 where a gap is closed, on this side of their jumps."""
        for i in range(len(x)):
            noise[i] = 0.0
            held[i] = min(v[i], _BELOW * level[i])
        rates(held, x, t, state, p, rate, noise)
        for i in range(len(x)):
            if not is_open[i]:
                rate[i] = noise[i] = 0.0

    @kernel
    def look(step, part, t, span, state, p, v, x, mark):
        """Set quantities, coordinates and marks at a part of a step, on the cubic through it."""
        rest = 1 - part
        for i in range(len(v)):
            bend = rest * step[RATE, i] - part * step[RATE_END, i]
            v[i] = step[V, i] * rest * rest * (1 + 2 * part)
            v[i] += step[V_END, i] * part * part * (1 + 2 * rest) + span * part * rest * bend
        coordinates(v, t + part * span, state, p, x)
        marks(v, x, t + part * span, p, mark)

    @kernel
    def crossing(step, high, t, span, state, p, gap, begins_open, level, event, v, x, mark):
        """Return the first part of a step at which a gap has changed or an event occurred.

        A gap also changes where its quantity reaches the level. `gap` or `event` is its number, the
        other -1; it has happened at the part `high`.
        """
        low = 0.0
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
            look(step, middle, t, span, state, p, v, x, mark)
            if gap >= 0:
                has_changed = (x[gap] > 0) != begins_open or v[gap] >= level
            else:
                has_changed = mark[event] > 0
            if has_changed:
                high = middle
            else:
                low = middle
        return high

    @kernel
    def time_error(step, part, t, span, state, p, event, v, x, mark):
        """Return the error of the time at which an event occurs, from that of the quantities."""
        if span <= 0:
            return 0.0
        low, high = max(0.0, part - _NEAR), min(1.0, part + _NEAR)
        look(step, low, t, span, state, p, v, x, mark)
        below = mark[event]
        look(step, high, t, span, state, p, v, x, mark)
        slope = abs(mark[event] - below) / ((high - low) * span)
        look(step, part, t, span, state, p, v, x, mark)
        here = mark[event]
        for i in range(len(v)):
            v[i] += step[ERROR, i] + _CONFIDENT * math.sqrt(step[VARIANCE, i])
        coordinates(v, t + part * span, state, p, x)
        marks(v, x, t + part * span, p, mark)
        shift = abs(mark[event] - here)
        error = 0.0
        if shift > 0:
            error = shift / slope if slope > 0 else np.inf
        return error

    @kernel
    def note(step, upto, t, span, state, p, fate, times, errors, v, x, mark):
        """Record the events up to a part of a step; return how many."""
        count = 0
        for event in range(len(fate)):
            if fate[event] != PENDING:
                continue
            look(step, upto, t, span, state, p, v, x, mark)
            if mark[event] > 0:
                at = crossing(step, upto, t, span, state, p, -1, False, 0.0, event, v, x, mark)
                fate[event] = REACHED
                times[event] = t + at * span
                errors[event] = time_error(step, at, t, span, state, p, event, v, x, mark)
                count += 1
        return count

    @kernel
    def watch(step, upto, t, span, state, p, instants, seen, passed, v, x, mark):
        """Record the quantities at the instants up to a part of a step; return how many passed."""
        while passed < len(instants) and instants[passed] <= t + upto * span:
            part = (instants[passed] - t) / span if span > 0 else 0.0
            look(step, max(0.0, min(upto, part)), t, span, state, p, v, x, mark)
            copy(v, seen[passed])
            passed += 1
        return passed

    @kernel
    def hold(step):
        """Make the present step one in which nothing grows."""
        for i in range(step.shape[1]):
            step[V_END, i] = step[V, i]
            step[RATE_END, i] = step[RATE, i]

    @kernel
    def integrate(t, end, v, p, accuracy, floor, budget, fate, times, errors, instants, seen):
        k, q = len(v), len(fate)
        step = np.zeros((VARIANCE + 1, k))
        v_at, x_at, held, level = np.empty(k), np.empty(k), np.empty(k), np.empty(k)
        mark = np.empty(q)
        is_open = np.zeros(k, np.bool_)
        copy(v, step[V])
        jumps(v, p, level)
        fate[:] = PENDING
        times[:] = np.inf
        errors[:] = 0.0
        seen[:] = np.nan
        state, steps, pending, passed = 0, 0, q, 0
        span_before, span_next = 0.0, end - t
        entered, jumped = True, False
        status = OUT_OF_BUDGET
        while True:
            if entered:  # a duty state begins here, and gaps may have changed
                while ends(state, p) <= t:
                    state += 1
                coordinates(step[V], t, state, p, step[X])
                if steps == 0:
                    copy(step[X], step[FIRST])
                for i in range(k):
                    is_open[i] = step[X, i] > 0
                hold(step)
                pending -= note(step, 0.0, t, 0.0, state, p, fate, times, errors, v_at, x_at, mark)
                passed = watch(
                    step, 0.0, t, 0.0, state, p, instants, seen, passed, v_at, x_at, mark
                )
                fill_rates(
                    step[V], step[X], t, state, p, is_open, level, held, step[RATE], step[NOISE]
                )
                span_before, entered = 0.0, False
            if (pending == 0 and passed == len(instants)) or t >= end:
                status = ENDED
                break
            if steps >= budget:
                break
            steps += 1
            part_end = min(ends(state, p), kinks(t, p), end)

            is_silent = not jumped
            for i in range(k):
                is_silent &= step[RATE, i] == 0
            wake = awakes(step[V], t, p) if is_silent else t
            if wake > t:
                hold(step)
                if wake == np.inf:
                    coordinates(step[V], wake, state, p, x_at)
                    marks(step[V], x_at, wake, p, mark)
                    for event in range(q):
                        if fate[event] == PENDING and not mark[event] > 0:
                            fate[event] = NEVER
                            pending -= 1
                    wake = end
                reached = min(wake, part_end)
                span = reached - t
                pending -= note(step, 1.0, t, span, state, p, fate, times, errors, v_at, x_at, mark)
                passed = watch(
                    step, 1.0, t, span, state, p, instants, seen, passed, v_at, x_at, mark
                )
                t, jumped = reached, wake <= part_end
                entered = t == part_end and t < end
                coordinates(step[V], t, state, p, step[X])
                fill_rates(
                    step[V], step[X], t, state, p, is_open, level, held, step[RATE], step[NOISE]
                )
                span_before, span_next = 0.0, end - t
                continue

            longest = min(span_next, accuracy * clock(t, p), part_end - t)
            span = propose(step, t, longest, state, p, accuracy, floor)
            fill_rates(
                step[V_STAR],
                step[X_STAR],
                t + span,
                state,
                p,
                is_open,
                level,
                held,
                step[RATE_STAR],
                step[NOISE],
            )
            correct(step, t, span, state, p)
            if not extrapolate(step):
                fill_rates(
                    step[V_END],
                    step[X_END],
                    t + span,
                    state,
                    p,
                    is_open,
                    level,
                    held,
                    step[RATE_END],
                    step[NOISE],
                )
            worst = judge(step, t, span, span_before, state, p, accuracy, floor)
            if not worst <= 1:
                if not (math.isfinite(worst) and span > 0):
                    break  # no rate
                span_next = 0.5 * span
                continue
            accumulate(step, span)
            cut, changes = 1.0, -1
            for i in range(k):
                if (step[X_END, i] > 0) != is_open[i] or step[V_END, i] >= level[i]:
                    opened, last = is_open[i], level[i]
                    at = crossing(
                        step, cut, t, span, state, p, i, opened, last, -1, v_at, x_at, mark
                    )
                    look(step, at, t, span, state, p, v_at, x_at, mark)
                    # Not after an earlier change of another.
                    if (x_at[i] > 0) != opened or v_at[i] >= last:
                        cut, changes = at, i
            pending -= note(step, cut, t, span, state, p, fate, times, errors, v_at, x_at, mark)
            passed = watch(step, cut, t, span, state, p, instants, seen, passed, v_at, x_at, mark)
            jumped = False
            if span == span_next and worst < _GENEROUS:
                span_next = 2 * span
            if changes >= 0:
                look(step, cut, t, span, state, p, v_at, x_at, mark)
                t += cut * span
                copy(v_at, step[V])
                copy(x_at, step[X])
                is_open[changes] = x_at[changes] > 0
                jumps(v_at, p, level)
                fill_rates(
                    step[V], step[X], t, state, p, is_open, level, held, step[RATE], step[NOISE]
                )
                span_before = 0.0
                continue
            copy(step[RATE], step[BEFORE])
            copy(step[V_END], step[V])
            copy(step[X_END], step[X])
            copy(step[RATE_END], step[RATE])
            span_before = span
            entered = span == part_end - t and part_end < end
            t = part_end if span == part_end - t else t + span
        while passed < len(instants) and instants[passed] <= t:
            copy(step[V], seen[passed])
            passed += 1
        copy(step[V], v)
        return Outcome(status, t, steps)

    return integrate
