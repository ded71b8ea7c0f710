"""The largest Floquet multiplier of periodic orbits, sixteen machines at a time.

By Gelfand's formula the spectral radius of A is the limit of |A^n|^(1/n). Each squaring doubles n,
and an error in the k-th squaring is weighted by 2^-k. Unlike an eigenvalue solver, this is
straight-line algebra.
"""

import numpy as np

from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.vibrator.lanes.packed import STATE, Array
from models.vibrator.lanes.tangents import ANCHOR, COLUMNS

_SQUARINGS = 40  # |A^n| may differ from radius^n by a factor c: an error of log(c)/2^40 is left
_WHOLE = COLUMNS * COLUMNS * LANES


@inlined
def _entry(w, o, row):
    """Return one entry of a row times the matrix at o."""
    first = fma(row[0], w[o], row[1] * w[o + COLUMNS * LANES])
    first = fma(row[2], w[o + 2 * COLUMNS * LANES], first)
    first = fma(row[3], w[o + 3 * COLUMNS * LANES], first)
    first = fma(row[4], w[o + 4 * COLUMNS * LANES], first)
    second = fma(row[5], w[o + 5 * COLUMNS * LANES], row[6] * w[o + 6 * COLUMNS * LANES])
    second += fma(row[7], w[o + 7 * COLUMNS * LANES], row[8] * w[o + 8 * COLUMNS * LANES])
    return first + second


@kernel
def _square(a, square, out, next_square):
    """Set `out` to the square of a over that of its norm, and find the squared norm of `out`."""
    for lane in range(LANES):
        next_square[lane] = 0.0
    for i in range(COLUMNS):
        o = i * COLUMNS * LANES
        for lane in range(LANES):
            scale = 1.0 / square[lane] if square[lane] > 0.0 else 0.0
            row = (
                scale * a[o + lane],
                scale * a[o + LANES + lane],
                scale * a[o + 2 * LANES + lane],
                scale * a[o + 3 * LANES + lane],
                scale * a[o + 4 * LANES + lane],
                scale * a[o + 5 * LANES + lane],
                scale * a[o + 6 * LANES + lane],
                scale * a[o + 7 * LANES + lane],
                scale * a[o + 8 * LANES + lane],
            )
            total = 0.0
            for j in range(COLUMNS):
                entry = _entry(a, j * LANES + lane, row)
                out[o + j * LANES + lane] = entry
                total = fma(entry, entry, total)
            next_square[lane] += total


@kernel
def _load(end, first, w, square):
    """Load the derivatives of revolutions into lanes; spare lanes repeat the last."""
    last = end.shape[0] - 1
    for lane in range(LANES):
        n = min(first + lane, last)
        total = 0.0
        for j in range(COLUMNS):
            late = end[n, ANCHOR, 1 + j] / end[n, ANCHOR, 1 + COLUMNS]
            row = 0
            for i in range(STATE):
                if i != ANCHOR:
                    change = end[n, i, 1 + j] - end[n, i, 1 + COLUMNS] * late
                    w[(row * COLUMNS + j) * LANES + lane] = change
                    total += change * change
                    row += 1
        square[lane] = total


@kernel
def _radius(end, out, a, b, squares):
    for first in range(0, end.shape[0], LANES):
        _load(end, first, a, squares[0])
        for k in range(0, _SQUARINGS, 2):
            _square(a, squares[k], b, squares[k + 1])
            _square(b, squares[k + 1], a, squares[k + 2])
        radius = squares[_SQUARINGS]
        for lane in range(LANES):
            radius[lane] = np.sqrt(radius[lane])
        for k in range(_SQUARINGS - 1, -1, -1):
            for lane in range(LANES):
                radius[lane] = np.sqrt(squares[k, lane] * radius[lane])
        for n in range(first, min(first + LANES, end.shape[0])):
            out[n] = radius[n - first]


def largest_multiplier(end: Array) -> Array:
    """Return the spectral radius of the Poincaré map of the section psi_1 = 0.

    Parameters
    ----------
    end : ndarray, shape (n, 10, 11)
        As `models.vibrator.lanes.tangents.revolve` returns it, for periodic orbits.

    Returns
    -------
    ndarray, shape (n,)
        The largest modulus of the Floquet multipliers except the trivial 1.
    """
    out = np.empty(len(end))
    squares = aligned((_SQUARINGS + 1) * LANES).reshape(-1, LANES)
    _radius(end, out, aligned(_WHOLE), aligned(_WHOLE), squares)
    return out
