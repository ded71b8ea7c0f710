"""A revolution of sixteen rigid machines with its derivatives with respect to the start.

A step first takes the state through its stages and keeps their Jacobians; then the derivatives go
through the whole step column by column, each in registers, eight machines to a vector. That way all
that a column needs stays in the fastest cache; stage by stage it would not.
"""

import numpy as np

from models.numerics.blocks import LANES, aligned, layout
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.numerics.tableaux import TSITOURAS_5
from models.numerics.tsit5 import STAGES, combiner
from models.vibrator.equations.rigid_derivatives import derivatives
from models.vibrator.lanes.machines import Machines
from models.vibrator.lanes.packed import CONSTANTS, STATE, Array, load, set_slopes, slopes

ANCHOR = 3  # psi_1
FREE = [i for i in range(STATE) if i != ANCHOR]
COLUMNS = len(FREE)
_combine = combiner(STATE)
_Y, _NEW, _K, _SIZE = layout(STATE, STAGES)
_WHOLE = STATE * LANES
_K_2, _K_3, _K_4, _K_5, _K_6 = (_K + i * _WHOLE for i in range(1, STAGES))
_HALF = LANES // 2
_, (_A21,), (_A31, _A32), (_A41, _A42, _A43), (_A51, _A52, _A53, _A54), _LAST = TSITOURAS_5.a
_A61, _A62, _A63, _A64, _A65 = _LAST
_B1, _B2, _B3, _B4, _B5, _B6 = TSITOURAS_5.b

# One flat array holds the Jacobians of the stages by rows, times the step; the step; the current
# column; and all columns: `_carry` is vectorised only if the compiler knows all offsets. A gap of
# half a row after each Jacobian and column spreads what one half needs over the whole cache.
_JACOBIAN = 5 * STATE * LANES + _HALF
_J_2, _J_3, _J_4, _J_5, _J_6 = (i * _JACOBIAN for i in range(1, STAGES))
_STEP = STAGES * _JACOBIAN
_COLUMN = _STEP + LANES
_WIDTH = STATE * LANES + _HALF
_TANGENTS = _COLUMN + _WIDTH
_BLOCK = _TANGENTS + COLUMNS * _WIDTH


@inlined
def _put(jacobian, o, h, column):
    """Set one column of the Jacobian of the accelerations, times the step."""
    jacobian[o] = h * column[0]
    jacobian[o + STATE * LANES] = h * column[1]
    jacobian[o + 2 * STATE * LANES] = h * column[2]
    jacobian[o + 3 * STATE * LANES] = h * column[3]
    jacobian[o + 4 * STATE * LANES] = h * column[4]


@kernel
def _linearise(c, h, y, k, jacobian):
    """Set k to the slopes of the states y, and their Jacobian."""
    for lane in range(LANES):
        m, step, motion, c_1, s_1, c_2, s_2, va, w_1, w_2 = set_slopes(c, h, y, k, lane)
        by = derivatives(m, motion, c_1, s_1, c_2, s_2, va, w_1, w_2)
        _put(jacobian, lane, step, by[0])
        _put(jacobian, LANES + lane, step, by[1])
        _put(jacobian, 2 * LANES + lane, step, by[2])
        _put(jacobian, 3 * LANES + lane, step, by[3])
        _put(jacobian, 4 * LANES + lane, step, by[4])
        _put(jacobian, 5 * LANES + lane, step, by[5])
        _put(jacobian, 6 * LANES + lane, step, by[6])
        _put(jacobian, 7 * LANES + lane, step, by[7])
        _put(jacobian, 8 * LANES + lane, step, by[8])
        _put(jacobian, 9 * LANES + lane, step, by[9])


@inlined
def _row(w, o, z):
    """Return one row of a Jacobian times a column, in two independent sums."""
    first = fma(w[o + 2 * LANES], z[2], fma(w[o], z[0], w[o + LANES] * z[1]))
    first += fma(w[o + 3 * LANES], z[3], w[o + 4 * LANES] * z[4])
    second = fma(w[o + 7 * LANES], z[7], fma(w[o + 5 * LANES], z[5], w[o + 6 * LANES] * z[6]))
    second += fma(w[o + 8 * LANES], z[8], w[o + 9 * LANES] * z[9])
    return first + second


@inlined
def _slope(w, o, step, z):
    """Return the slopes of a column, times the step."""
    return (
        step * z[5],
        step * z[6],
        step * z[7],
        step * z[8],
        step * z[9],
        _row(w, o, z),
        _row(w, o + STATE * LANES, z),
        _row(w, o + 2 * STATE * LANES, z),
        _row(w, o + 3 * STATE * LANES, z),
        _row(w, o + 4 * STATE * LANES, z),
    )


@inlined
def _add(z, factor, k):
    """Return a column plus a multiple of its slopes."""
    return (
        fma(factor, k[0], z[0]),
        fma(factor, k[1], z[1]),
        fma(factor, k[2], z[2]),
        fma(factor, k[3], z[3]),
        fma(factor, k[4], z[4]),
        fma(factor, k[5], z[5]),
        fma(factor, k[6], z[6]),
        fma(factor, k[7], z[7]),
        fma(factor, k[8], z[8]),
        fma(factor, k[9], z[9]),
    )


@kernel
def _carry(w):
    """Take all columns through the step with these Jacobians."""
    for first in range(0, LANES, _HALF):
        for column in range(COLUMNS):
            o = _TANGENTS + column * _WIDTH + first
            for j in range(_WIDTH - _HALF):
                w[_COLUMN + first + j] = w[o + j]
            for lane in range(first, first + _HALF):
                step = w[_STEP + lane]
                z = (
                    w[_COLUMN + lane],
                    w[_COLUMN + LANES + lane],
                    w[_COLUMN + 2 * LANES + lane],
                    w[_COLUMN + 3 * LANES + lane],
                    w[_COLUMN + 4 * LANES + lane],
                    w[_COLUMN + 5 * LANES + lane],
                    w[_COLUMN + 6 * LANES + lane],
                    w[_COLUMN + 7 * LANES + lane],
                    w[_COLUMN + 8 * LANES + lane],
                    w[_COLUMN + 9 * LANES + lane],
                )
                k_1 = _slope(w, lane, step, z)
                at = _add(z, _A21, k_1)
                k_2 = _slope(w, _J_2 + lane, step, at)
                at = _add(_add(z, _A31, k_1), _A32, k_2)
                k_3 = _slope(w, _J_3 + lane, step, at)
                at = _add(_add(_add(z, _A41, k_1), _A42, k_2), _A43, k_3)
                k_4 = _slope(w, _J_4 + lane, step, at)
                at = _add(_add(_add(_add(z, _A51, k_1), _A52, k_2), _A53, k_3), _A54, k_4)
                k_5 = _slope(w, _J_5 + lane, step, at)
                at = _add(_add(_add(z, _A61, k_1), _A62, k_2), _A63, k_3)
                at = _add(_add(at, _A64, k_4), _A65, k_5)
                k_6 = _slope(w, _J_6 + lane, step, at)
                z = _add(_add(_add(z, _B1, k_1), _B2, k_2), _B3, k_3)
                z = _add(_add(_add(z, _B4, k_4), _B5, k_5), _B6, k_6)
                w[_COLUMN + lane] = z[0]
                w[_COLUMN + LANES + lane] = z[1]
                w[_COLUMN + 2 * LANES + lane] = z[2]
                w[_COLUMN + 3 * LANES + lane] = z[3]
                w[_COLUMN + 4 * LANES + lane] = z[4]
                w[_COLUMN + 5 * LANES + lane] = z[5]
                w[_COLUMN + 6 * LANES + lane] = z[6]
                w[_COLUMN + 7 * LANES + lane] = z[7]
                w[_COLUMN + 8 * LANES + lane] = z[8]
                w[_COLUMN + 9 * LANES + lane] = z[9]
            for j in range(_WIDTH - _HALF):
                w[o + j] = w[_COLUMN + first + j]


@kernel
def _begin(h, w):
    """Set the step, and the columns to those of the identity except that of psi_1."""
    w[_STEP:_COLUMN] = h
    w[_TANGENTS:_BLOCK] = 0.0
    column = 0
    for i in range(STATE):
        if i != ANCHOR:
            for lane in range(LANES):
                w[_TANGENTS + column * _WIDTH + i * LANES + lane] = 1.0
            column += 1


@kernel
def _revolve(constants, start, h, steps, end, work):
    c, w, step_size, tangents, rates, one = work
    y, new = w[_Y : _Y + _WHOLE], w[_NEW : _NEW + _WHOLE]
    one[:] = 1.0
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        load(start, first, y)
        _begin(step_size, tangents)
        for _ in range(steps):
            for stage in range(STAGES):
                k = w[_K + stage * _WHOLE : _K + (stage + 1) * _WHOLE]
                jacobian = tangents[stage * _JACOBIAN : (stage + 1) * _JACOBIAN]
                _linearise(c, step_size, y if stage == 0 else new, k, jacobian)
                _combine(stage + 1, w)
            y[:] = new
            _carry(tangents)
        slopes(c, one, y, rates)
        for n in range(first, min(first + LANES, start.shape[0])):
            lane = n - first
            for i in range(STATE):
                end[n, i, 0] = y[i * LANES + lane]
                for column in range(COLUMNS):
                    end[n, i, 1 + column] = tangents[_TANGENTS + column * _WIDTH + i * LANES + lane]
                end[n, i, 1 + COLUMNS] = rates[i * LANES + lane]


def revolve(constants: Array, start: Array, period: Array, steps: int) -> Array:
    """Return the states of n machines after a period, with derivatives by the start and by time.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    start : ndarray, shape (n, 10)
    period : ndarray, shape (n,)
        [s]
    steps : int
        In the period.

    Returns
    -------
    ndarray, shape (n, 10, 11)
        By columns: the state, its derivatives with respect to the components of the start except
        psi_1, and its rates.
    """
    end = np.empty((len(start), STATE, 2 + COLUMNS))
    work = (
        aligned(CONSTANTS * LANES),
        aligned(_SIZE),
        aligned(LANES),
        aligned(_BLOCK),
        aligned(STATE * LANES),
        aligned(LANES),
    )
    _revolve(constants, start, (period / steps)[:, None], steps, end, work)
    return end


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
    out[:, :, FREE] = revolve(machines.constants, state, period, steps)[:, :, 1:-1]
    return out
