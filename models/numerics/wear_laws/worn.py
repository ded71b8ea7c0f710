"""The rate of wear by a law."""

from collections.abc import Callable, Sequence

import numpy as np

from models.numerics.jit import kernel
from models.numerics.wear_laws.law import WearLaw
from models.numerics.wear_laws.laws import LAWS

_SETTLED = 40.0  # time constants after which a rate no longer changes


@kernel
def _no_rate(index, before, work_rate, t, depth, volume, values):
    return np.nan


@kernel
def _nothing(index, values):
    return np.nan


def _chosen_rate(laws: Sequence[WearLaw]) -> Callable[..., float]:
    """Compile the choice of a law by its index."""
    if not laws:
        return _no_rate
    last, number = laws[-1].rate, len(laws) - 1
    earlier = _chosen_rate(laws[:-1])

    @kernel
    def chosen(index, before, work_rate, t, depth, volume, values):
        if index == number:
            return last(before, work_rate, t, depth, volume, values)
        return earlier(index, before, work_rate, t, depth, volume, values)

    return chosen


def _chosen(kernels: Sequence[Callable[..., float]]) -> Callable[..., float]:
    """Compile the choice of a function of the values of a law by its index."""
    if not kernels:
        return _nothing
    last, number = kernels[-1], len(kernels) - 1
    earlier = _chosen(kernels[:-1])

    @kernel
    def chosen(index, values):
        if index == number:
            return last(values)
        return earlier(index, values)

    return chosen


_rate_of = _chosen_rate(LAWS)
_threshold_of = _chosen([law.threshold for law in LAWS])
_clock_of = _chosen([law.clock for law in LAWS])


@kernel
def wear_rate(rate, work_rate, t, depth, volume, laws):
    """Return the volume worn off the rod per time [m3/s] by a law, from that by Archard's law.

    Parameters
    ----------
    rate, work_rate : float
        k U [m3/s] and U [W].
    t, depth, volume : float
        Time [s], depth [m] and volume [m3] of the rod's scar.
    laws : ndarray, shape (l, 1 + MOST)
        From `models.numerics.wear_laws.laws.law_numbers`.
    """
    for i in range(len(laws)):
        if rate > 0:
            rate = _rate_of(laws[i, 0], rate, work_rate, t, depth, volume, laws[i, 1:])
    return rate


@kernel
def wear_threshold(laws):
    """Return the work-rate up to which there is no wear [W]."""
    threshold = 0.0
    for i in range(len(laws)):
        threshold = max(threshold, _threshold_of(laws[i, 0], laws[i, 1:]))
    return threshold


@kernel
def wear_clock(t, laws):
    """Return the time in which rates of wear change by themselves [s]; inf if they do not."""
    tau = np.inf
    for i in range(len(laws)):
        clock = _clock_of(laws[i, 0], laws[i, 1:])
        if t < _SETTLED * clock:
            tau = min(tau, clock)
    return tau
