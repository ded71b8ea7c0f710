"""The random load of n beams: division of its band into lines, and length of their epochs.

Sub-bands of equal width would leave a sharp resonance to one line, or to none: the beam's
resonances are about 0.3 Hz wide. So only half of the edges are evenly spaced; the others divide the
power that a white force supplies to the modes, sum_i b_i d_i/((w - w_i)^2 + d_i^2), into equal
shares.

Unlike a random process, a sum of fixed lines never loses its memory. So all lines are redrawn after
each epoch of 2/d + 200/B, with the slowest decay d and the bandwidth B: a few correlation times of
beam and force. The force never repeats, and the time mean of a work-rate converges to that of the
process. Between epochs the force jumps, and the steady response with it; the modes take up the
difference as free vibration. The jumps blur the band: outside it the level is
S_F B/(2 pi^2 |f - f_low| |f - f_high|) over the epoch. Where modes outside the band would thus
contribute more than 1 % of the tip's variance, the epoch is longer, up to 30 times.
"""

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Rows
from models.beam.structure.random_lines import (
    COUNT,
    LOAD,
    Array,
)
from models.beam.structure.random_response import tip_deviation
from models.numerics.elementary import arctan, tan

_MEMORIES, _TURNS = 2, 200  # of the slowest mode, and of the bandwidth, per epoch
_BLUR = 0.01  # of the tip's variance, from modes outside the band
_LONGER = 30.0


def has_band(p: Rows) -> NDArray[np.bool_]:
    """Return which of n beams have a random force with a band, or no random force.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).

    Returns
    -------
    ndarray of bool, shape (n,)
        False where a level is given but the band's upper end is not above its lower one.
    """
    return (p.random_force_level == 0) | (p.random_force_high > p.random_force_low)


def random_load(
    p: Rows, frequency: Array, decay: Array, mobility: Array, seed: NDArray[np.uint64]
) -> NDArray[np.void]:
    """Return the random load of n beams.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    frequency, decay, mobility : ndarray, shape (n, m)
        As in `models.beam.structure.modal.Beams`.
    seed : ndarray of uint64, shape (n,)

    Returns
    -------
    ndarray of LOAD, shape (n,)
    """
    load = np.zeros(len(seed), LOAD)
    load["epoch"] = 1
    rows = np.flatnonzero((p.random_force_level > 0) & has_band(p))
    if not len(rows):
        return load
    forcing, low, high = (
        a[rows] for a in (p.forcing_frequency, p.random_force_low, p.random_force_high)
    )
    modes = tuple(a[rows] for a in (frequency, decay, mobility))
    edges = _divide(2 * np.pi * low, 2 * np.pi * high, *modes) / (2 * np.pi * forcing[:, None])
    one = np.empty(len(rows), LOAD)
    one["power"] = 2 * p.random_force_level[rows] * forcing / p.initial_gap[rows] ** 2
    one["edges"] = edges
    one["seed"] = seed[rows]
    own = tip_deviation(one, 2 * np.pi * forcing, *modes) ** 2
    blur = one["power"] / (2 * forcing) * _blur(low, high, *modes)
    epoch = _MEMORIES / decay[rows].min(axis=1) + _TURNS / (high - low)
    one["epoch"] = np.ceil(forcing * np.clip(blur / (_BLUR * own), epoch, _LONGER * epoch))
    load[rows] = one
    return load


def _divide(low: Array, high: Array, frequency: Array, decay: Array, mobility: Array) -> Array:
    """Return the edges of the sub-bands, shape (n, COUNT + 1), all in rad/s.

    Half of them are evenly spaced; the others bound equal shares of the modes' power, which for
    each mode is a difference of two angles.
    """
    half = COUNT // 2
    even = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, half + 1)
    first = arctan((low[:, None] - frequency) / decay)
    power = mobility * (arctan((high[:, None] - frequency) / decay) - first)
    below = np.cumsum(power, axis=1)
    goal = below[:, -1:] * (np.arange(half) + 0.5) / half
    mode = (goal[:, :, None] >= below[:, None, :-1]).sum(axis=2)
    w, d, b, angle, total, own = (
        np.take_along_axis(a, mode, axis=1)
        for a in (frequency, decay, mobility, first, below, power)
    )
    uneven = w + d * tan(angle + (goal - (total - own)) / b)
    return np.sort(np.hstack([even, np.clip(uneven, low[:, None], high[:, None])]), axis=1)


def _blur(low: Array, high: Array, frequency: Array, decay: Array, mobility: Array) -> Array:
    """Return the tip's variance from modes outside the band, times epoch over level, shape (n,)."""
    low, high, natural = low[:, None], high[:, None], frequency / (2 * np.pi)
    band = high - low
    to_low, to_high = (np.maximum(np.abs(natural - end), band / 20) for end in (low, high))
    outside = (natural < low) | (natural > high)
    level = outside * band / (2 * np.pi**2 * to_low * to_high)
    return (level * mobility**2 / (8 * decay * frequency**2)).sum(axis=1)
