"""The largest Floquet multiplier of periodic orbits, sixteen machines at a time.

Squaring A repeatedly leaves only what grows fastest: as a rule one eigenvalue or a pair, which
traces determine. Where more remain, Gelfand's formula holds: the spectral radius is the limit of
|A^n|^(1/n), and an error in the k-th squaring is weighted by 2^-k. Unlike an eigenvalue solver,
this is straight-line algebra.
"""

import numpy as np

from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel, spliced
from models.vibrator.lanes.packed import STATE, Array
from models.vibrator.lanes.tangents import ANCHOR, COLUMNS, ENTRIES

_SQUARINGS = 40  # |A^n| may differ from radius^n by a factor c: an error of log(c)/2^40 is left
_FEWEST = 8  # the 256th power: a third eigenvalue 6 % smaller has faded to 1e-7
_FADED = 1e-7  # difference of two estimates; the later one errs by the square of it
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
def _square(a, square, out, next_square, trace):
    """Set `out` to the square of a over its squared norm, and find its squared norm and trace."""
    for lane in range(LANES):
        next_square[lane] = trace[lane] = 0.0
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
                trace[lane] += entry if j == i else 0.0
            next_square[lane] += total


@kernel
def _load(end, w, square):
    """Load the derivatives of the passage of psi_1 = 0, and their squared norm."""
    anchor = ANCHOR * ENTRIES * LANES
    square[:] = 0.0
    for j in range(COLUMNS):
        row = 0
        for i in range(STATE):
            if i != ANCHOR:
                o = i * ENTRIES * LANES
                for lane in range(LANES):
                    rate = end[anchor + (ENTRIES - 1) * LANES + lane]
                    late = end[anchor + (1 + j) * LANES + lane] / rate
                    change = end[o + (1 + j) * LANES + lane]
                    change -= end[o + (ENTRIES - 1) * LANES + lane] * late
                    w[(row * COLUMNS + j) * LANES + lane] = change
                    square[lane] += change * change
                row += 1


@inlined
def _larger(trace, next_trace):
    """Return the larger modulus of two eigenvalues from their sum and the sum of their squares."""
    part = 0.5 * next_trace - 0.25 * trace * trace  # their squared distance over four
    root = np.sqrt(abs(part))
    product = 0.5 * (trace * trace - next_trace)
    return 0.5 * abs(trace) + root if part >= 0.0 else np.sqrt(abs(product))


@kernel
def _settle(k, squares, traces, level, radius):
    """Store the spectral radius of the k-th power if two estimates agree; count the others.

    If a third eigenvalue contributed, the estimate of the next power would not be the square.
    """
    unsettled = 0
    for lane in range(LANES):
        square, next_square = squares[k - 2, lane], squares[k - 1, lane]
        early = _larger(traces[k - 2, lane], square * traces[k - 1, lane])
        late = _larger(traces[k - 1, lane], next_square * traces[k, lane])
        agree = abs(early * early - square * late) < _FADED * early * early
        new = agree & (level[lane] > k)
        radius[lane] = late if new else radius[lane]
        level[lane] = k - 1.0 if new else level[lane]
        unsettled += 0 if level[lane] < k else 1
    return unsettled


@spliced
def largest_multiplier(end, wanted, radius, work):
    """Set `radius` to the spectral radii of the Poincaré maps of the section psi_1 = 0.

    Parameters
    ----------
    end : ndarray, shape (STATE * ENTRIES * LANES,)
        As `models.vibrator.lanes.tangents.differentiate` sets it, for periodic orbits.
    wanted : ndarray of bool, shape (LANES,)
        In which lanes.
    radius : ndarray, shape (LANES,)
        The largest modulus of the Floquet multipliers except the trivial 1.
    work : tuple of ndarray
        Rooms of `rooms`.
    """
    a, b, squares, traces, level = work
    _load(end, a, squares[0])
    for lane in range(LANES):
        level[lane] = _SQUARINGS + 1.0 if wanted[lane] else 0.0
    done = 0
    while done < _SQUARINGS:
        _square(a, squares[done], b, squares[done + 1], traces[done + 1])
        _square(b, squares[done + 1], a, squares[done + 2], traces[done + 2])
        done += 2
        if done > _FEWEST and _settle(done, squares, traces, level, radius) == 0:
            break
    for lane in range(LANES):
        if level[lane] > _SQUARINGS:
            level[lane], radius[lane] = done, np.sqrt(squares[done, lane])
    for k in range(done - 1, -1, -1):
        for lane in range(LANES):
            smaller = np.sqrt(squares[k, lane] * radius[lane])
            radius[lane] = smaller if k < level[lane] else radius[lane]


def rooms() -> tuple[Array, ...]:
    """Return the arrays in which `largest_multiplier` works."""
    squares, traces = aligned(2 * (_SQUARINGS + 1) * LANES).reshape(2, -1, LANES)
    return aligned(_WHOLE), aligned(_WHOLE), squares, traces, aligned(LANES)
