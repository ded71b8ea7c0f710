"""Newton's method with derivatives that are kept, sixteen machines at a time.

Convergence is linear, but an iteration costs only the motion itself.
"""

import numpy as np

from models.numerics.blocks import LANES, copy
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel, spliced
from models.vibrator.lanes.packed import STATE, turn_back
from models.vibrator.lanes.steps import AT, prepare, step_5
from models.vibrator.lanes.tangents import ANCHOR, ENTRIES

_NEAR = 0.05  # longest first step
_SHRINKING = 0.25  # factor per step; slower convergence is given up
_CHORDS = 8
CLOSE_ENOUGH = 1e-8  # the error that one more step leaves is less than a tenth of this
_WHOLE = STATE * LANES
_PSI_2, _W_1, _W_2, _PERIOD = (i * LANES for i in (3, 7, 8, 9))  # in a step, which lacks psi_1


@kernel
def multiply(inverse, miss, step):
    """Set the steps of all lanes to the products of inverse and miss."""
    for i in range(STATE):
        o = i * _WHOLE
        for lane in range(LANES):
            total = inverse[o + lane] * miss[lane]
            for j in range(1, STATE):
                total = fma(inverse[o + j * LANES + lane], miss[j * LANES + lane], total)
            step[i * LANES + lane] = total


@inlined
def angle_and_period(step, time, lane):
    """Return the length of a step: in psi_2 [rad] plus, relative, in the period."""
    return abs(step[_PSI_2 + lane]) + abs(step[_PERIOD + lane]) / time[lane]


@inlined
def length(step, time, turn, lane):
    """Return the length of a step: in psi_2 [rad], in the period and, per turn, in the speeds."""
    speeds = abs(step[_W_1 + lane]) + abs(step[_W_2 + lane])
    return angle_and_period(step, time, lane) + speeds * time[lane] / turn


@inlined
def take(step, factor, at, time, lane):
    """Add a multiple of a step to the state and the time of one lane."""
    j = lane
    for i in range(STATE):
        if i != ANCHOR:
            at[i * LANES + lane] = fma(factor, step[j], at[i * LANES + lane])
            j += LANES
    time[lane] = fma(factor, step[j], time[lane])


@spliced
def move(c, at, time, steps, mirror, turn, image, work):
    """Set `image` to where all lanes return after a part of a revolution."""
    w, h = work
    y = w[AT.position : AT.position + _WHOLE]
    for lane in range(LANES):
        h[lane] = time[lane] / steps
    prepare(c, h, w)
    copy(at, y)
    for _ in range(steps):
        step_5(w)
    turn_back(y, mirror, turn, image)


@kernel
def _advance(step, at, time, last, turn):
    """Take the step of each lane that is still going; return the number that continue.

    `last` holds the length of the last step, 0 once close, and NaN once given up.
    """
    active = 0
    for lane in range(LANES):
        if last[lane] > 0.0:
            take(step, 1.0, at, time, lane)
            size = length(step, time, turn, lane)
            if size < _SHRINKING * last[lane] and time[lane] > 0.0:
                last[lane] = size if size >= CLOSE_ENOUGH else 0.0
            else:
                last[lane] = np.nan
            active += 1 if last[lane] > 0.0 else 0
    return active


@spliced
def approach(c, at, time, end, inverse, steps, mirror, turn, close, work):
    """Improve guesses near an orbit.

    Where convergence is slow, the guess was not near an orbit.

    Parameters
    ----------
    c : ndarray
        Constants of the machines, in lanes.
    at : ndarray, shape (STATE * LANES,)
        Guess, at psi_1 = 0; updated in place.
    time : ndarray, shape (LANES,)
        Guess of the time after which the motion returns [s]; updated in place.
    end : ndarray, shape (STATE * ENTRIES * LANES,)
        Where the guess returns, as `models.vibrator.lanes.tangents.differentiate` sets it.
    inverse : ndarray, shape (STATE * STATE * LANES,)
        Of the derivatives of end less start.
    steps : int
        In that time.
    mirror, turn
        See `models.vibrator.lanes.packed.Part`.
    close : ndarray of bool, shape (LANES,)
        Set to where the guess has been improved; elsewhere it is spoilt.
    work : tuple of ndarray
        Rooms for motion, steps, ends, misses, steps of the state, and their lengths.
    """
    w, h, back, miss, step, last = work
    for i in range(STATE):
        for lane in range(LANES):
            back[i * LANES + lane] = end[i * ENTRIES * LANES + lane]
    last[:] = _NEAR / _SHRINKING
    for _ in range(_CHORDS + 1):
        for j in range(_WHOLE):
            miss[j] = at[j] - back[j]
        multiply(inverse, miss, step)
        if _advance(step, at, time, last, turn) == 0:
            break
        move(c, at, time, steps, mirror, turn, back, (w, h))
    for lane in range(LANES):
        close[lane] = last[lane] == 0.0
