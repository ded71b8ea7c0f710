"""Synchronous running of the rigid machine as a periodic orbit, by Newton's method.

The machine is autonomous, so the period T is an unknown and psi_1 = 0 anchors the start of the
revolution: the other nine components of the state and T are such that after T the body is where it
was and both vibrators have turned once. The equations are the same for the opposite displacement of
the body and vibrators turned by pi, so after T/2 the motion is its own mirror image: half a turn is
enough. An orbit without this symmetry, and one whose body turns so fast that a bearing loss may
change its sign, is sought in a whole turn.

The derivatives of the end with respect to the start also give the Floquet multipliers. They cost
several times the motion itself, and only the last ones must be accurate: to come close, derivatives
from a third as many steps suffice, kept between iterations.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.linear import inverse, product, solve
from models.vibrator.lanes.chords import CLOSE_ENOUGH, approach
from models.vibrator.lanes.following import disphasing
from models.vibrator.lanes.multiplier import largest_multiplier
from models.vibrator.lanes.packed import HALF, WHOLE, Array, Part
from models.vibrator.lanes.tangents import FREE, revolve

ITERATIONS = 10
_CLOSE = 1e-6  # of a revolution: after a step this small only rounding errors are left
_BOUND = 1e12  # of motion and derivatives
_BOLDEST = 0.5  # longest step of psi_2 [rad]

_QUIET = 0.5  # angular velocity of the body over that of the vibrators: bearing losses keep sign


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
    angle, ripple : ndarray, shape (n,)
        Mean disphasing angle, not wrapped, and the largest deviation from it [rad].
    """

    found: NDArray[np.bool_]
    state: Array
    period: Array
    multiplier: Array
    angle: Array
    ripple: Array


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
    out = _find(constants, state, period, steps, HALF)
    speed = 2 * np.pi / out.period
    spin = np.hypot(out.state[:, 7], out.state[:, 2] * speed)
    rest = np.flatnonzero(~(out.found & (spin < _QUIET * speed)))
    if len(rest):
        whole = _find(constants[rest], state[rest], period[rest], steps, WHOLE)
        for field, found in zip(out, whole, strict=True):
            field[rest] = found
    return out


def _find(constants: Array, state: Array, period: Array, steps: int, part: Part) -> Orbits:
    """Find orbits that consist of equal parts."""
    n, steps = len(state), -(-steps // part.parts)
    out = Orbits(np.zeros(n, bool), state.copy(), period / part.parts, *np.full((3, n), np.nan))
    shortest = 0.2 * out.period
    kept, close = _approach(constants, out, steps, part)
    left = np.arange(n)
    for _ in range(ITERATIONS):
        start, time = out.state[left], out.period[left]
        end = revolve(constants[left], start, time, steps, part)
        sound = _is_sound(end)
        left, start, time, end = left[sound], start[sound], time[sound], end[sound]
        if not len(left):
            break
        step, regular = _steps(start, end, kept, close, left)
        size = _size(step, time)
        step *= np.minimum(1.0, _BOLDEST / np.maximum(size, 1e-300))[:, None, None]
        out.state[left[:, None], FREE] += step[:, :-1, 0]
        out.period[left] += step[:, -1, 0]
        # The next error of Newton's method is of the order of this step squared.
        done = regular & (size < np.where(close[left], CLOSE_ENOUGH, _CLOSE))
        done &= out.period[left] > 0
        out.found[left[done]] = True
        out.multiplier[left[done]] = largest_multiplier(end[done]) ** part.parts
        close[left] = False
        left = left[regular & ~done & (out.period[left] > shortest[left])]
        if not len(left):
            break
    angle, ripple = disphasing(constants, out.state, out.period, steps)
    return out._replace(period=part.parts * out.period, angle=angle, ripple=ripple)


def _approach(
    constants: Array, out: Orbits, steps: int, part: Part
) -> tuple[Array, NDArray[np.bool_]]:
    """Improve guesses near an orbit; return the inverses used, and where they have served."""
    end = revolve(constants, out.state, out.period, max(steps // 3, 1), part)
    kept, regular = inverse(_matrix(end))
    kept[~(regular & _is_sound(end))] = np.nan
    image = end[:, :, 0]
    return kept, approach(constants, out.state, out.period, image, kept, steps, part)


def _steps(
    start: Array, end: Array, kept: Array, close: NDArray[np.bool_], rows: NDArray[np.intp]
) -> tuple[Array, NDArray[np.bool_]]:
    """Return Newton's steps, where the orbit is close with the derivatives kept."""
    miss = (start - end[:, :, 0])[:, :, None]
    step, regular = product(kept[rows], miss), np.ones(len(rows), bool)
    far = np.flatnonzero(~close[rows])
    if len(far):
        step[far], regular[far] = solve(_matrix(end[far]), miss[far])
    return step, regular


def _is_sound(end: Array) -> NDArray[np.bool_]:
    """Return which motions and derivatives are finite and within bounds."""
    return (end.max(axis=(1, 2)) < _BOUND) & (end.min(axis=(1, 2)) > -_BOUND)


def _matrix(end: Array) -> Array:
    """Return the derivatives of end less start with respect to nine components and the period."""
    matrix = end[:, :, 1:].copy()
    matrix[:, FREE, np.arange(len(FREE))] -= 1
    return matrix


def _size(step: Array, period: Array) -> Array:
    """Return the lengths of steps: that in psi_2 [rad] plus the relative one in the period."""
    return np.abs(step[:, 3, 0]) + np.abs(step[:, -1, 0]) / period
