"""Blocks of lanes: how many systems advance abreast, and the memory they live in."""

import numpy as np
from numpy.typing import NDArray

LANES = 16


def aligned(size: int) -> NDArray[np.float64]:
    """Return float64 zeros that start on a cache line: whole vectors then never straddle two."""
    raw = np.zeros(size + 8)
    skip = (-raw.ctypes.data // 8) % 8
    return raw[skip : skip + size]
