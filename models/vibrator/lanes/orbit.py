"""Synchronous running of the rigid machine as a periodic orbit, by Newton's method.

The machine is autonomous, so the period T is an unknown and psi_1 = 0 anchors the start of the
revolution: the other nine components of the state and T are such that after T the body is where it
was and both vibrators have turned once. Half a turn reverses every force on the body and leaves the
torques of reversed motion as they were: after T/2 the vibrators have turned by pi and the body is at
the opposite displacement, so half the motion is enough. Only an orbit without this symmetry, or one
whose body turns as fast as the vibrators, is sought in a whole turn.

The derivatives of the end with respect to the start also give the Floquet multipliers. They cost
several times the motion itself, and only the last ones must be accurate: to come close, derivatives
from a third as many steps suffice, kept between iterations.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.linear import product, solve
from models.vibrator.lanes.following import follow
from models.vibrator.lanes.multiplier import largest_multiplier
from models.vibrator.lanes.packed import STATE, Array
from models.vibrator.lanes.tangents import FREE, revolve

ITERATIONS = 10
_CLOSE = 1e-6  # of a revolution: after a step this small only rounding errors are left
_BOLDEST = 0.5  # longest step of psi_2 [rad]

# While the derivatives are kept, convergence is only linear.
_NEAR = 0.05  # longest first step made with coarse derivatives
_SHRINKING = 0.25  # factor per step; slower convergence is given up
_CHORDS = 8
_CLOSE_ENOUGH = 1e-7  # for one step with accurate derivatives to leave only rounding errors

_QUIET = 0.5  # angular velocity of the body over that of vibrator 1, below which it is no faster
_TURN = np.where(np.isin(np.arange(STATE), (3, 4)), 2 * np.pi, 0.0)
_MIRROR = np.where(np.isin(np.arange(STATE), (0, 1, 2, 5, 6, 7)), -1.0, 1.0)  # half a turn later


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
    out = _find(constants, state, period, steps, 2)
    speed = 2 * np.pi / out.period
    spin = np.hypot(out.state[:, 7], out.state[:, 2] * speed)
    rest = np.flatnonzero(~(out.found & (spin < _QUIET * speed)))
    if len(rest):
        whole = _find(constants[rest], state[rest], period[rest], steps, 1)
        for field, found in zip(out, whole, strict=True):
            field[rest] = found
    return out


def _find(constants: Array, state: Array, period: Array, steps: int, parts: int) -> Orbits:
    """Find orbits that consist of one or two equal parts."""
    n, steps = len(state), -(-steps // parts)
    out = Orbits(np.zeros(n, bool), state.copy(), period / parts, np.full(n, np.nan))
    shortest = 0.2 * out.period
    _approach(constants, out.state, out.period, steps, parts)
    left = np.arange(n)
    for _ in range(ITERATIONS):
        start, time = out.state[left], out.period[left]
        end = _returned(revolve(constants[left], start, time, steps), parts)
        sound = _is_sound(end)
        left, start, time, end = left[sound], start[sound], time[sound], end[sound]
        if not len(left):
            break
        step, regular = solve(_matrix(end), (start - end[:, :, 0])[:, :, None])
        size = _size(step, time)
        step *= np.minimum(1.0, _BOLDEST / np.maximum(size, 1e-300))[:, None, None]
        out.state[left[:, None], FREE] += step[:, :-1, 0]
        out.period[left] += step[:, -1, 0]
        # The next error of Newton's method is of the order of this step squared.
        done = regular & (size < _CLOSE) & (out.period[left] > 0)
        out.found[left[done]] = True
        out.multiplier[left[done]] = largest_multiplier(end[done]) ** parts
        left = left[regular & ~done & (out.period[left] > shortest[left])]
        if not len(left):
            break
    return out._replace(period=parts * out.period)


def _approach(constants: Array, state: Array, period: Array, steps: int, parts: int) -> None:
    """Improve guesses near an orbit in place; leave the others unchanged.

    The derivatives are those at the guess, with a third of the steps: convergence is linear, and
    where it is slow the guess was not near an orbit.
    """
    end = _returned(revolve(constants, state, period, max(steps // 3, 1)), parts)
    inverse, regular = solve(_matrix(end), np.tile(np.eye(STATE), (len(state), 1, 1)))
    rows = np.flatnonzero(regular & _is_sound(end))
    c, start, time, inverse = constants[rows], state[rows], period[rows], inverse[rows]
    arrived, last = end[rows, :, 0], np.full(len(rows), _NEAR / _SHRINKING)
    for _ in range(1 + _CHORDS):
        step = product(inverse, (start - arrived)[:, :, None])
        size = _size(step, time) + np.abs(step[:, 7:9, 0]).sum(axis=1) * time * parts / (2 * np.pi)
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
        arrived = _returned(follow(c, start, time, steps, steps)[:, 0, :, None], parts)[:, :, 0]


def _returned(end: Array, parts: int) -> Array:
    """Return states after a part, and their derivatives, turned back by it."""
    if parts == 2:
        end *= _MIRROR[:, None]
    end[:, :, 0] -= _TURN / parts
    return end


def _is_sound(end: Array) -> NDArray[np.bool_]:
    """Return which motions and derivatives are finite and within bounds."""
    return np.abs(end).max(axis=(1, 2)) < 1e12


def _matrix(end: Array) -> Array:
    """Return the derivatives of end less start with respect to nine components and the period."""
    matrix = end[:, :, 1:].copy()
    matrix[:, FREE, np.arange(len(FREE))] -= 1
    return matrix


def _size(step: Array, period: Array) -> Array:
    """Return the lengths of steps: that in psi_2 [rad] plus the relative one in the period."""
    return np.abs(step[:, 3, 0]) + np.abs(step[:, -1, 0]) / period
