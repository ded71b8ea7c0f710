"""Newton's method with derivatives that are kept, sixteen machines at a time.

Convergence is linear, but an iteration costs only the motion itself.
"""

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES, aligned, copy
from models.numerics.fma import fma
from models.numerics.jit import kernel
from models.vibrator.lanes.packed import CONSTANTS, STATE, Array, Part, load, turn_back
from models.vibrator.lanes.steps import AT, SIZE, prepare, step_5
from models.vibrator.lanes.tangents import ANCHOR

_NEAR = 0.05  # longest first step
_SHRINKING = 0.25  # factor per step; slower convergence is given up
_CHORDS = 8
CLOSE_ENOUGH = 1e-8  # the error that one more step leaves is less than a tenth of this
_WHOLE = STATE * LANES


@kernel
def _solve(inverse, miss, step):
    """Set the steps of all lanes to the products of inverse and miss."""
    for i in range(STATE):
        o = i * _WHOLE
        for lane in range(LANES):
            total = inverse[o + lane] * miss[lane]
            for j in range(1, STATE):
                total = fma(inverse[o + j * LANES + lane], miss[j * LANES + lane], total)
            step[i * LANES + lane] = total


@kernel
def _take(step, at, time, last, turn):
    """Take the step of each lane that is still going; return how many go on.

    `last` holds the length of the last step, 0 once close, and NaN once given up.
    """
    some = 0
    for lane in range(LANES):
        if last[lane] > 0.0:
            j = lane
            for i in range(STATE):
                if i != ANCHOR:
                    at[i * LANES + lane] += step[j]
                    j += LANES
            time[lane] += step[j]
            # In psi_2 [rad], in the period and, per turn, in the speeds.
            speeds = abs(step[7 * LANES + lane]) + abs(step[8 * LANES + lane])
            size = abs(step[3 * LANES + lane]) + abs(step[j]) / time[lane]
            size += speeds * time[lane] / turn
            if size < _SHRINKING * last[lane] and time[lane] > 0.0:
                last[lane] = size if size >= CLOSE_ENOUGH else 0.0
            else:
                last[lane] = np.nan
            some += 1 if last[lane] > 0.0 else 0
    return some


@kernel
def _approach(constants, state, time, guess, image, inverse, steps, mirror, turn, close, work):
    c, w, h, at, t, back, factors, miss, step, last = work
    y = w[AT.position : AT.position + _WHOLE]
    for first in range(0, state.shape[0], LANES):
        load(constants, first, c)
        load(state, first, at)
        load(guess, first, t)
        load(image, first, back)
        load(inverse, first, factors)
        last[:] = _NEAR / _SHRINKING
        for _ in range(_CHORDS + 1):
            for j in range(_WHOLE):
                miss[j] = at[j] - back[j]
            _solve(factors, miss, step)
            if _take(step, at, t, last, turn) == 0:
                break
            for lane in range(LANES):
                h[lane] = t[lane] / steps
            prepare(c, h, w)
            copy(at, y)
            for _ in range(steps):
                step_5(w)
            turn_back(y, mirror, turn, back)
        for n in range(first, min(first + LANES, state.shape[0])):
            close[n] = last[n - first] == 0.0
            if close[n]:
                time[n] = t[n - first]
                for i in range(STATE):
                    state[n, i] = at[i * LANES + n - first]


def approach(
    constants: Array,
    state: Array,
    time: Array,
    image: Array,
    inverse: Array,
    steps: int,
    part: Part,
) -> NDArray[np.bool_]:
    """Improve guesses near an orbit in place; leave the others unchanged.

    Where convergence is slow, the guess was not near an orbit.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    state : ndarray, shape (n, 10)
        Guess, at psi_1 = 0.
    time : ndarray, shape (n,)
        Guess of the time after which the motion returns [s].
    image : ndarray, shape (n, 10)
        To where it returns.
    inverse : ndarray, shape (n, 10, 10)
        Of the derivatives of image less start.
    steps : int
        In that time.
    part : Part
        Of a revolution.

    Returns
    -------
    ndarray of bool, shape (n,)
        Where the guess has been improved.
    """
    n = len(state)
    close = np.empty(n, bool)
    work = (
        aligned(CONSTANTS * LANES),
        aligned(SIZE),
        aligned(LANES),
        aligned(_WHOLE),
        aligned(LANES),
        aligned(_WHOLE),
        aligned(STATE * _WHOLE),
        aligned(_WHOLE),
        aligned(_WHOLE),
        aligned(LANES),
    )
    factors, guess = inverse.reshape(n, STATE * STATE), time[:, None].copy()
    mirror, turn = part.mirror, part.turn
    _approach(constants, state, time, guess, image, factors, steps, mirror, turn, close, work)
    return close
