"""The random force at the tip: stationary, Gaussian, of level S_F within a band.

By spectral representation (Shinozuka 1971) it is a sum of J lines,

    f(t) = sum_j sqrt(2 S_F D_j E_j) cos(2 pi f_j t + phi_j),

with f_j uniform in the j-th of J sub-bands of width D_j, E_j exponential with mean 1 and phi_j
uniform. For any sub-bands it is then Gaussian at each instant, its variance is S_F times the
bandwidth, and its expected spectrum is flat.

Lines are drawn from the row's seed and the number of the epoch. Time is counted in whole forcing
periods, and phases from the start of the epoch, so that results depend neither on the length of a
run nor on where it is interrupted.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel

Array = NDArray[np.float64]
COUNT = 64  # lines
LOAD = np.dtype(
    [("power", "f8"), ("edges", "f8", (COUNT + 1,)), ("epoch", "i8"), ("seed", "u8")], align=True
)
"""A beam's random load.

power
    2 S_F/(T X0^2), T the forcing period: squared amplitude per unit of D_j and E_j [N2 m-2]; 0 for
    no random load.
edges
    Of the sub-bands, in turns per forcing period.
epoch
    In forcing periods.
seed
    Of the realisation.
"""
AMPLITUDE, SPEED, TURN = range(3)  # columns of the lines of an epoch
_STRIDE, _MIX_1, _MIX_2 = map(
    np.uint64, (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
)


@kernel
def _uniform(seed, epoch, which):
    """Return a number in (0, 1) by the counter-based generator splitmix64, applied twice."""
    word = seed
    for count in (epoch, which):
        word += _STRIDE * np.uint64(count + 1)
        word = (word ^ (word >> np.uint64(30))) * _MIX_1
        word = (word ^ (word >> np.uint64(27))) * _MIX_2
        word = word ^ (word >> np.uint64(31))
    return (float(word >> np.uint64(12)) + 0.5) * 2.0**-52


@kernel
def draw(load, epoch, lines):
    """Draw the lines of an epoch.

    Parameters
    ----------
    load : LOAD
        Of one beam.
    epoch : int
        0 for the first.
    lines : ndarray, shape (COUNT, 3)
        Set to the amplitude over the initial gap [N m-1], the turns per forcing period, and the
        turn at the start of the epoch, of each line.
    """
    edges, seed = load["edges"], load["seed"]
    for j in range(COUNT):
        width = edges[j + 1] - edges[j]
        size = -math.log(_uniform(seed, epoch, 3 * j + 2))
        lines[j, AMPLITUDE] = np.sqrt(load["power"] * width * size)
        lines[j, SPEED] = edges[j] + width * _uniform(seed, epoch, 3 * j)
        lines[j, TURN] = _uniform(seed, epoch, 3 * j + 1)


@kernel
def turn_at(speed, turn, period):
    """Return the turn of a line at the start of the given forcing period of its epoch."""
    turn += (speed - np.floor(speed)) * period
    return turn - np.floor(turn)


def force(load: np.void, periods: Array) -> Array:
    """Return the random force of one beam.

    Parameters
    ----------
    load : LOAD
    periods : ndarray, shape (k,)
        Times from the start, in forcing periods.

    Returns
    -------
    ndarray, shape (k,)
        Over the initial gap [N m-1].
    """
    total = np.zeros(len(periods))
    epoch = (periods // load["epoch"]).astype(int)
    lines = np.empty((COUNT, 3))
    for number in np.unique(epoch):
        now = epoch == number
        draw(load, number, lines)
        time = periods[now] - number * load["epoch"]
        for amplitude, speed, turn in lines:
            total[now] += amplitude * np.cos(2 * np.pi * (speed * time % 1.0 + turn))
    return total
