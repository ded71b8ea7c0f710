"""What the fast propagator records of its steps.

Powers, extremes of the motion, and when the disphasing angle entered its band.
"""

import numpy as np

from models.numerics.blocks import LANES
from models.numerics.events import crossing, dip
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.numerics.nystrom import layout
from models.numerics.sincos import nearest
from models.vibrator.equations.rigid import Rigid
from models.vibrator.lanes import dynamics
from models.vibrator.lanes.packed import CONSTANTS

# What is recorded of each row.
(
    POWER_1,
    POWER_2,
    ANGLE,
    ALPHA_LOW,
    ALPHA_HIGH,
    LEFT_LOW,
    LEFT_HIGH,
    RIGHT_LOW,
    RIGHT_HIGH,
    ANGLE_LOW,
    ANGLE_HIGH,
    EXCURSION,
    LAST_ENTRY,
) = range(13)
NOTES = 13
SUMS = 3  # the first three are sums over the steps

COS, SIN = CONSTANTS, CONSTANTS + 1
"""Rows of the cosine and sine of the working angle, after the constants of the machine."""

CONSTANTS_ROOM, NOTES_ROOM = CONSTANTS + 2, NOTES + 6
"""Numbers that a lane needs for constants and notes."""

_AT = layout(dynamics.DEGREES)
_TURN = 2 * np.pi
_PER_TURN = 1 / _TURN
_SYNCHRONOUS_1 = Rigid._fields.index("synchronous_speed_1")
_SYNCHRONOUS_2 = Rigid._fields.index("synchronous_speed_2")
_SLIP_1, _SLIP_2 = Rigid._fields.index("slip_1"), Rigid._fields.index("slip_2")
_TORQUE_1, _TORQUE_2 = Rigid._fields.index("torque_1"), Rigid._fields.index("torque_2")
_SPACING = Rigid._fields.index("half_spacing")
_FAR, _OUT, _OFF, _DRIFT, _NEW_OFF, _NEW_DRIFT = range(NOTES, NOTES + 6)  # between steps
_X, _Y, _ALPHA, _PSI_1, _PSI_2 = (_AT.position + i * LANES for i in range(dynamics.DEGREES))
_VX, _VY, _VA, _W_1, _W_2 = (_AT.velocity + i * LANES for i in range(dynamics.DEGREES))


@kernel
def begin(w, target, notes):
    """Initialise the notes before the first step, from the state and the target of the angle."""
    for lane in range(LANES):
        for i in (POWER_1, POWER_2, ANGLE, EXCURSION):
            notes[i * LANES + lane] = 0.0
        for i in (ALPHA_LOW, LEFT_LOW, RIGHT_LOW, ANGLE_LOW):
            notes[i * LANES + lane] = np.inf
        for i in (ALPHA_HIGH, LEFT_HIGH, RIGHT_HIGH, ANGLE_HIGH):
            notes[i * LANES + lane] = -np.inf
        notes[LAST_ENTRY * LANES + lane] = -1.0
        notes[_FAR * LANES + lane], notes[_OUT * LANES + lane] = _distance(w, lane)
        notes[_OFF * LANES + lane], notes[_DRIFT * LANES + lane] = _way(w, target, lane)


@inlined
def _distance(w, lane):
    """Return the squared displacement of C, and its increase over a step at the present rate."""
    x, y = w[_X + lane], w[_Y + lane]
    out = 2 * w[_AT.step + lane] * fma(x, w[_VX + lane], y * w[_VY + lane])
    return fma(x, x, y * y), out


@inlined
def _way(w, target, lane):
    """Return the disphasing angle less its target, wrapped, and its increase over a step."""
    off = w[_PSI_1 + lane] - w[_PSI_2 + lane] - target[lane]
    drift = w[_AT.step + lane] * (w[_W_1 + lane] - w[_W_2 + lane])
    return fma(-_TURN, nearest(off * _PER_TURN), off), drift


@kernel
def _entry(off_0, drift_0, off, drift, band):
    """Return where in a step an angle last enters its band, -1 if it does not.

    Within the step it is a cubic, which may leave the band and return.
    """
    if abs(off_0) > band >= abs(off):
        side = 1.0 if off_0 > 0 else -1.0
        return crossing(side * off_0 - band, side * drift_0, side * off - band, side * drift)
    if max(abs(off_0), abs(off)) > band or not drift_0 * drift < 0:
        return -1.0
    side = 1.0 if drift_0 > 0 else -1.0
    at, lowest = dip(-side * off_0, -side * drift_0, -side * off, -side * drift)
    if -lowest <= band:
        return -1.0
    rest = 1 - at
    return at + rest * crossing(-lowest - band, 0.0, side * off - band, side * drift * rest)


@kernel
def note_entries(w, target, step, band, notes):
    """Record when angles enter their bands; almost always one check of all lanes is enough."""
    entering = 0
    for lane in range(LANES):
        off, drift = _way(w, target, lane)
        off_0, drift_0 = notes[_OFF * LANES + lane], notes[_DRIFT * LANES + lane]
        notes[_NEW_OFF * LANES + lane], notes[_NEW_DRIFT * LANES + lane] = off, drift
        size_0, size = abs(off_0), abs(off)
        # A bound of how far the cubic rises above both its ends.
        room = 4 / 27 * (abs(drift_0) + abs(drift))
        higher = size_0 if size_0 > size else size
        returns = (drift_0 * drift < 0.0) & (higher <= band) & (higher + room > band)
        entering += 1 if returns | ((size_0 > band) & (size <= band)) else 0
    if entering > 0:
        for lane in range(LANES):
            part = _entry(
                notes[_OFF * LANES + lane],
                notes[_DRIFT * LANES + lane],
                notes[_NEW_OFF * LANES + lane],
                notes[_NEW_DRIFT * LANES + lane],
                band,
            )
            last = notes[LAST_ENTRY * LANES + lane]
            notes[LAST_ENTRY * LANES + lane] = step + part if part >= 0 else last
    for j in range(2 * LANES):
        notes[_OFF * LANES + j] = notes[_NEW_OFF * LANES + j]


@kernel
def note_step(c, w, notes):
    """Record a step that ends at the present state."""
    for lane in range(LANES):
        w_1, w_2 = w[_W_1 + lane], w[_W_2 + lane]
        lag_1 = c[_SYNCHRONOUS_1 * LANES + lane] - w_1
        lag_2 = c[_SYNCHRONOUS_2 * LANES + lane] - w_2
        slip_1, slip_2 = c[_SLIP_1 * LANES + lane], c[_SLIP_2 * LANES + lane]
        power_1 = c[_TORQUE_1 * LANES + lane] * lag_1 * w_1 / fma(slip_1, slip_1, lag_1 * lag_1)
        power_2 = c[_TORQUE_2 * LANES + lane] * lag_2 * w_2 / fma(slip_2, slip_2, lag_2 * lag_2)
        notes[POWER_1 * LANES + lane] += power_1
        notes[POWER_2 * LANES + lane] += power_2
        cosine, sine = c[COS * LANES + lane], c[SIN * LANES + lane]
        alpha = w[_ALPHA + lane]
        along = fma(cosine, w[_X + lane], sine * w[_Y + lane])
        lever = c[_SPACING * LANES + lane] * sine * alpha
        left, right = along - lever, along + lever
        angle = w[_PSI_1 + lane] - w[_PSI_2 + lane]
        notes[ANGLE * LANES + lane] += angle
        low, high = notes[ALPHA_LOW * LANES + lane], notes[ALPHA_HIGH * LANES + lane]
        notes[ALPHA_LOW * LANES + lane] = alpha if alpha < low else low
        notes[ALPHA_HIGH * LANES + lane] = alpha if alpha > high else high
        low, high = notes[LEFT_LOW * LANES + lane], notes[LEFT_HIGH * LANES + lane]
        notes[LEFT_LOW * LANES + lane] = left if left < low else low
        notes[LEFT_HIGH * LANES + lane] = left if left > high else high
        low, high = notes[RIGHT_LOW * LANES + lane], notes[RIGHT_HIGH * LANES + lane]
        notes[RIGHT_LOW * LANES + lane] = right if right < low else low
        notes[RIGHT_HIGH * LANES + lane] = right if right > high else high
        low, high = notes[ANGLE_LOW * LANES + lane], notes[ANGLE_HIGH * LANES + lane]
        notes[ANGLE_LOW * LANES + lane] = angle if angle < low else low
        notes[ANGLE_HIGH * LANES + lane] = angle if angle > high else high
        far_0, out_0 = notes[_FAR * LANES + lane], notes[_OUT * LANES + lane]
        far, out = _distance(w, lane)
        notes[_FAR * LANES + lane], notes[_OUT * LANES + lane] = far, out
        # The squared displacement is a cubic in a step; its vertex is where its rate vanishes.
        turned = (out_0 > 0.0) & (out < 0.0)
        part = out_0 / (out_0 - out) if turned else 1.0
        rest = 1.0 - part
        vertex = rest * rest * fma(fma(2.0, part, 1.0), far_0, part * out_0)
        vertex = fma(part * part, fma(fma(2.0, rest, 1.0), far, -rest * out), vertex)
        peak = notes[EXCURSION * LANES + lane]
        notes[EXCURSION * LANES + lane] = vertex if vertex > peak else peak
