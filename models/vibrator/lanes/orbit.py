"""Synchronous running of the rigid machine as a periodic orbit, by Newton's method.

The machine is autonomous, so the period T is an unknown and psi_1 = 0 anchors the start of the
revolution: the other nine components of the state and T are such that after T the body is where it
was and both vibrators have turned once. Without gravity, the equations are the same for the
opposite displacement of the body and vibrators turned by pi, so after T/2 the motion is its own
mirror image: half a turn is enough. An orbit without this symmetry, and one whose body turns so
fast that a bearing loss may change its sign, is sought in a whole turn.

The derivatives of the end with respect to the start also give the Floquet multipliers. They cost
several times the motion itself, and only the last ones must be accurate: to come close, derivatives
from a third as many steps suffice, kept between iterations. How far they move the orbit shows how
accurate it is: by the order of the method, its own error is 3^5 - 1 times smaller.

All that a block of lanes needs is allocated once and stays in the cache.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel, spliced
from models.numerics.linear import invert
from models.vibrator.equations.rigid import Rigid
from models.vibrator.lanes.chords import (
    CLOSE_ENOUGH,
    angle_and_period,
    approach,
    length,
    move,
    multiply,
    take,
)
from models.vibrator.lanes.following import disphasing
from models.vibrator.lanes.multiplier import largest_multiplier
from models.vibrator.lanes.multiplier import rooms as rooms_of_multiplier
from models.vibrator.lanes.packed import CONSTANTS, HALF, STATE, WHOLE, Array, Part, gather
from models.vibrator.lanes.tangents import ANCHOR, COLUMNS, ENTRIES, ROOMS, differentiate

ITERATIONS = 10
_COARSER = 3  # factor by which fewer steps suffice for derivatives to come close
_ORDER = 5  # of the steps
_CLOSE = 1e-6  # of a revolution: after a step this small only rounding errors are left
_BOUND = 1e12  # of motion and derivatives
_BOLDEST = 0.5  # longest step of psi_2 [rad]
_SHORTEST = 0.2  # period over that of the guess
_GRAVITY = Rigid._fields.index("gravity")
_QUIET = 0.5  # angular velocity of the body over that of the vibrators: bearing losses keep sign


class Orbits(NamedTuple):
    """Periodic orbits of n machines.

    Attributes
    ----------
    converged : ndarray of bool, shape (n,)
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

    converged: NDArray[np.bool_]
    state: Array
    period: Array
    multiplier: Array
    angle: Array
    ripple: Array
    error: Array


def _rooms() -> Any:
    """Return the arrays in which `_search` works."""
    sizes = (CONSTANTS, STATE, 1, STATE * ENTRIES, STATE * STATE, STATE, STATE, STATE)
    small = np.zeros((1, STATE, STATE)), np.zeros((1, STATE, STATE)), np.zeros((STATE, LANES))
    return (
        tuple(aligned(size * LANES) for size in sizes),
        tuple(aligned(size) for size in ROOMS),
        tuple(aligned(7 * LANES).reshape(7, -1)),
        tuple(np.zeros((3, LANES), bool)),
        (*small, np.zeros(STATE, np.int64)),
        rooms_of_multiplier(),
    )


@spliced
def _replace_inverses(end, kept, inverse, room):
    """Invert the derivatives of end less start by nine components and time, in lanes not kept."""
    matrix, inverted, rows, pivots = room
    for lane in range(LANES):
        if not kept[lane]:
            for i in range(STATE):
                for j in range(STATE):
                    matrix[0, i, j] = end[(i * ENTRIES + 1 + j) * LANES + lane]
            for j in range(COLUMNS):
                matrix[0, j if j < ANCHOR else j + 1, j] -= 1.0
            invert(matrix, inverted, rows, pivots)
            for i in range(STATE):
                for j in range(STATE):
                    inverse[(i * STATE + j) * LANES + lane] = inverted[0, i, j]


@kernel
def _restore(table, rows, kept, out):
    """Load rows again into lanes that are not kept."""
    last = len(rows) - 1
    for lane in range(LANES):
        if not kept[lane]:
            for i in range(table.shape[1]):
                out[i * LANES + lane] = table[rows[min(lane, last)], i]


@kernel
def _subtract(a, image, spread, out):
    """Set `out` to states less images, whose components are so many lanes apart."""
    for i in range(STATE):
        for lane in range(LANES):
            out[i * LANES + lane] = a[i * LANES + lane] - image[i * spread * LANES + lane]


@kernel
def _judge(end, step, time, close, done, going, total):
    """Find which orbits are found by taking these steps, and which are to be sought further.

    Returns how many are found.
    """
    ready = 0
    total[:] = 0.0
    for i in range(STATE * ENTRIES):
        for lane in range(LANES):
            total[lane] += abs(end[i * LANES + lane])
    for lane in range(LANES):
        whole = 0.0
        for i in range(STATE):
            whole += abs(step[i * LANES + lane])
        regular = total[lane] < _BOUND and whole < np.inf
        # The next error of Newton's method is of the order of this step squared.
        near = angle_and_period(step, time, lane) < (CLOSE_ENOUGH if close[lane] else _CLOSE)
        done[lane], going[lane] = regular and near, regular and not near
        ready += 1 if done[lane] else 0
    return ready


@kernel
def _search(constants, state, time, rows, steps, mirror, turn, out, shortest, room):
    """Find orbits in some rows, or parts of orbits that repeat.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    state : ndarray, shape (n, 10)
        Guesses at psi_1 = 0, replaced by the orbits.
    time : ndarray, shape (n, 1)
        Of the part [s]; likewise.
    rows : ndarray of int
        Indices of the rows; overwritten.
    steps : int
        In the part.
    mirror, turn
        See `models.vibrator.lanes.packed.Part`.
    out : tuple of ndarray, shape (n,)
        Set in these rows, where an orbit is found: that it is, the largest multiplier of the part,
        the mean disphasing angle [rad], the largest deviation from it [rad], and an estimate of
        the error of the angle by the length of the steps [rad].
    shortest : ndarray, shape (n,)
        Times below which an orbit is given up [s].
    room : tuple
        What `_rooms` returns.
    """
    converged, multiplier, angle, ripple, error = out
    (c, at, t, end, inverse, miss, step, shift), motion, numbers, flags, small, more = room
    (w, h, _, back), (close, done, going) = motion, flags
    last, low, high, mean, deviation, radius, off = numbers
    coarse, count = max(steps // _COARSER, 1), len(rows)
    gain = (steps / coarse) ** _ORDER - 1.0
    for attempt in range(ITERATIONS):
        left = 0
        for first in range(0, count, LANES):
            block = rows[first : min(first + LANES, count)]
            gather(constants, block, c)
            gather(state, block, at)
            gather(time, block, t)
            close[:] = False
            for fine in range(0 if attempt == 0 else 1, 2):
                number = steps if fine else coarse
                differentiate(c, at, t, number, mirror, turn, end, motion)
                _replace_inverses(end, close, inverse, small)
                if not fine:
                    room_of_chords = w, h, back, miss, step, last
                    approach(c, at, t, end, inverse, steps, mirror, turn, close, room_of_chords)
                    _restore(state, block, close, at)
                    _restore(time, block, close, t)
            _subtract(at, end, ENTRIES, miss)
            multiply(inverse, miss, step)
            ready = _judge(end, step, t, close, done, going, off)
            if ready > 0:
                move(c, at, t, coarse, mirror, turn, back, (w, h))
                _subtract(back, end, ENTRIES, miss)
                multiply(inverse, miss, shift)
            for lane in range(LANES):
                off[lane] = length(shift, t, turn, lane) / gain
                size = angle_and_period(step, t, lane)
                take(step, min(1.0, _BOLDEST / max(size, 1e-300)), at, t, lane)
            if ready > 0:
                largest_multiplier(end, done, radius, more)
                disphasing(c, at, t, steps, mean, deviation, (w, h, low, high))
            for lane in range(len(block)):
                n = block[lane]
                time[n, 0] = t[lane]
                for i in range(STATE):
                    state[n, i] = at[i * LANES + lane]
                if done[lane] and t[lane] > 0.0:
                    converged[n], multiplier[n], angle[n] = True, radius[lane], mean[lane]
                    ripple[n], error[n] = deviation[lane], off[lane]
                elif going[lane] and t[lane] > shortest[n]:
                    rows[left] = n
                    left += 1
        count = left
        if count == 0:
            break


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
    _find(constants, out, np.flatnonzero(constants[:, _GRAVITY] == 0), steps, HALF)
    speed = 2 * np.pi / out.period
    spin = np.hypot(out.state[:, 7], out.state[:, 2] * speed)
    rest = np.flatnonzero(~(out.converged & (spin < _QUIET * speed)))
    if len(rest):
        out.converged[rest], out.state[rest], out.period[rest] = False, state[rest], period[rest]
        _find(constants, out, rest, steps, WHOLE)
    return out


def _find(constants: Array, out: Orbits, rows: NDArray[np.intp], steps: int, part: Part) -> None:
    """Replace guesses in some rows by orbits that consist of equal parts."""
    time = out.period[:, None] / part.parts
    _search(
        constants,
        out.state,
        time,
        rows.copy(),
        -(-steps // part.parts),
        part.mirror,
        part.turn,
        (out.converged, out.multiplier, out.angle, out.ripple, out.error),
        _SHORTEST * time[:, 0],
        _rooms(),
    )
    out.period[rows] = part.parts * time[rows, 0]
    out.multiplier[rows] **= part.parts
