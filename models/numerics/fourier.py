"""The discrete Fourier transform, with the same bits on every processor.

Stockham's algorithm (Cochran et al. 1967), by fours: it needs no sorting.
"""

import numpy as np
from numpy.typing import NDArray

from models.numerics.fma import fma
from models.numerics.jit import kernel
from models.numerics.sincos import cosine_sine

Array = NDArray[np.float64]
FORWARD, INVERSE = -1.0, 1.0


@kernel
def _fill_turns(turns):
    half = turns.shape[1]
    for k in range(half):
        turns[0, k], turns[1, k] = cosine_sine(np.pi * (k / half))


def unit_circle(size: int) -> Array:
    """Return cosine and sine of the first half of `size` equal parts of a turn.

    They serve transforms of this length and of all shorter ones.

    Parameters
    ----------
    size : int
        A power of two, at least 2.

    Returns
    -------
    ndarray, shape (2, size // 2)
    """
    turns = np.empty((2, size // 2))
    _fill_turns(turns)
    return turns


@kernel
def _by_two(re, im, group, out_re, out_im):
    """Take the last pass of an odd number: elements `group` apart."""
    for q in range(group):
        a, b, u, v = re[q], im[q], re[group + q], im[group + q]
        out_re[q], out_im[q] = a + u, b + v
        out_re[group + q], out_im[group + q] = a - u, b - v


@kernel
def _by_four(re, im, quarter, group, turns, sign, out_re, out_im):
    """Combine four elements, `quarter * group` apart."""
    apart = quarter * group
    spacing = turns.shape[1] // (2 * apart)
    for p in range(quarter):
        k = p * group * spacing
        c1, s1 = turns[0, k], sign * turns[1, k]
        c2, s2 = turns[0, 2 * k], sign * turns[1, 2 * k]
        c3, s3 = fma(c1, c2, -s1 * s2), fma(c1, s2, s1 * c2)
        near, to = p * group, 4 * p * group
        for q in range(group):
            i = near + q
            a, b = re[i], im[i]
            c, d = re[i + apart], im[i + apart]
            e, f = re[i + 2 * apart], im[i + 2 * apart]
            g, h = re[i + 3 * apart], im[i + 3 * apart]
            sum_re, sum_im, gap_re, gap_im = a + e, b + f, a - e, b - f
            more_re, more_im, turn_re, turn_im = c + g, d + h, sign * (h - d), sign * (c - g)
            o = to + q
            out_re[o], out_im[o] = sum_re + more_re, sum_im + more_im
            u, v = gap_re + turn_re, gap_im + turn_im
            out_re[o + group], out_im[o + group] = fma(u, c1, -v * s1), fma(u, s1, v * c1)
            u, v = sum_re - more_re, sum_im - more_im
            out_re[o + 2 * group], out_im[o + 2 * group] = fma(u, c2, -v * s2), fma(u, s2, v * c2)
            u, v = gap_re - turn_re, gap_im - turn_im
            out_re[o + 3 * group], out_im[o + 3 * group] = fma(u, c3, -v * s3), fma(u, s3, v * c3)


@kernel
def transform(parts, size, turns, sign, room):
    """Replace x by sum_j x_j exp(sign 2 pi i j k / size), in its first `size` elements.

    Parameters
    ----------
    parts : ndarray, shape (2, at least size)
        Real and imaginary part; updated in place.
    size : int
        A power of two.
    turns : ndarray, shape (2, k)
        As `unit_circle` returns it, for a length of at least `size`.
    sign : float
        `FORWARD` or `INVERSE`; neither divides by the length.
    room : ndarray, shape (2, at least size)
    """
    re, im, out_re, out_im = parts[0], parts[1], room[0], room[1]
    left, group = size, 1
    is_moved = False
    while left > 1:
        if left == 2:
            _by_two(re, im, group, out_re, out_im)
        else:
            _by_four(re, im, left // 4, group, turns, sign, out_re, out_im)
        re, im, out_re, out_im = out_re, out_im, re, im
        is_moved = not is_moved
        left //= 4
        group *= 4
    if is_moved:
        for k in range(size):
            parts[0, k], parts[1, k] = room[0, k], room[1, k]
