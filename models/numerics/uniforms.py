"""Uniform random numbers, each of which depends on a row's seed and on its own number alone."""

import numpy as np

from models.numerics.jit import kernel

STRIDE, _MIX_1, _MIX_2 = map(
    np.uint64, (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
)


@kernel
def mixed(word):
    """Return the output function of splitmix64 (Steele, Lea & Flood 2014)."""
    word = (word ^ (word >> np.uint64(30))) * _MIX_1
    word = (word ^ (word >> np.uint64(27))) * _MIX_2
    return word ^ (word >> np.uint64(31))


@kernel
def uniform(stream, count):
    """Return a number in (0, 1): element `count` of the stream ``mixed(seed + STRIDE)``."""
    word = mixed(stream + STRIDE * np.uint64(count + 1))
    return (float(word >> np.uint64(12)) + 0.5) * 2.0**-52
