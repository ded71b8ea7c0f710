"""Synchronous running of the rigid machine as a periodic orbit, by Newton's method.

The machine is autonomous, so the period T is an unknown and psi_1 = 0 anchors the start of the
revolution: the other nine components of the state and T are such that after T the body is where it
was and both vibrators have turned once. The equations are the same for the opposite displacement of
the body and vibrators turned by pi, so after T/2 the motion is its own mirror image: half a turn is
enough. An orbit without this symmetry, and one whose body turns so fast that a bearing loss may
change its sign, is sought in a whole turn.

The derivatives of the end with respect to the start also give the Floquet multipliers. They cost
several times the motion itself, and only the last ones must be accurate: to come close, derivatives
from a third as many steps suffice, kept between iterations. How far they move the orbit shows how
accurate it is: by the order of the method, its own error is 3^5 - 1 times smaller.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.lanes import newton
from models.vibrator.lanes.packed import HALF, WHOLE, Array, Part

_SHORTEST = 0.2  # period over that of the guess
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
    error : ndarray, shape (n,)
        Estimated error of the angle by the length of the steps [rad].
    """

    found: NDArray[np.bool_]
    state: Array
    period: Array
    multiplier: Array
    angle: Array
    ripple: Array
    error: Array


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
    out = Orbits(np.zeros(n, bool), state.copy(), period.copy(), *np.full((4, n), np.nan))
    _find(constants, out, np.arange(n), steps, HALF)
    speed = 2 * np.pi / out.period
    spin = np.hypot(out.state[:, 7], out.state[:, 2] * speed)
    rest = np.flatnonzero(~(out.found & (spin < _QUIET * speed)))
    if len(rest):
        out.found[rest], out.state[rest], out.period[rest] = False, state[rest], period[rest]
        _find(constants, out, rest, steps, WHOLE)
    return out


def _find(constants: Array, out: Orbits, rows: NDArray[np.intp], steps: int, part: Part) -> None:
    """Replace guesses in some rows by orbits that consist of equal parts."""
    time = out.period[:, None] / part.parts
    newton.search(
        constants,
        out.state,
        time,
        rows.copy(),
        -(-steps // part.parts),
        part.mirror,
        part.turn,
        (out.found, out.multiplier, out.angle, out.ripple, out.error),
        _SHORTEST * time[:, 0],
        newton.rooms(),
    )
    out.period[rows] = part.parts * time[rows, 0]
    out.multiplier[rows] **= part.parts
