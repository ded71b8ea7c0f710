"""Synchronous running of the rigid machine as a periodic orbit, by Newton's method.

The machine knows no clock, so the period T is an unknown and psi_1 = 0 anchors the start of the
revolution: the other nine components of the state and T are such that after T the body is where it
was and both vibrators have turned once. The derivatives of the end with respect to the start are
integrated along, sixteen machines abreast; they also give the Floquet multipliers.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel
from models.numerics.sincos import cosine_sine
from models.numerics.tsit5 import STAGES, combiner, layout
from models.vibrator.lanes import CONSTANTS, STATE, Array, load, machine, slopes, store
from models.vibrator.rigid import accelerations, derivatives

ANCHOR = 3  # psi_1
FREE = [i for i in range(STATE) if i != ANCHOR]
COLUMNS = len(FREE)
ITERATIONS = 10
_CLOSE = 1e-6  # of a revolution: a step this small was the last but for rounding
_BOLDEST = 0.5  # largest step of psi_2 [rad]

_QUANTITIES = STATE * (1 + COLUMNS)
_combine = combiner(_QUANTITIES)
_Y, _NEW, _K, _SIZE = layout(_QUANTITIES)
_WHOLE = _QUANTITIES * LANES
_combine_state = combiner(STATE)
_Y_0, _NEW_0, _K_0, _SIZE_0 = layout(STATE)
_WHOLE_0 = STATE * LANES


class Orbits(NamedTuple):
    """Periodic orbits of n machines.

    Attributes
    ----------
    found : ndarray of bool, shape (n,)
        Everything else is meaningless where False.
    state : ndarray, shape (n, 10)
        At psi_1 = 0.
    period : ndarray, shape (n,)
        [s]
    multiplier : ndarray, shape (n,)
        Largest modulus of a Floquet multiplier but for the trivial 1.
    """

    found: NDArray[np.bool_]
    state: Array
    period: Array
    multiplier: Array


@kernel
def _slopes(c, h, y, k, jacobian):
    """Set k to the slopes of the states y of all lanes and of their nine derivatives."""
    slopes(c, h, y, k)
    for lane in range(LANES):
        m = machine(c, lane)
        c_1, s_1 = cosine_sine(m.working_angle + y[3 * LANES + lane])
        c_2, s_2 = cosine_sine(m.working_angle - y[4 * LANES + lane])
        x, y_, alpha = y[lane], y[LANES + lane], y[2 * LANES + lane]
        vx, vy, va = y[5 * LANES + lane], y[6 * LANES + lane], y[7 * LANES + lane]
        w_1, w_2 = y[8 * LANES + lane], y[9 * LANES + lane]
        motion = accelerations(m, c_1, s_1, c_2, s_2, x, y_, alpha, vx, vy, va, w_1, w_2)
        rows = derivatives(m, motion, c_1, s_1, c_2, s_2, va, w_1, w_2)
        for i in range(STATE):
            for j in range(5):
                jacobian[(j * STATE + i) * LANES + lane] = h[lane] * rows[i][j]
    for column in range(1, 1 + COLUMNS):
        z = column * STATE * LANES
        for i in range(5):
            for lane in range(LANES):
                k[z + i * LANES + lane] = h[lane] * y[z + (5 + i) * LANES + lane]
        for i in range(5):
            a = i * STATE * LANES
            for lane in range(LANES):
                total = jacobian[a + lane] * y[z + lane]
                total += jacobian[a + LANES + lane] * y[z + LANES + lane]
                total += jacobian[a + 2 * LANES + lane] * y[z + 2 * LANES + lane]
                total += jacobian[a + 3 * LANES + lane] * y[z + 3 * LANES + lane]
                total += jacobian[a + 4 * LANES + lane] * y[z + 4 * LANES + lane]
                total += jacobian[a + 5 * LANES + lane] * y[z + 5 * LANES + lane]
                total += jacobian[a + 6 * LANES + lane] * y[z + 6 * LANES + lane]
                total += jacobian[a + 7 * LANES + lane] * y[z + 7 * LANES + lane]
                total += jacobian[a + 8 * LANES + lane] * y[z + 8 * LANES + lane]
                total += jacobian[a + 9 * LANES + lane] * y[z + 9 * LANES + lane]
                k[z + (5 + i) * LANES + lane] = total


@kernel
def _revolve(constants, start, h, steps, end, work):
    """Set end[:, :, 0] to the states after some steps, the rest to their derivatives and rates."""
    c, w, step_size, jacobian, state, one = work
    y, new = w[_Y : _Y + _WHOLE], w[_NEW : _NEW + _WHOLE]
    one[:] = 1.0
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        y[:] = 0.0
        load(start, first, y)
        column = 1
        for i in range(STATE):
            if i != ANCHOR:
                for lane in range(LANES):
                    y[(column * STATE + i) * LANES + lane] = 1.0
                column += 1
        for _ in range(steps):
            for stage in range(1, STAGES + 1):
                k = w[_K + (stage - 1) * _WHOLE : _K + stage * _WHOLE]
                _slopes(c, step_size, y if stage == 1 else new, k, jacobian)
                _combine(stage, w)
            y[:] = new
        slopes(c, one, y, state)
        for n in range(first, min(first + LANES, start.shape[0])):
            for i in range(STATE):
                for column in range(1 + COLUMNS):
                    end[n, i, column] = y[(column * STATE + i) * LANES + n - first]
                end[n, i, 1 + COLUMNS] = state[i * LANES + n - first]


@kernel
def _follow(constants, start, h, trace, work):
    """Set trace, shape (n, steps, 10), to the states after each step."""
    c, w, step_size = work
    y, new = w[_Y_0 : _Y_0 + _WHOLE_0], w[_NEW_0 : _NEW_0 + _WHOLE_0]
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        load(start, first, y)
        for step in range(trace.shape[1]):
            for stage in range(1, STAGES + 1):
                k = w[_K_0 + (stage - 1) * _WHOLE_0 : _K_0 + stage * _WHOLE_0]
                slopes(c, step_size, y if stage == 1 else new, k)
                _combine_state(stage, w)
            y[:] = new
            store(y, first, trace[:, step])


def follow(constants: Array, state: Array, period: Array, steps: int) -> Array:
    """Return the states of n machines at equal steps through one period.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    state : ndarray, shape (n, 10)
    period : ndarray, shape (n,)
    steps : int

    Returns
    -------
    ndarray, shape (n, steps, 10)
        The last of them a period after `state`.
    """
    trace = np.empty((len(state), steps, STATE))
    work = aligned(CONSTANTS * LANES), aligned(_SIZE_0), aligned(LANES)
    _follow(constants, state, (period / steps)[:, None], trace, work)
    return trace


def find_orbits(constants: Array, state: Array, period: Array, steps: int) -> Orbits:
    """Find the periodic orbits of n machines near a guess.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
        Of `models.vibrator.lanes.pack`.
    state : ndarray, shape (n, 10)
        Guess, at psi_1 = 0.
    period : ndarray, shape (n,)
        Guess [s].
    steps : int
        In a revolution.

    Returns
    -------
    Orbits
    """
    n = len(state)
    out = Orbits(np.zeros(n, bool), state.copy(), period.copy(), np.full(n, np.nan))
    work = (
        aligned(CONSTANTS * LANES),
        aligned(_SIZE),
        aligned(LANES),
        aligned(5 * STATE * LANES),
        aligned(STATE * LANES),
        aligned(LANES),
    )
    turn = np.zeros(STATE)
    turn[3:5] = 2 * np.pi
    left = np.arange(n)
    for _ in range(ITERATIONS):
        start, time = out.state[left], out.period[left]
        end = np.empty((len(left), STATE, 2 + COLUMNS))
        _revolve(constants[left], start, (time / steps)[:, None], steps, end, work)
        sound = np.isfinite(end).all(axis=(1, 2)) & (np.abs(end).max(axis=(1, 2)) < 1e12)
        left, start, time, end = left[sound], start[sound], time[sound], end[sound]
        if not len(left):
            break
        miss = end[:, :, 0] - start - turn
        matrix = end[:, :, 1:].copy()
        matrix[:, FREE, np.arange(COLUMNS)] -= 1
        step, regular = _solve(matrix, -miss)
        bold = np.abs(step[:, 3]) + np.abs(step[:, -1]) / time
        step *= np.minimum(1.0, _BOLDEST / np.maximum(bold, 1e-300))[:, None]
        out.state[left[:, None], FREE] += step[:, :-1]
        out.period[left] += step[:, -1]
        # Newton's next error is of the order of the square of this step.
        done = regular & (bold < _CLOSE) & (out.period[left] > 0)
        out.found[left[done]] = True
        out.multiplier[left[done]] = _largest_multiplier(end[done])
        left = left[regular & ~done & (out.period[left] > 0.2 * period[left])]
        if not len(left):
            break
    return out


def _solve(matrix: Array, right: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solve n systems, each on its own, so that a singular one harms no other."""
    scale = np.abs(matrix).max(axis=2, keepdims=True)
    scale[scale == 0] = 1.0
    scaled = matrix / scale
    regular = np.abs(np.linalg.det(scaled)) > 1e-200
    scaled[~regular] = np.eye(matrix.shape[1])
    step = np.linalg.solve(scaled, right[:, :, None] / scale)[:, :, 0]
    return np.where(regular[:, None], step, 0.0), regular


def _largest_multiplier(end: Array) -> Array:
    """Return the spectral radius of the map from one passage of psi_1 = 0 to the next."""
    if not len(end):
        return np.empty(0)
    derivative, rate = end[:, :, 1 : 1 + COLUMNS], end[:, :, -1]
    late = derivative[:, ANCHOR] / rate[:, ANCHOR, None]
    passage = (derivative - rate[:, :, None] * late[:, None, :])[:, FREE]
    return np.abs(np.linalg.eigvals(passage)).max(axis=1)
