"""One beam over whole periods of the force, from event to event."""

import math

from models.beam.exact.events import (
    EVALUATIONS_PER_PERIOD,
    NOWHERE,
    next_event,
    scratch,
    site_of,
)
from models.beam.exact.tip_bounds import tip_after
from models.beam.exact.within_phase import join
from models.beam.structure.interpolation import COEFFICIENTS, REACH, set_phasors
from models.beam.structure.modal import Array
from models.numerics.jit import kernel

CLOCK, OWED = -3, -2
"""Columns of a state after z and dz/d(Omega t) of each mode: the clock, and the work of unfinished
contacts at the right and the left site."""


def velocities(state: Array) -> Array:
    """Return dz/d(Omega t) of all modes, a view of n states: velocities per radian of the force."""
    modes = (state.shape[1] + CLOCK) // 2
    return state[:, modes:CLOCK]


@kernel
def _sample(phase, weight, power, theta, until, trace, of_speeds):
    """Set the part of a period's trace after theta, up to `until`."""
    step = 2 * math.pi / len(trace)
    for k in range(len(trace)):
        at = min((k + 1) * step, 2 * math.pi)
        if theta < at <= until:
            tip = tip_after(phase, weight, len(phase.speed), at - theta, power)
            trace[k] = tip.v if of_speeds else tip.x


@kernel
def _tip(phase, y, theta):
    """Return the tip and its velocity from the modes and the random load at force phase theta."""
    m = len(y) // 2
    x, v = y[:m].sum(), y[m:].sum()
    for k in range(phase.phasor.shape[1]):
        angle = theta * phase.speed[2 + k]
        c, e = math.cos(angle), math.sin(angle)
        x += phase.phasor[0, k] * c - phase.phasor[1, k] * e
        v -= phase.speed[2 + k] * (phase.phasor[0, k] * e + phase.phasor[1, k] * c)
    return x, v


@kernel
def advance_beam(free, contact, samples, state, gaps, growth, record, of_speeds):
    """Advance one beam over the periods of its record, whose trace is of the tip or its speed.

    `samples` are those of the response to a random load, as `set_stretches` sets them; empty
    without one.
    """
    work, strobe, peak, trace = record
    y, owed = state[:CLOCK], state[OWED:]
    room = scratch(free, contact)
    steps = len(trace) // len(work)
    intervals = max(1, (len(samples) - REACH + 1) // len(work))
    for period in range(len(work)):
        site = NOWHERE
        evaluations = 0
        for interval in range(intervals):
            theta = interval / intervals * 2 * math.pi
            end = (interval + 1) / intervals * 2 * math.pi
            if len(samples):
                here = samples[period * intervals :]
                set_phasors(here, interval, COEFFICIENTS, free.phasor)
            if interval == 0:
                site = site_of(_tip(free, y, theta)[0], gaps)
            while theta < end:
                to_end = end - theta
                phase = free if site == NOWHERE else contact
                event = next_event(phase, y, gaps, site, theta, to_end, room)
                if site != NOWHERE:
                    work[period, site] += event.work
                    owed[site] += event.work
                    peak[site] = max(peak[site], event.deepest)
                    if event.has_left:
                        gaps[site] += growth[site] * owed[site]
                        owed[site] = 0.0
                evaluations += event.effort
                if evaluations >= EVALUATIONS_PER_PERIOD:
                    state[:] = work[period:] = strobe[period:] = trace[period * steps :] = math.nan
                    return
                until = theta + event.after if event.after < to_end else end
                if steps:
                    part = trace[period * steps :][:steps]
                    _sample(phase, room.weight, room.power, theta, until, part, of_speeds)
                join(phase, room.coefficient, event.after, room.power, y)
                theta, site = until, event.site
        strobe[period] = _tip(free, y, 2 * math.pi)
        state[CLOCK] += 1
