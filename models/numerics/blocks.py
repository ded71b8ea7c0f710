"""Blocks of lanes: how many systems advance at a time, and their memory."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import lean

LANES = 16


class Layout(NamedTuple):
    """Layout of a block of lanes; the quantities of one lane are LANES apart.

    Attributes
    ----------
    state, argument, slopes, size : int
        Offsets of the state, the argument of the next stage (after the last stage: the new state)
        and the slopes of the stages, times the step; and the total length.
    """

    state: int
    argument: int
    slopes: int
    size: int


def layout(quantities: int, stages: int) -> Layout:
    """Return the layout for states of this many quantities and a method of this many stages."""
    whole = quantities * LANES
    return Layout(0, whole, 2 * whole, (2 + stages) * whole)


def aligned(size: int) -> NDArray[np.float64]:
    """Return float64 zeros that start on a cache line, so that no vector straddles two lines."""
    raw = np.zeros(size + 8)
    skip = (-raw.ctypes.data // 8) % 8
    return raw[skip : skip + size]


@lean
def copy(source, into):
    """Copy numbers to the start of an array, in a kernel.

    A slice would do, but compiling what it says of arrays that do not fit takes five seconds.
    """
    for i in range(len(source)):
        into[i] = source[i]
