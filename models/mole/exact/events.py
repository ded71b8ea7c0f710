"""From event to event: the loop of the exact propagator, compiled.

Between two events the equations are smooth and integrated by `models.numerics.dop853`. Events: the
bar meets or leaves the stop, a slip ends, an interface no longer sticks, the relay switches.

While the bar slips, v keeps its sign: the extremes of u are at events and at the ends of an
integration.
"""

import math
from typing import NamedTuple

from models.mole.parameters import PHYSICAL
from models.mole.theory import equations
from models.mole.theory.friction import decide
from models.numerics.dop853 import GUARDED, REACHED_END, integrator
from models.numerics.jit import kernel

_CONTACT, _BAR, _MOLE = range(3)  # guards
_LOOKS = 16  # per step: with 8, slips of the mole of half a millisecond go unnoticed


class _Run(NamedTuple):
    status: int
    time: float
    contact: bool
    bar: int
    mole: int
    switched: int
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
def _longest(t, y, mode):
    return equations.coil_step(y[0], y[1], 1 / math.sqrt(2 * mode.q.sharpness))


_integrate = integrator(equations.rates, _guards, 3, _LOOKS, _longest)


@kernel
def _give_way(hold, force):
    """Return the direction in which an interface begins to slip."""
    return 1 if hold.gain * force + hold.offset > 0 else -1


@kernel
def _after(mode, interface, y):
    """Return how bar and mole slip after an event at one interface; zero its velocity."""
    bar, mole = mode.bar, mode.mole
    slips = bar != 0 if interface == _BAR else mole != 0
    if slips:
        y[1 if interface == _BAR else 2] = 0.0
    force = equations.force(mode.q, mode.contact, y[0], y[1], y[3])
    if slips:
        return decide(mode.q, y[1], y[2], force)
    # The force is at its limit: rounding errors would decide again and again whether it sticks.
    if interface == _BAR:
        bar = _give_way(mode.bar_hold, force)
        if mole == 0:
            mole = decide(mode.q, bar, 0.0, force)[1]
    else:
        mole = _give_way(mode.mole_hold, force)
    return bar, mole


@kernel
def run(q, time, y, contact, bar, mole, switched, end, relative, absolute, budget, times, samples):
    """Advance y in place; see `State` and `models.numerics.dop853` for the arguments."""
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
        mode = equations.mode(q, contact, switched % 2 == 1, bar, mole)
        ended = _integrate(
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
                bar, mole = _after(mode, ended.guard, y)
        elif ended.status != REACHED_END:
            status = ended.status
            break
    return _Run(
        status, time, contact, bar, mole, switched, contacts, events, lowest, highest, steps
    )
