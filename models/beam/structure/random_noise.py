"""White Gaussian noise in which every sample depends on the row's seed and its own number alone."""

import math

import numpy as np

from models.numerics.jit import kernel
from models.numerics.sincos import cosine_sine

_STRIDE, _MIX_1, _MIX_2 = map(
    np.uint64, (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
)


@kernel
def _mixed(word):
    """Return the output function of splitmix64 (Steele, Lea & Flood 2014)."""
    word = (word ^ (word >> np.uint64(30))) * _MIX_1
    word = (word ^ (word >> np.uint64(27))) * _MIX_2
    return word ^ (word >> np.uint64(31))


@kernel
def _uniform(stream, count):
    """Return a number in (0, 1): element `count` of the stream."""
    word = _mixed(stream + _STRIDE * np.uint64(count + 1))
    return (float(word >> np.uint64(12)) + 0.5) * 2.0**-52


@kernel
def fill(seed, first, out, room):
    """Set `out` to samples `first`, `first + 1`, ... of the noise; they may be negative.

    Samples are drawn in pairs, from a radius and an angle (Box & Muller 1958).

    Parameters
    ----------
    seed : uint64
    first : int
    out : ndarray, shape (k,)
    room : ndarray, shape (2, at least k // 2 + 1)
    """
    stream = _mixed(seed + _STRIDE)
    odd = first % 2
    pair = (first - odd) // 2
    pairs = len(out) // 2 + 1
    for i in range(pairs):
        room[0, i] = math.log(_uniform(stream, 2 * (pair + i)))
        room[1, i] = _uniform(stream, 2 * (pair + i) + 1)
    for i in range(pairs):
        radius = math.sqrt(-2 * room[0, i])
        c, s = cosine_sine(2 * np.pi * room[1, i])
        room[0, i], room[1, i] = radius * c, radius * s
    for i in range(len(out)):
        at = i + odd
        out[i] = room[at % 2, at // 2]
