"""Blocks of lanes: the number of systems that advance together, and their memory."""

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import lean

LANES = 16


def aligned(size: int) -> NDArray[np.float64]:
    """Return float64 zeros that start on a cache line, so that no vector straddles two lines."""
    raw = np.zeros(size + 8)
    skip = (-raw.__array_interface__["data"][0] // 8) % 8
    return raw[skip : skip + size]


@lean
def copy(source, into):
    """Copy numbers to the start of an array, in a kernel.

    A slice would do, but compiling what it says of arrays that do not fit takes five seconds.
    """
    for i in range(len(source)):
        into[i] = source[i]
