"""A revolution of sixteen rigid machines with its derivatives with respect to the start.

A step first takes the state through its stages and keeps how the accelerations change there; then
the derivatives go through the whole step column by column, each in registers. That way all that a
column needs stays in the fastest cache; stage by stage it would not.
"""

import numpy as np

from models.numerics.blocks import LANES, aligned, copy
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel, spliced
from models.numerics.nystrom import weights
from models.numerics.tableaux import TSITOURAS_5
from models.vibrator.lanes.derivatives import FACTORS, SUPPORTS, change, linearise, support
from models.vibrator.lanes.dynamics import DEGREES, accelerate
from models.vibrator.lanes.machines import Machines
from models.vibrator.lanes.packed import (
    CONSTANTS,
    STATE,
    WHOLE,
    Array,
    Part,
    load,
    machine,
    store,
    turn_back,
)
from models.vibrator.lanes.steps import AT, SIZE, combine_5, prepare

ANCHOR = 3  # psi_1
FREE = [i for i in range(STATE) if i != ANCHOR]
COLUMNS = len(FREE)
ENTRIES = COLUMNS + 2
"""Of each component of an end: itself, its derivatives by the start, and its rate."""

_WHOLE = STATE * LANES
_STAGES = len(TSITOURAS_5.b)
_, _C2, _C3, _C4, _C5, _C6 = TSITOURAS_5.c
_VELOCITY, _POSITION = (w.tolist() for w in weights(TSITOURAS_5))
(_A21,), (_A31, _A32), (_A41, _A42, _A43) = _VELOCITY[1][:1], _VELOCITY[2][:2], _VELOCITY[3][:3]
(_A51, _A52, _A53, _A54), (_A61, _A62, _A63, _A64, _A65) = _VELOCITY[4][:4], _VELOCITY[5][:5]
_B1, _B2, _B3, _B4, _B5, _B6 = _VELOCITY[6]
(_P31,), (_P41, _P42), (_P51, _P52, _P53) = _POSITION[2][:1], _POSITION[3][:2], _POSITION[4][:3]
(_P61, _P62, _P63, _P64), (_Q1, _Q2, _Q3, _Q4, _Q5) = _POSITION[5][:4], _POSITION[6][:5]

# One flat array holds the factors of the derivatives at each stage, those of all stages, the
# current column, and all columns: `_carry` is vectorised only if the compiler knows all offsets.
_J_2, _J_3, _J_4, _J_5, _J_6 = (i * FACTORS for i in range(1, _STAGES))
_SUPPORT = _STAGES * FACTORS
_COLUMN = _SUPPORT + SUPPORTS
_TANGENTS = _COLUMN + _WHOLE
_BLOCK = _TANGENTS + COLUMNS * _WHOLE

ROOMS = (SIZE, LANES, _BLOCK, _WHOLE)
"""Sizes of the arrays in which `differentiate` works: motion, steps, derivatives, ends."""


@inlined
def _add(z, factor, k):
    """Return five numbers plus a multiple of five others."""
    return (
        fma(factor, k[0], z[0]),
        fma(factor, k[1], z[1]),
        fma(factor, k[2], z[2]),
        fma(factor, k[3], z[3]),
        fma(factor, k[4], z[4]),
    )


@inlined
def _take(w, o):
    return w[o], w[o + LANES], w[o + 2 * LANES], w[o + 3 * LANES], w[o + 4 * LANES]


@inlined
def _put(w, o, z):
    w[o], w[o + LANES], w[o + 2 * LANES], w[o + 3 * LANES], w[o + 4 * LANES] = z


@kernel
def _carry(w):
    """Take all columns through the step with these derivatives, in Nystrom's form."""
    for column in range(COLUMNS):
        o = _TANGENTS + column * _WHOLE
        for j in range(_WHOLE):
            w[_COLUMN + j] = w[o + j]
        for lane in range(LANES):
            s = _SUPPORT + lane
            z, v = _take(w, _COLUMN + lane), _take(w, _COLUMN + DEGREES * LANES + lane)
            k_1 = change(w, s, lane, z, v)
            k_2 = change(w, s, _J_2 + lane, _add(z, _C2, v), _add(v, _A21, k_1))
            at = _add(_add(z, _C3, v), _P31, k_1)
            k_3 = change(w, s, _J_3 + lane, at, _add(_add(v, _A31, k_1), _A32, k_2))
            at = _add(_add(_add(z, _C4, v), _P41, k_1), _P42, k_2)
            go = _add(_add(_add(v, _A41, k_1), _A42, k_2), _A43, k_3)
            k_4 = change(w, s, _J_4 + lane, at, go)
            at = _add(_add(_add(_add(z, _C5, v), _P51, k_1), _P52, k_2), _P53, k_3)
            go = _add(_add(_add(_add(v, _A51, k_1), _A52, k_2), _A53, k_3), _A54, k_4)
            k_5 = change(w, s, _J_5 + lane, at, go)
            at = _add(_add(_add(_add(z, _C6, v), _P61, k_1), _P62, k_2), _P63, k_3)
            at = _add(at, _P64, k_4)
            go = _add(_add(_add(_add(v, _A61, k_1), _A62, k_2), _A63, k_3), _A64, k_4)
            k_6 = change(w, s, _J_6 + lane, at, _add(go, _A65, k_5))
            z = _add(_add(_add(_add(z, 1.0, v), _Q1, k_1), _Q2, k_2), _Q3, k_3)
            _put(w, _COLUMN + lane, _add(_add(z, _Q4, k_4), _Q5, k_5))
            v = _add(_add(_add(v, _B1, k_1), _B2, k_2), _B3, k_3)
            v = _add(_add(_add(v, _B4, k_4), _B5, k_5), _B6, k_6)
            _put(w, _COLUMN + DEGREES * LANES + lane, v)
        for j in range(_WHOLE):
            w[o + j] = w[_COLUMN + j]


@kernel
def _begin(c, h, w):
    """Set the columns to those of the identity except that of psi_1; x and y are those of S."""
    support(c, h, w[_SUPPORT : _SUPPORT + SUPPORTS])
    w[_TANGENTS:_BLOCK] = 0.0
    column = 0
    for i in range(STATE):
        if i != ANCHOR:
            o = _TANGENTS + column * _WHOLE
            for lane in range(LANES):
                diagonal = 1.0 if i < DEGREES else h[lane]
                w[o + i * LANES + lane] = diagonal
                if i == 2 or i == DEGREES + 2:
                    w[o + (i - 2) * LANES + lane] = diagonal * machine(c, lane).support_offset
                    w[o + (i - 1) * LANES + lane] = diagonal * machine(c, lane).support_lever
            column += 1


@spliced
def _step(c, w, tangents):
    """Advance states and derivatives by one step."""
    _look(w)
    for stage in range(_STAGES):
        accelerate(w)
        linearise(c, w, tangents[stage * FACTORS : (stage + 1) * FACTORS])
        combine_5(stage, w)
    _carry(tangents)


@kernel
def _look(w):
    """Prepare to evaluate the accelerations at the present states."""
    for j in range(_WHOLE):
        w[AT.at + j] = w[AT.position + j]


@spliced
def differentiate(c, start, time, steps, mirror, turn, end, work):
    """Set `end` to where all lanes return after a part of a revolution, with derivatives.

    Parameters
    ----------
    c : ndarray
        Constants of the machines, in lanes.
    start : ndarray, shape (STATE * LANES,)
    time : ndarray, shape (LANES,)
        Of this part [s].
    steps : int
        In that time.
    mirror, turn
        See `models.vibrator.lanes.packed.Part`.
    end : ndarray, shape (STATE * ENTRIES * LANES,)
        As `revolve` returns it, in lanes.
    work : tuple of ndarray
        Rooms of `ROOMS`.
    """
    w, h, tangents, back = work
    y = w[AT.position : AT.position + _WHOLE]
    for lane in range(LANES):
        h[lane] = time[lane] / steps
    prepare(c, h, w)
    copy(start, y)
    _begin(c, h, tangents)
    for _ in range(steps):
        _step(c, w, tangents)
    _look(w)
    accelerate(w)
    turn_back(y, mirror, turn, back)
    for i in range(STATE):
        for lane in range(LANES):
            end[i * ENTRIES * LANES + lane] = back[i * LANES + lane]
    _note(c, w, tangents, mirror, end)


@kernel
def _note(c, w, tangents, mirror, end):
    """Record the derivatives of the states, by the start and by time."""
    for i in range(STATE):
        o = i * ENTRIES * LANES
        for column in range(COLUMNS):
            o += LANES
            at = _TANGENTS + column * _WHOLE + i * LANES
            for lane in range(LANES):
                change = tangents[at + lane]
                if i == 0 or i == DEGREES:
                    up = machine(c, lane).support_offset
                    change = fma(-up, tangents[at + 2 * LANES + lane], change)
                if i == 1 or i == DEGREES + 1:
                    right = machine(c, lane).support_lever
                    change = fma(-right, tangents[at + LANES + lane], change)
                per_step = 1.0 if i < DEGREES else 1 / w[AT.step + lane]
                end[o + lane] = mirror[i] * (change * per_step)
        o += LANES
        for lane in range(LANES):
            if i < DEGREES:
                rate = w[AT.velocity + i * LANES + lane]
            else:
                rate = w[AT.rise + (i - DEGREES) * LANES + lane] * (1 / w[AT.step + lane])
            end[o + lane] = mirror[i] * rate


@kernel
def _revolve(constants, start, time, steps, mirror, turn, out, work):
    c, y, t, end, rooms = work
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(start, first, y)
        load(time, first, t)
        differentiate(c, y, t, steps, mirror, turn, end, rooms)
        store(end, first, out)


def revolve(constants: Array, start: Array, time: Array, steps: int, part: Part) -> Array:
    """Return where n machines return, with derivatives by the start and by time.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    start : ndarray, shape (n, 10)
    time : ndarray, shape (n,)
        Of this part of a revolution [s].
    steps : int
        In that time.
    part : Part

    Returns
    -------
    ndarray, shape (n, 10, 11)
        By columns: the state after that time, turned back; its derivatives with respect to the
        components of the start except psi_1; and its rates.
    """
    out = np.empty((len(start), STATE * ENTRIES))
    work = (
        aligned(CONSTANTS * LANES),
        aligned(_WHOLE),
        aligned(LANES),
        aligned(STATE * ENTRIES * LANES),
        tuple(aligned(size) for size in ROOMS),
    )
    _revolve(constants, start, time[:, None], steps, part.mirror, part.turn, out, work)
    return out.reshape(-1, STATE, ENTRIES)


def monodromy(machines: Machines, state: Array, period: Array, steps: int) -> Array:
    """Return the derivatives of the states after a period with respect to those at its start.

    Parameters
    ----------
    machines : Machines
    state : ndarray, shape (n, 10)
    period : ndarray, shape (n,)
        [s]
    steps : int
        In the period.

    Returns
    -------
    ndarray, shape (n, 10, 10)
        Zero with respect to psi_1.
    """
    out = np.zeros((len(state), STATE, STATE))
    out[:, :, FREE] = revolve(machines.constants, state, period, steps, WHOLE)[:, :, 1:-1]
    return out
