"""The random load: a stationary Gaussian force at the tip, of level S_F within a band.

By spectral representation (Shinozuka 1971) the force is a sum of J lines,

    f(t) = sum_j sqrt(2 S_F D_j E_j) cos(2 pi f_j t + phi_j),

with f_j at a random place of the j-th of J sub-bands, D_j wide, E_j exponential of mean 1 and phi_j
any phase. Whatever the sub-bands, it is then Gaussian at each instant, its variance is S_F times
the width of the band, and its expected spectrum is flat. A line acts through the exact steady
response, as the harmonic force does, so that nothing is sampled.

Sub-bands of equal width would leave a sharp resonance to one line, or to none: the beam's own are
some 0.3 Hz wide. So only half of their edges lie evenly, and the others at equal shares of the
power that a white force gives to the modes, sum_i b_i d_i/((w - w_i)^2 + d_i^2).

J lines go on for ever in the way they were drawn; a process forgets. So all are drawn anew, from
the row's seed and the number of the epoch, after each epoch of 2/d + 200/B, with the slowest decay
d and the bandwidth B: a few times as long as beam and force remember. The force never repeats, and
the time mean of a work-rate tends to its mean over all realisations, that of the process. From
epoch to epoch the force jumps, and the steady response with it; what the modes lack then they keep
as free vibration. The jumps blur the band, to a level of
S_F B/(2 pi^2 |f - f_low| |f - f_high|) over the epoch outside. Where that would make the tip vary
more than 1 % by modes that lie outside, the epoch is longer, up to 30 times.

Time is counted in whole forcing periods, and phases from the beginning of the epoch, so that
neither a long run nor where it is interrupted makes a difference.
"""

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Rows
from models.numerics.elementary import arctan, tan
from models.numerics.fma import fma
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
_MEMORIES, _TURNS = 2, 200  # of the slowest mode, and of the bandwidth, in an epoch
_BLUR = 0.01  # of the tip's variance, from modes outside the band
_LONGER = 30.0
_SURE = 9.0  # standard deviations that no life ever sees: once in some 10^17 oscillations
_NODES = 4  # of the quadrature of each sub-band
_STRIDE, _MIX_1, _MIX_2 = map(
    np.uint64, (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
)


def has_band(p: Rows) -> NDArray[np.bool_]:
    """Tell which of n beams have a random load that can exist, or none.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).

    Returns
    -------
    ndarray of bool, shape (n,)
        False where a level is given for a band whose upper end is not above its lower one.
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

    Half of them lie evenly; each of the others ends an equal share of the modes' power, which for
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


@kernel
def _uniform(seed, epoch, which):
    """Return a number in (0, 1): the counter-based generator splitmix64, twice over."""
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
        Set to the amplitude over the initial gap [N m-1], the turns in a forcing period, and the
        turn at which the epoch begins, of each line.
    """
    edges, seed = load["edges"], load["seed"]
    for j in range(COUNT):
        width = edges[j + 1] - edges[j]
        size = -np.log(_uniform(seed, epoch, 3 * j + 2))
        lines[j, AMPLITUDE] = np.sqrt(load["power"] * width * size)
        lines[j, SPEED] = edges[j] + width * _uniform(seed, epoch, 3 * j)
        lines[j, TURN] = _uniform(seed, epoch, 3 * j + 1)


@kernel
def turn_at(speed, turn, period):
    """Return the turn at which a line begins the given forcing period of its epoch."""
    turn += (speed - np.floor(speed)) * period
    return turn - np.floor(turn)


@kernel
def respond(lines, forcing, frequency, decay, mobility):
    """Turn the lines of a beam's force into those of its steady tip displacement [initial gaps]."""
    for j in range(COUNT):
        w = lines[j, SPEED] * forcing
        re = im = 0.0
        for i in range(frequency.size):
            stiff, damp = fma(-w, w, frequency[i] ** 2), 2 * decay[i] * w
            per = mobility[i] / fma(stiff, stiff, damp * damp)
            re = fma(stiff, per, re)
            im = fma(-damp, per, im)
        lines[j, AMPLITUDE] *= np.sqrt(re * re + im * im)
        lines[j, TURN] += np.arctan2(im, re) / (2 * np.pi)


@kernel
def add_modes(lines, period, sign, forcing, frequency, decay, mobility, modes):
    """Add to modes (2, m), or take away, the modes' steady response to the lines of a force.

    Rows: displacements and velocities, in initial gaps (per second), as a period of the epoch
    begins.
    """
    for j in range(COUNT):
        w = lines[j, SPEED] * forcing
        angle = 2 * np.pi * turn_at(lines[j, SPEED], lines[j, TURN], period)
        c = sign * lines[j, AMPLITUDE] * np.cos(angle)
        s = sign * lines[j, AMPLITUDE] * np.sin(angle)
        for i in range(frequency.size):
            stiff, damp = fma(-w, w, frequency[i] ** 2), 2 * decay[i] * w
            per = mobility[i] / fma(stiff, stiff, damp * damp)
            modes[0, i] = fma(per, fma(stiff, c, damp * s), modes[0, i])
            modes[1, i] = fma(per * w, fma(damp, c, -stiff * s), modes[1, i])


@kernel
def _spread(load, forcing, frequency, decay, mobility, node, weight, variance):
    for n in range(load.size):
        variance[n] = 0.0
        if load[n]["power"] == 0:
            continue
        lines = np.empty((COUNT, 3))
        for k in range(node.size):
            for j in range(COUNT):
                begin, end = load[n]["edges"][j], load[n]["edges"][j + 1]
                lines[j] = 0.0
                lines[j, SPEED] = begin + node[k] * (end - begin)
                lines[j, AMPLITUDE] = np.sqrt(0.5 * weight[k] * load[n]["power"] * (end - begin))
            respond(lines, forcing[n], frequency[n], decay[n], mobility[n])
            for j in range(COUNT):
                variance[n] += lines[j, AMPLITUDE] ** 2


def tip_deviation(
    load: NDArray[np.void], forcing: Array, frequency: Array, decay: Array, mobility: Array
) -> Array:
    """Return the standard deviation of the tip under the random load alone, without contact.

    Parameters
    ----------
    load : ndarray of LOAD, shape (n,)
    forcing, frequency, decay, mobility : ndarray
        As in `models.beam.structure.modal.Beams`.

    Returns
    -------
    ndarray, shape (n,)
        In initial gaps: the root of the integral of S_F |H|^2.
    """
    node, weight = np.polynomial.legendre.leggauss(_NODES)
    variance = np.empty(len(load))
    _spread(load, forcing, frequency, decay, mobility, (1 + node) / 2, weight / 2, variance)
    return np.sqrt(variance)


def sure_reach(deviation: Array) -> Array:
    """Return what the random part of the tip's displacement never exceeds in a life."""
    return _SURE * deviation


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
