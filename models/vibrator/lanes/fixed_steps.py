"""The fast propagator: sixteen rigid machines abreast, Runge-Kutta steps of fixed length.

All loops over lanes are straight lines, so lanes never diverge and a row's bits do not depend on
its neighbours. See `models.numerics.nystrom`.
"""

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES, aligned
from models.numerics.events import crossing, dip
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.numerics.nystrom import ORDER_5, ORDER_8, STAGES, layout, stepper
from models.numerics.sincos import cosine_sine, nearest
from models.vibrator.equations.rigid import Rigid, accelerations
from models.vibrator.equations.system import System
from models.vibrator.lanes import dynamics

Array = NDArray[np.float64]

STATE = 10  # x, y, alpha, psi_1, psi_2 and their rates
CONSTANTS = len(Rigid._fields)
_AT = layout(dynamics.DEGREES)
_SIZE = dynamics.END + STAGES * dynamics.DEGREES * LANES
_step_5 = stepper(dynamics.DEGREES, dynamics.END, *ORDER_5, dynamics.accelerate)
_step_8 = stepper(dynamics.DEGREES, dynamics.END, *ORDER_8, dynamics.accelerate)

STABLE = 0.8
"""Step times the fastest rate of a machine: what keeps the method stable with room to spare."""

_TURN = 2 * np.pi
_PER_TURN = 1 / _TURN
_DEAD = 1e-140

# What `advance` notes of each row.
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
SUMS = 3  # the first ones are sums over the steps


def pack(system: System) -> Array:
    """Return the constants of n machines, shape (n, CONSTANTS)."""
    return np.stack([getattr(system, name) for name in Rigid._fields], axis=1)


@inlined
def machine(c, lane):
    """Return the constants of one lane."""
    return Rigid(
        c[lane],
        c[LANES + lane],
        c[2 * LANES + lane],
        c[3 * LANES + lane],
        c[4 * LANES + lane],
        c[5 * LANES + lane],
        c[6 * LANES + lane],
        c[7 * LANES + lane],
        c[8 * LANES + lane],
        c[9 * LANES + lane],
        c[10 * LANES + lane],
        c[11 * LANES + lane],
        c[12 * LANES + lane],
        c[13 * LANES + lane],
        c[14 * LANES + lane],
        c[15 * LANES + lane],
        c[16 * LANES + lane],
        c[17 * LANES + lane],
        c[18 * LANES + lane],
        c[19 * LANES + lane],
        c[20 * LANES + lane],
        c[21 * LANES + lane],
        c[22 * LANES + lane],
        c[23 * LANES + lane],
        c[24 * LANES + lane],
        c[25 * LANES + lane],
        c[26 * LANES + lane],
    )


@kernel
def slopes(c, h, y, k):
    """Set k to the rates of change of the states y of all lanes, times the step."""
    for lane in range(LANES):
        m, step = machine(c, lane), h[lane]
        c_1, s_1 = cosine_sine(m.working_angle + y[3 * LANES + lane])
        c_2, s_2 = cosine_sine(m.working_angle - y[4 * LANES + lane])
        x, y_, alpha = y[lane], y[LANES + lane], y[2 * LANES + lane]
        vx, vy, va = y[5 * LANES + lane], y[6 * LANES + lane], y[7 * LANES + lane]
        w_1, w_2 = y[8 * LANES + lane], y[9 * LANES + lane]
        motion = accelerations(m, c_1, s_1, c_2, s_2, x, y_, alpha, vx, vy, va, w_1, w_2)
        k[lane] = step * vx
        k[LANES + lane] = step * vy
        k[2 * LANES + lane] = step * va
        k[3 * LANES + lane] = step * w_1
        k[4 * LANES + lane] = step * w_2
        k[5 * LANES + lane] = step * motion.x
        k[6 * LANES + lane] = step * motion.y
        k[7 * LANES + lane] = step * motion.alpha
        k[8 * LANES + lane] = step * motion.psi_1
        k[9 * LANES + lane] = step * motion.psi_2


@kernel
def load(table, first, out):
    """Bring up to LANES rows of an (n, q) table into lanes; spare lanes repeat the last row."""
    last = table.shape[0] - 1
    for lane in range(LANES):
        for i in range(table.shape[1]):
            out[i * LANES + lane] = table[min(first + lane, last), i]


@kernel
def store(lanes, first, table):
    """Bring lanes back into their rows of an (n, q) table."""
    for n in range(first, min(first + LANES, table.shape[0])):
        for i in range(table.shape[1]):
            table[n, i] = lanes[i * LANES + n - first]


@kernel
def _begin(w, target, notes):
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
    """Return the squared displacement, and its rise in a step at this rate."""
    x, y = w[_X + lane], w[_Y + lane]
    out = 2 * w[_AT.step + lane] * fma(x, w[_VX + lane], y * w[_VY + lane])
    return fma(x, x, y * y), out


@inlined
def _way(w, target, lane):
    """Return the disphasing angle less its target, on the circle, and its rise in a step."""
    off = w[_PSI_1 + lane] - w[_PSI_2 + lane] - target[lane]
    drift = w[_AT.step + lane] * (w[_W_1 + lane] - w[_W_2 + lane])
    return fma(-_TURN, nearest(off * _PER_TURN), off), drift


@kernel
def _entry(off_0, drift_0, off, drift, band):
    """Return where in a step an angle last comes into its band, -1 if it does not.

    Between the ends of the step it is a cubic, which may leave the band and return.
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
def _note_entries(w, target, step, band, notes):
    """Note when angles come into their band; nearly always a look at all lanes is enough."""
    some = 0
    for lane in range(LANES):
        off, drift = _way(w, target, lane)
        off_0, drift_0 = notes[_OFF * LANES + lane], notes[_DRIFT * LANES + lane]
        notes[_NEW_OFF * LANES + lane], notes[_NEW_DRIFT * LANES + lane] = off, drift
        size_0, size = abs(off_0), abs(off)
        # A cubic is nowhere further from both its ends.
        room = 4 / 27 * (abs(drift_0) + abs(drift))
        higher = size_0 if size_0 > size else size
        returns = (drift_0 * drift < 0.0) & (higher <= band) & (higher + room > band)
        some += 1 if returns | ((size_0 > band) & (size <= band)) else 0
    if some > 0:
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
def _note(c, w, notes):
    """Take in a step, whose end is the state."""
    for lane in range(LANES):
        w_1, w_2 = w[_W_1 + lane], w[_W_2 + lane]
        lag_1 = c[_SYNCHRONOUS_1 * LANES + lane] - w_1
        lag_2 = c[_SYNCHRONOUS_2 * LANES + lane] - w_2
        slip_1, slip_2 = c[_SLIP_1 * LANES + lane], c[_SLIP_2 * LANES + lane]
        power_1 = c[_TORQUE_1 * LANES + lane] * lag_1 * w_1 / fma(slip_1, slip_1, lag_1 * lag_1)
        power_2 = c[_TORQUE_2 * LANES + lane] * lag_2 * w_2 / fma(slip_2, slip_2, lag_2 * lag_2)
        notes[POWER_1 * LANES + lane] += power_1
        notes[POWER_2 * LANES + lane] += power_2
        cosine, sine = c[_COS * LANES + lane], c[_SIN * LANES + lane]
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
        # The square of the displacement is a cubic in a step; its vertex where its rate vanishes.
        turned = (out_0 > 0.0) & (out < 0.0)
        part = out_0 / (out_0 - out) if turned else 1.0
        rest = 1.0 - part
        vertex = rest * rest * fma(fma(2.0, part, 1.0), far_0, part * out_0)
        vertex = fma(part * part, fma(fma(2.0, rest, 1.0), far, -rest * out), vertex)
        peak = notes[EXCURSION * LANES + lane]
        notes[EXCURSION * LANES + lane] = vertex if vertex > peak else peak


_SYNCHRONOUS_1 = Rigid._fields.index("synchronous_speed_1")
_SYNCHRONOUS_2 = Rigid._fields.index("synchronous_speed_2")
_SLIP_1, _SLIP_2 = Rigid._fields.index("slip_1"), Rigid._fields.index("slip_2")
_TORQUE_1, _TORQUE_2 = Rigid._fields.index("torque_1"), Rigid._fields.index("torque_2")
_SPACING = Rigid._fields.index("half_spacing")
_COS, _SIN = CONSTANTS, CONSTANTS + 1
_FAR, _OUT, _OFF, _DRIFT, _NEW_OFF, _NEW_DRIFT = range(NOTES, NOTES + 6)  # between steps
_X, _Y, _ALPHA, _PSI_1, _PSI_2 = (_AT.position + i * LANES for i in range(dynamics.DEGREES))
_VX, _VY, _VA, _W_1, _W_2 = (_AT.velocity + i * LANES for i in range(dynamics.DEGREES))


@kernel
def _advance(constants, h, state, target, steps, accurate, band, notes, work):
    c, w, note, step_size, aim = work
    y = w[_AT.position : _AT.position + STATE * LANES]
    for first in range(0, state.shape[0], LANES):
        load(constants, first, c)
        load(state, first, y)
        # Vibrations that have died away: numbers near underflow would be ten times slower.
        for j in range(STATE * LANES):
            y[j] = y[j] if abs(y[j]) > _DEAD else 0.0
        load(h, first, step_size)
        load(target, first, aim)
        for lane in range(LANES):
            angle = c[4 * LANES + lane]
            c[_COS * LANES + lane], c[_SIN * LANES + lane] = np.cos(angle), np.sin(angle)
            dynamics.prepare(machine(c, lane), step_size[lane], w, lane)
            for i in range(dynamics.DEGREES):
                w[_AT.step + i * LANES + lane] = step_size[lane]
        _begin(w, aim, note)
        for step in range(steps):
            if accurate:
                _step_8(w)
            else:
                _step_5(w)
            _note(c, w, note)
            _note_entries(w, aim, float(step), band, note)
        store(y, first, state)
        store(note, first, notes)


def advance(
    constants: Array,
    h: Array,
    state: Array,
    target: Array,
    steps: int,
    band: float,
    accurate: bool,
) -> Array:
    """Advance n machines by some steps.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
        Of `pack`.
    h : ndarray, shape (n,)
        Step [s].
    state : ndarray, shape (n, STATE)
        Updated in place.
    target : ndarray, shape (n,)
        Disphasing angle about which the band is [rad]; NaN for none.
    steps : int
    band : float
        [rad]
    accurate : bool
        Whether in steps of order 8, else 5. They cost twice as much; measured on run-ups of 5 s,
        six in a turn err by 1e-8 rad, as twenty of order 5 do.

    Returns
    -------
    ndarray, shape (n, NOTES)
        Sums over the steps of the motors' powers before bearing loss [W] and of the disphasing
        angle [rad]; lowest and highest
        rotation [rad], displacement along xi of the left and the right end of the deck [m], and
        disphasing angle [rad]; largest squared displacement of C [m2]; when the disphasing angle
        last came into its band [steps], -1 if it did not.
    """
    notes = np.empty((len(state), NOTES))
    work = (
        aligned((CONSTANTS + 2) * LANES),
        aligned(_SIZE),
        aligned((NOTES + 6) * LANES),
        aligned(LANES),
        aligned(LANES),
    )
    _advance(constants, h[:, None], state, target[:, None], steps, accurate, band, notes, work)
    return notes
