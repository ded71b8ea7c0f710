"""Blocks of lanes: how many systems advance at a time, and their memory."""

import numpy as np
from numpy.typing import NDArray

LANES = 16


def aligned(size: int) -> NDArray[np.float64]:
    """Return float64 zeros that start on a cache line, so that no vector straddles two lines."""
    raw = np.zeros(size + 8)
    skip = (-raw.ctypes.data // 8) % 8
    return raw[skip : skip + size]
