"""From event to event: the loop of the exact propagator, compiled.

Between two events the equations are smooth and integrated by `models.numerics.dop853`. Events: the
bar meets or leaves the stop, a slip ends, an interface no longer sticks, the relay switches; the
mole meets or leaves the soil, whose base begins or ceases to slide.

While the bar slips, v keeps its sign: the extremes of u are at events and at the ends of an
integration.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from models.mole.parameters import PHYSICAL
from models.mole.theory import equations
from models.mole.theory.friction import decide
from models.mole.theory.soil import (
    APART,
    ELASTIC,
    SLIDING,
    bar_hold_in_soil,
    decide_in_soil,
    mole_hold_in_soil,
    started,
    touched,
)
from models.numerics.dop853 import GUARDED, REACHED_END, integrator
from models.numerics.jit import kernel

_CONTACT, _BAR, _MOLE, _SOIL, _SOIL_LIMIT = range(5)  # guards; the last two only with soil ahead
_LOOKS = 16  # per step: with 8, slips of the mole of half a millisecond go unnoticed


class _Run(NamedTuple):
    status: int
    time: float
    contact: bool
    bar: int
    mole: int
    switched: int
    soil: int
    contacts: int
    events: int
    lowest: float
    highest: float
    steps: int


@kernel
def _margin(hold, force):
    return hold.limit - abs(hold.gain * force + hold.offset)


@kernel
def _guards(t, y, mode, guard):
    u, v, x, i = y[0], y[1], y[2], y[3]
    gap = mode.q.stop_gap - u
    guard[_CONTACT] = -gap if mode.contact else gap
    guard[_BAR] = mode.bar * v
    guard[_MOLE] = mode.mole * x
    if mode.bar == 0:
        guard[_BAR] = _margin(mode.bar_hold, equations.force(mode.q, mode.contact, u, v, i))
    if mode.mole == 0 and mode.bar == 0:
        guard[_MOLE] = 1.0
    elif mode.mole == 0:
        guard[_MOLE] = _margin(mode.mole_hold, equations.force(mode.q, mode.contact, u, v, i))


@kernel
def _guards_in_soil(t, y, mode, guard):
    _guards(t, y, mode, guard)
    q = mode.q
    pushed = equations.pushed(y, mode)
    if mode.bar == 0:
        hold = bar_hold_in_soil(q, mode.mole, pushed)
        guard[_BAR] = _margin(hold, equations.force(q, mode.contact, y[0], y[1], y[3]))
    elif mode.mole == 0:
        hold = mole_hold_in_soil(q, mode.bar, pushed)
        guard[_MOLE] = _margin(hold, equations.force(q, mode.contact, y[0], y[1], y[3]))
    base = y[equations.SOIL_BASE]
    dent, limit = y[equations.SOIL_FRONT] - base, equations.limit_of_soil(q, base)
    trial = q.soil_stiffness * dent + q.soil_damping * y[equations.MOLE_VELOCITY]
    guard[_SOIL] = guard[_SOIL_LIMIT] = 1.0
    if mode.soil == APART:
        guard[_SOIL] = y[equations.SOIL_FRONT] - y[equations.MOLE_DISPLACEMENT]
    elif mode.soil == ELASTIC and mode.mole != 0:
        # The force on a mole that sticks is constant.
        guard[_SOIL], guard[_SOIL_LIMIT] = trial, limit - trial
    elif mode.soil == SLIDING and q.soil_damping > 0:
        guard[_SOIL_LIMIT] = trial - limit


@kernel
def _longest(t, y, mode):
    return equations.coil_step(y[0], y[1], 1 / math.sqrt(2 * mode.q.sharpness))


@kernel
def _longest_in_soil(t, y, mode):
    """Return the longest step in which dense output follows soil that relaxes."""
    return min(_longest(t, y, mode), equations.relaxation_step(y, mode))


@kernel
def _give_way(hold, force):
    """Return the direction in which an interface begins to slip."""
    return 1 if hold.gain * force + hold.offset > 0 else -1


@kernel
def _after(mode, interface, y):
    """Return how bar and mole slip after an event at one interface, without soil ahead.

    The velocity of an interface that ceases to slip is set to zero.
    """
    bar, mole = mode.bar, mode.mole
    slips = bar != 0 if interface == _BAR else mole != 0
    if slips:
        y[1 if interface == _BAR else 2] = 0.0
    force = equations.force(mode.q, mode.contact, y[0], y[1], y[3])
    if slips:
        bar, mole = decide(mode.q, y[1], y[2], force)
        return bar, mole, APART
    # The force is at its limit: rounding errors would decide again and again whether it sticks.
    if interface == _BAR:
        bar = _give_way(mode.bar_hold, force)
        if mole == 0:
            mole = decide(mode.q, bar, 0.0, force)[1]
    else:
        mole = _give_way(mode.mole_hold, force)
    return bar, mole, APART


@kernel
def _after_in_soil(mode, interface, y):
    """Return how bar, mole and soil go on after an event at bar, mole or soil; y is adjusted."""
    q, bar, mole, soil = mode.q, mode.bar, mode.mole, mode.soil
    w, front, base = equations.MOLE_DISPLACEMENT, equations.SOIL_FRONT, equations.SOIL_BASE
    limit = equations.limit_of_soil(q, y[base])
    stuck = mole == 0
    if interface == _SOIL and soil == APART:
        y[front] = y[w]
        soil = touched(q, y[w] - y[base], limit, y[2])
        if soil != APART and q.soil_damping > 0:
            # The dashpot pushes at once: each interface is judged again.
            force = equations.force(q, mode.contact, y[0], y[1], y[3])
            touching = equations.mode(q, mode.contact, mode.relay, bar, mole, soil)
            bar, mole = decide_in_soil(q, y[1], y[2], force, equations.pushed(y, touching))
    elif interface == _SOIL:
        soil = APART
        y[front] = y[w]
        if q.soil_damping == 0:
            y[front] = y[base]
    elif interface == _SOIL_LIMIT:
        soil = SLIDING if soil == ELASTIC else ELASTIC
    else:
        slips = bar != 0 if interface == _BAR else mole != 0
        if slips:
            y[1 if interface == _BAR else 2] = 0.0
        if interface == _MOLE and slips and soil == SLIDING:
            soil = ELASTIC
        now = equations.mode(q, mode.contact, mode.relay, bar, mole, soil)
        pushed = equations.pushed(y, now)
        force = equations.force(q, mode.contact, y[0], y[1], y[3])
        if slips:
            bar, mole = decide_in_soil(q, y[1], y[2], force, pushed)
            stuck = interface == _MOLE
        elif interface == _BAR:
            bar = _give_way(bar_hold_in_soil(q, mole, pushed), force)
            if mole == 0:
                mole = decide_in_soil(q, bar, 0.0, force, pushed)[1]
        else:
            mole = _give_way(mole_hold_in_soil(q, bar, pushed), force)
    if stuck and interface != _SOIL_LIMIT and y[2] == 0:
        soil = started(q, soil, y[front] - y[base], y[w] - y[base], limit, mole)
    return bar, mole, soil


def _runner(has_soil: bool) -> Callable[..., Any]:
    """Return the loop over events of a mole with or without soil ahead."""
    rates = equations.rates_in_soil if has_soil else equations.rates
    guards, count = (_guards_in_soil, 5) if has_soil else (_guards, 3)
    after = _after_in_soil if has_soil else _after
    longest = _longest_in_soil if has_soil else _longest
    integrate = integrator(rates, guards, count, _LOOKS, longest)

    @kernel
    def run(
        q,
        time,
        y,
        contact,
        bar,
        mole,
        switched,
        soil,
        end,
        relative,
        absolute,
        budget,
        times,
        samples,
    ):
        status = REACHED_END
        contacts = events = steps = sampled = 0
        lowest = highest = y[0]
        step = 0.0
        while sampled < len(times) and times[sampled] <= time:
            samples[sampled] = y
            sampled += 1
        while time < end:
            due = 0.5 * q.control_period * switched
            if due <= time:
                if q.formulation == PHYSICAL:
                    source = q.voltage * math.sin(q.supply_speed * due + q.supply_phase)
                    y[4] += source if switched % 2 == 0 else -source
                switched += 1
                events += 1
                continue
            mode = equations.mode(q, contact, switched % 2 == 1, bar, mole, soil)
            ended = integrate(
                time,
                min(due, end),
                y,
                step,
                mode,
                relative,
                absolute,
                budget - steps,
                times[sampled:],
                samples[sampled:],
            )
            time, step = ended.time, ended.step
            steps += ended.steps
            sampled += ended.sampled
            lowest, highest = min(lowest, y[0]), max(highest, y[0])
            if ended.status == GUARDED:
                events += 1
                if ended.guard == _CONTACT:
                    contact = not contact
                    contacts += 1 if contact else 0
                else:
                    bar, mole, soil = after(mode, ended.guard, y)
            elif ended.status != REACHED_END:
                status = ended.status
                break
        return _Run(
            status,
            time,
            contact,
            bar,
            mole,
            switched,
            soil,
            contacts,
            events,
            lowest,
            highest,
            steps,
        )

    return run


_run, _run_in_soil = _runner(False), _runner(True)


@kernel
def run(
    q, time, y, contact, bar, mole, switched, soil, end, relative, absolute, budget, times, samples
):
    """Advance y in place; see `State` and `models.numerics.dop853` for the arguments."""
    return _run(
        q,
        time,
        y,
        contact,
        bar,
        mole,
        switched,
        soil,
        end,
        relative,
        absolute,
        budget,
        times,
        samples,
    )


@kernel
def run_in_soil(
    q, time, y, contact, bar, mole, switched, soil, end, relative, absolute, budget, times, samples
):
    """Advance y, of size 15, in place, as `run`."""
    return _run_in_soil(
        q,
        time,
        y,
        contact,
        bar,
        mole,
        switched,
        soil,
        end,
        relative,
        absolute,
        budget,
        times,
        samples,
    )
