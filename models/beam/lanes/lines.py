"""The random load of the fast propagator: the contribution of its lines to the tip at each step.

A line of amplitude a, of phase theta at the start of a period and turning by delta per step, is
summed by a recurrence that is accurate for arbitrarily small delta,

    u <- u + e,    e <- e - 4 sin^2(delta/2) u,    u = a cos(theta),  e = first change of u,

restarted from the exact phase in each period. At the end of an epoch the steady response jumps, and
the modes take the opposite jump, so that the motion of the beam is continuous.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.lanes.layout import CLOCK
from models.beam.structure.modal import Array
from models.beam.structure.random_lines import AMPLITUDE, COUNT, SPEED, TURN, draw, turn_at
from models.beam.structure.random_response import add_modes, respond
from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.numerics.sincos import cosine_sine

_LINE = 8  # slots of a line:
_U, _E, _SLOW, _SIZE, _SINE, _COSINE, _SPEED, _TURN = range(_LINE)
_STEPS = 4  # at a time, and four lines at a time


class Load(NamedTuple):
    """The random load of n beams, and the oscillators that respond to it."""

    load: NDArray[np.void]
    oscillators: Array
    begin: Array
    forcing: Array


class Lines(NamedTuple):
    """The lines of a block of lanes.

    Attributes
    ----------
    slots : ndarray, shape (COUNT * 8 * LANES,)
        u, e, 4 sin^2(delta/2), a, sin(delta/2), cos(delta/2), turns per period, and the turn at the
        start of the epoch, of each line.
    drawn : ndarray, shape (COUNT, 3)
        The lines of one lane.
    modes : ndarray, shape (2, all modes)
        Steady response of one lane.
    """

    slots: Array
    drawn: Array
    modes: Array

    @staticmethod
    def room(modes: int) -> "Lines":
        """Return room for the lines of a block."""
        return Lines(aligned(COUNT * _LINE * LANES), np.empty((COUNT, 3)), np.empty((2, modes)))


def in_fours(steps: int) -> int:
    """Return this number of steps, rounded up to a multiple of those summed at a time."""
    return -(-steps // _STEPS) * _STEPS


@kernel
def draw_lines(load, state, first, steps, lines):
    """Draw the lines of up to LANES rows from `first` on; return whether there are any.

    Spare lanes repeat the last row.
    """
    lines.slots[:] = 0.0
    last = state.shape[0] - 1
    is_random = False
    for lane in range(LANES):
        n = min(first + lane, last)
        if load.load[n]["power"] > 0:
            is_random = True
            epoch = int(state[n, CLOCK]) // load.load[n]["epoch"]
            _draw_lane(load, n, epoch, steps, lines, lane)
    return is_random


@kernel
def _draw_lane(load, n, epoch, steps, lines, lane):
    slots, drawn, _ = lines
    frequency, decay, mobility = load.oscillators[n]
    draw(load.load[n], epoch, drawn)
    respond(drawn, load.forcing[n], frequency, decay, mobility)
    for j in range(COUNT):
        k = j * _LINE * LANES + lane
        half = np.pi * drawn[j, SPEED] / steps
        sine = math.sin(half)
        slots[k + _SLOW * LANES] = 4 * sine * sine
        slots[k + _SIZE * LANES] = drawn[j, AMPLITUDE]
        slots[k + _SINE * LANES] = sine
        slots[k + _COSINE * LANES] = math.cos(half)
        slots[k + _SPEED * LANES] = drawn[j, SPEED]
        slots[k + _TURN * LANES] = drawn[j, TURN]


@kernel
def redraw_lines(load, state, first, period, steps, lines, w, stride):
    """Redraw the lines of the lanes whose epoch ends at the start of a period of the call.

    `w` holds y and r of each mode, `stride` slots apart from those of the next one.
    """
    last = state.shape[0] - 1
    for lane in range(LANES):
        n = min(first + lane, last)
        clock = int(state[n, CLOCK]) + period
        length = load.load[n]["epoch"]
        if load.load[n]["power"] == 0 or clock == 0 or clock % length:
            continue
        epoch = clock // length
        frequency, decay, mobility = load.oscillators[n]
        modes = (load.forcing[n], frequency, decay, mobility, lines.modes)
        lines.modes[:] = 0.0
        draw(load.load[n], epoch - 1, lines.drawn)
        add_modes(lines.drawn, length, 1.0, *modes)
        draw(load.load[n], epoch, lines.drawn)
        add_modes(lines.drawn, 0, -1.0, *modes)
        for i in range(load.begin.shape[2]):
            to_displacement, to_velocity, moving = load.begin[n, :, i]
            z, v = lines.modes[0, i] * moving, lines.modes[1, i]
            k = i * stride + lane
            w[k] += z
            w[k + LANES] += to_displacement * z + to_velocity * v - w[k + 2 * LANES] * z
        _draw_lane(load, n, epoch, steps, lines, lane)


@kernel
def add_lines(load, state, first, period, lines, drive):
    """Add the lines to the tip's motion without contact at each step of a period of the call."""
    slots, _, _ = lines
    last = state.shape[0] - 1
    since = np.empty(LANES)
    for lane in range(LANES):
        n = min(first + lane, last)
        since[lane] = (int(state[n, CLOCK]) + period) % load.load[n]["epoch"]
    for j in range(COUNT):
        for lane in range(LANES):
            k = j * _LINE * LANES + lane
            turn = turn_at(slots[k + _SPEED * LANES], slots[k + _TURN * LANES], since[lane])
            c, s = cosine_sine(2 * np.pi * turn)
            a, sine, cosine = (
                slots[k + _SIZE * LANES],
                slots[k + _SINE * LANES],
                slots[k + _COSINE * LANES],
            )
            slots[k] = a * c
            slots[k + LANES] = -2 * a * sine * fma(s, cosine, c * sine)
    for j in range(0, COUNT, 4):
        four = slots[j * _LINE * LANES : (j + 4) * _LINE * LANES]
        for at in range(0, drive.size, _STEPS * LANES):
            _turn_four(four, drive[at : at + _STEPS * LANES])


@inlined
def _turn(u, e, slow):
    """Advance a line by four steps."""
    u0 = u + e
    e = fma(-slow, u0, e)
    u1 = u0 + e
    e = fma(-slow, u1, e)
    u2 = u1 + e
    e = fma(-slow, u2, e)
    u3 = u2 + e
    e = fma(-slow, u3, e)
    return u0, u1, u2, u3, e


@kernel
def _turn_four(slots, drive):
    """Add the contributions of four lines to four steps."""
    for lane in range(LANES):
        k = lane
        a0, a1, a2, a3, e = _turn(slots[k], slots[k + LANES], slots[k + 2 * LANES])
        slots[k], slots[k + LANES] = a3, e
        k += _LINE * LANES
        b0, b1, b2, b3, e = _turn(slots[k], slots[k + LANES], slots[k + 2 * LANES])
        slots[k], slots[k + LANES] = b3, e
        k += _LINE * LANES
        c0, c1, c2, c3, e = _turn(slots[k], slots[k + LANES], slots[k + 2 * LANES])
        slots[k], slots[k + LANES] = c3, e
        k += _LINE * LANES
        d0, d1, d2, d3, e = _turn(slots[k], slots[k + LANES], slots[k + 2 * LANES])
        slots[k], slots[k + LANES] = d3, e
        drive[lane] += (a0 + b0) + (c0 + d0)
        drive[lane + LANES] += (a1 + b1) + (c1 + d1)
        drive[lane + 2 * LANES] += (a2 + b2) + (c2 + d2)
        drive[lane + 3 * LANES] += (a3 + b3) + (c3 + d3)
