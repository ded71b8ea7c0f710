"""Synchronous running as one would compute it with numba: shooting, one machine at a time.

Classical Runge-Kutta steps, derivatives by central differences, Newton's method.
"""

import numpy as np

from models.numerics.jit import kernel
from models.vibrator.equations.rigid_motion import DEGREES, acceleration
from models.vibrator.lanes.packed import machine

STATE = 2 * DEGREES
ANCHOR = 3  # psi_1
_ITERATIONS, _CLOSE, _NUDGE = 15, 1e-6, 1e-5


@kernel
def rates(t, y, c):
    """Return the rates of change of a state; `c` holds the constants as `lanes.machine` asks."""
    dy = np.empty(STATE)
    dy[:DEGREES] = y[DEGREES:]
    acceleration(machine(c, 0), y, dy[DEGREES:])
    return dy


@kernel
def _revolve(c, start, period, steps, end):
    """Set `end` to the state after a period; return the mean disphasing angle on the way."""
    h, angle = period / steps, 0.0
    end[:] = start
    stage, k, total = np.empty(STATE), np.empty(STATE), np.empty(STATE)
    for _ in range(steps):
        stage[:] = end
        for i in range(4):
            k[:DEGREES] = stage[DEGREES:]
            acceleration(machine(c, 0), stage, k[DEGREES:])
            reach = h if i == 2 else 0.5 * h
            weight = h / 6 if i == 0 or i == 3 else h / 3
            for j in range(STATE):
                total[j] = weight * k[j] + (0.0 if i == 0 else total[j])
                stage[j] = end[j] + reach * k[j]
        for j in range(STATE):
            end[j] += total[j]
        angle += end[ANCHOR] - end[ANCHOR + 1]
    return angle / steps


@kernel
def shoot(c, guess, period, scales, steps):
    """Return the mean disphasing angle on the periodic orbit near a guess, NaN if not found.

    Parameters
    ----------
    c : ndarray
        Constants, as `models.vibrator.lanes.packed.machine` asks, in the first lane.
    guess : ndarray, shape (10,)
        At psi_1 = 0.
    period : float
        Guess [s].
    scales : ndarray, shape (10,)
        Size of each component.
    steps : int
        In a revolution.

    Returns
    -------
    float
        [rad]
    """
    state = guess.copy()
    end, above, below = np.empty(STATE), np.empty(STATE), np.empty(STATE)
    matrix, column = np.empty((STATE, STATE)), 0
    for _ in range(_ITERATIONS):
        column = 0
        for i in range(STATE):
            if i != ANCHOR:
                nudge, kept = _NUDGE * scales[i], state[i]
                state[i] = kept + nudge
                _revolve(c, state, period, steps, above)
                state[i] = kept - nudge
                _revolve(c, state, period, steps, below)
                state[i] = kept
                matrix[:, column] = (above - below) / (2 * nudge)
                matrix[i, column] -= 1.0
                column += 1
        _revolve(c, state, period, steps, end)
        matrix[:, STATE - 1] = rates(0.0, end, c)
        miss = state - end
        miss[ANCHOR] += 2 * np.pi
        miss[ANCHOR + 1] += 2 * np.pi
        step = np.linalg.solve(matrix / scales.reshape(-1, 1), miss / scales)
        state[:ANCHOR] += step[:ANCHOR]
        state[ANCHOR + 1 :] += step[ANCHOR:-1]
        period += step[-1]
        if abs(step[ANCHOR]) + abs(step[-1]) / period < _CLOSE:
            return _revolve(c, state, period, steps, end)
    return np.nan
