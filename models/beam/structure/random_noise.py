"""White Gaussian noise in which every sample depends on the row's seed and its own number alone."""

import math

import numpy as np

from models.numerics.jit import kernel
from models.numerics.sincos import cosine_sine
from models.numerics.uniforms import STRIDE, mixed, uniform


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
    stream = mixed(seed + STRIDE)
    odd = first % 2
    pair = (first - odd) // 2
    pairs = len(out) // 2 + 1
    for i in range(pairs):
        room[0, i] = math.log(uniform(stream, 2 * (pair + i)))
        room[1, i] = uniform(stream, 2 * (pair + i) + 1)
    for i in range(pairs):
        radius = math.sqrt(-2 * room[0, i])
        c, s = cosine_sine(2 * np.pi * room[1, i])
        room[0, i], room[1, i] = radius * c, radius * s
    for i in range(len(out)):
        at = i + odd
        out[i] = room[at % 2, at // 2]
