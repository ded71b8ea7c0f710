"""What a law of wear declares."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from models.numerics.jit import kernel

MOST = 3
"""Arguments of a law, at most."""


class Argument(NamedTuple):
    """A number of a law.

    Attributes
    ----------
    name, unit, meaning : str
    bounds : tuple of float
        Both ends included.
    default : float
        NaN if it must be given.
    """

    name: str
    unit: str
    meaning: str
    bounds: tuple[float, float]
    default: float = np.nan


@kernel
def no_threshold(values):
    """Return 0: wear begins with contact."""
    return 0.0


@kernel
def no_clock(values):
    """Return inf: the rate depends on the state alone."""
    return np.inf


class WearLaw(NamedTuple):
    """A law of wear.

    Attributes
    ----------
    name, meaning : str
    arguments : tuple of Argument
        At most `MOST`; `values` below are in their order.
    rate : kernel
        ``rate(before, work_rate, t, depth, volume, values)`` returns the volume worn off the rod
        per time [m3/s] from that by Archard's law, > 0, the mean work-rate [W], the time [s], and
        the depth [m] and volume [m3] of the rod's scar.
    threshold : kernel
        ``threshold(values)`` returns the work-rate up to which there is no wear [W].
    clock : kernel
        ``clock(values)`` returns the time in which the rate changes by itself [s].
    """

    name: str
    meaning: str
    arguments: tuple[Argument, ...]
    rate: Callable[..., float]
    threshold: Callable[..., float] = no_threshold
    clock: Callable[..., float] = no_clock
