"""Synchronous running of the rigid machine as a periodic orbit, by Newton's method.

The machine is autonomous, so the period T is an unknown and psi_1 = 0 anchors the start of the
revolution: the other nine components of the state and T are such that after T the body is where it
was and both vibrators have turned once. The derivatives of the end with respect to the start also
give the Floquet multipliers. They cost several times the motion itself, and only the last ones must
be accurate: to come close, derivatives from a third as many steps suffice, kept between iterations.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES, aligned, layout
from models.numerics.jit import kernel
from models.numerics.linear import product, solve
from models.numerics.tsit5 import STAGES, combiner
from models.vibrator.lanes.multiplier import largest_multiplier
from models.vibrator.lanes.packed import CONSTANTS, STATE, Array, load, slopes, store
from models.vibrator.lanes.tangents import FREE, revolve

ITERATIONS = 10
_CLOSE = 1e-6  # of a revolution: after a step this small only rounding errors are left
_BOLDEST = 0.5  # longest step of psi_2 [rad]

# While the derivatives are kept, convergence is only linear.
_NEAR = 0.05  # longest first step made with coarse derivatives
_SHRINKING = 0.25  # factor per step; slower convergence is given up
_CHORDS = 8
_CLOSE_ENOUGH = 1e-7  # for one step with accurate derivatives to leave only rounding errors

_TURN = np.where(np.isin(np.arange(STATE), (3, 4)), 2 * np.pi, 0.0)
_combine = combiner(STATE)
_Y, _NEW, _K, _SIZE = layout(STATE, STAGES)
_WHOLE = STATE * LANES
_K_2, _K_3, _K_4, _K_5, _K_6 = (_K + i * _WHOLE for i in range(1, 6))


class Orbits(NamedTuple):
    """Periodic orbits of n machines.

    Attributes
    ----------
    found : ndarray of bool, shape (n,)
        The other fields are meaningless where False.
    state : ndarray, shape (n, 10)
        At psi_1 = 0.
    period : ndarray, shape (n,)
        [s]
    multiplier : ndarray, shape (n,)
        Largest modulus of the Floquet multipliers except the trivial 1.
    """

    found: NDArray[np.bool_]
    state: Array
    period: Array
    multiplier: Array


@kernel
def _follow(constants, start, h, each, trace, work):
    """Set `trace`, shape (n, samples, 10), to the states after every `each` steps."""
    c, w, step_size = work
    y, new = w[_Y : _Y + _WHOLE], w[_NEW : _NEW + _WHOLE]
    k_1, k_2, k_3 = w[_K : _K + _WHOLE], w[_K_2 : _K_2 + _WHOLE], w[_K_3 : _K_3 + _WHOLE]
    k_4, k_5, k_6 = w[_K_4 : _K_4 + _WHOLE], w[_K_5 : _K_5 + _WHOLE], w[_K_6 : _K_6 + _WHOLE]
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        load(start, first, y)
        for sample in range(trace.shape[1]):
            for _ in range(each):
                slopes(c, step_size, y, k_1)
                _combine(1, w)
                slopes(c, step_size, new, k_2)
                _combine(2, w)
                slopes(c, step_size, new, k_3)
                _combine(3, w)
                slopes(c, step_size, new, k_4)
                _combine(4, w)
                slopes(c, step_size, new, k_5)
                _combine(5, w)
                slopes(c, step_size, new, k_6)
                _combine(6, w)
                y[:] = new
            store(y, first, trace[:, sample])


def _sampled(constants: Array, state: Array, period: Array, samples: int, each: int) -> Array:
    """Return the states over a period at equal times, `each` steps apart."""
    trace = np.empty((len(state), samples, STATE))
    work = aligned(CONSTANTS * LANES), aligned(_SIZE), aligned(LANES)
    _follow(constants, state, (period / (samples * each))[:, None], each, trace, work)
    return trace


def follow(constants: Array, state: Array, period: Array, steps: int) -> Array:
    """Return the states of n machines at equal steps through one period.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    state : ndarray, shape (n, 10)
    period : ndarray, shape (n,)
        [s]
    steps : int

    Returns
    -------
    ndarray, shape (n, steps, 10)
        The last one a period after `state`.
    """
    return _sampled(constants, state, period, steps, 1)


def find_orbits(constants: Array, state: Array, period: Array, steps: int) -> Orbits:
    """Find the periodic orbits of n machines near a guess.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
        See `models.vibrator.lanes.packed.pack`.
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
    _approach(constants, out.state, out.period, steps)
    left = np.arange(n)
    for _ in range(ITERATIONS):
        start, time = out.state[left], out.period[left]
        end = revolve(constants[left], start, time, steps)
        sound = _is_sound(end)
        left, start, time, end = left[sound], start[sound], time[sound], end[sound]
        if not len(left):
            break
        step, regular = solve(_matrix(end), _miss(start, end[:, :, 0]))
        size = _size(step, time)
        step *= np.minimum(1.0, _BOLDEST / np.maximum(size, 1e-300))[:, None, None]
        out.state[left[:, None], FREE] += step[:, :-1, 0]
        out.period[left] += step[:, -1, 0]
        # The next error of Newton's method is of the order of this step squared.
        done = regular & (size < _CLOSE) & (out.period[left] > 0)
        out.found[left[done]] = True
        out.multiplier[left[done]] = largest_multiplier(end[done])
        left = left[regular & ~done & (out.period[left] > 0.2 * period[left])]
        if not len(left):
            break
    return out


def _approach(constants: Array, state: Array, period: Array, steps: int) -> None:
    """Improve guesses near an orbit in place; leave the others unchanged.

    The derivatives are those at the guess, with a third of the steps: convergence is linear, and
    where it is slow the guess was not near an orbit.
    """
    end = revolve(constants, state, period, max(steps // 3, 1))
    inverse, regular = solve(_matrix(end), np.tile(np.eye(STATE), (len(state), 1, 1)))
    rows = np.flatnonzero(regular & _is_sound(end))
    c, start, time, inverse = constants[rows], state[rows], period[rows], inverse[rows]
    arrived, last = end[rows, :, 0], np.full(len(rows), _NEAR / _SHRINKING)
    for _ in range(1 + _CHORDS):
        step = product(inverse, _miss(start, arrived))
        size = _size(step, time) + np.abs(step[:, 7:9, 0]).sum(axis=1) * time / (2 * np.pi)
        start[:, FREE] += step[:, :-1, 0]
        time += step[:, -1, 0]
        going = (size < _SHRINKING * last) & (time > 0)
        close = going & (size < _CLOSE_ENOUGH)
        state[rows[close]], period[rows[close]] = start[close], time[close]
        going &= ~close
        if not going.any():
            break
        if not going.all():
            rows, c, inverse = rows[going], c[going], inverse[going]
            start, time, size = start[going], time[going], size[going]
        last = size
        arrived = _sampled(c, start, time, 1, steps)[:, 0]


def _is_sound(end: Array) -> NDArray[np.bool_]:
    """Return which motions and derivatives are finite and within bounds."""
    return np.abs(end).max(axis=(1, 2)) < 1e12


def _miss(start: Array, end: Array) -> Array:
    """Return the start plus one turn less the end, as columns."""
    return (start + _TURN - end)[:, :, None]


def _matrix(end: Array) -> Array:
    """Return the derivatives of end less start with respect to nine components and the period."""
    matrix = end[:, :, 1:].copy()
    matrix[:, FREE, np.arange(len(FREE))] -= 1
    return matrix


def _size(step: Array, period: Array) -> Array:
    """Return the lengths of steps: that in psi_2 [rad] plus the relative one in the period."""
    return np.abs(step[:, 3, 0]) + np.abs(step[:, -1, 0]) / period
