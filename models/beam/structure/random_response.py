"""The random force, and the response of a contact-free beam to it, at equally spaced instants.

Both are the same noise through a linear filter, whose gain is that of the band-pass, times that of
the beam. The response is computed in pairs of stretches: two real signals pass a real filter as the
parts of a complex one. Between its samples it is interpolated, see
`models.beam.structure.interpolation`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.interpolation import BEFORE, REACH, weights
from models.beam.structure.random_load import FINER
from models.beam.structure.random_noise import fill
from models.numerics.fma import fma
from models.numerics.fourier import FORWARD, INVERSE, transform, unit_circle
from models.numerics.jit import inlined, kernel
from models.numerics.sincos import cosine_sine

Array = NDArray[np.float64]
SURE = 9.0  # standard deviations not exceeded in a life: once in about 10^17 oscillations
_FAR = 40.0  # widths of an edge, beyond which it is 0 or 1 to rounding
RIGID = np.empty((3, 0))  # oscillators of a filter whose output is the force


class Workspace(NamedTuple):
    """Room for the computation of one pair of stretches.

    Attributes
    ----------
    parts, other : ndarray, shape (2, FINER * size)
    turns : ndarray, shape (2, FINER * size // 2)
        As `models.numerics.fourier.unit_circle` returns it.
    """

    parts: Array
    other: Array
    turns: Array

    @staticmethod
    def of(load: NDArray[np.void]) -> "Workspace":
        """Return room for the longest stretches of n beams."""
        most = FINER * max(2, int(load["size"].max()))
        return Workspace(np.empty((2, most)), np.empty((2, most)), unit_circle(most))


def samples_per_stretch(load: NDArray[np.void]) -> NDArray[np.int64]:
    """Return the number of samples of a stretch, with those around it for the interpolation."""
    return FINER * load["rate"] * load["stretch"] + REACH - 1


@inlined
def _logistic(x):
    return 1 / (1 + math.exp(-x))


@kernel
def _band(load, turns):
    """Return the gain of the band-pass at a frequency in turns per forcing period."""
    low, high, edge = load["low"], load["high"], load["edge"]
    if turns < 0.5 * (low + high):
        share = _logistic((turns - low) / edge) - _logistic((turns - high) / edge)
    else:
        share = _logistic((high - turns) / edge) - _logistic((low - turns) / edge)
    share += _logistic(-(turns + low) / edge) - _logistic(-(turns + high) / edge)
    return math.sqrt(load["power"] * share)


@kernel
def _add_mode(mode, w, first, last, gain):
    """Add the gain of a mode at frequencies w [rad s-1]."""
    frequency, decay, mobility = mode
    square, twice = frequency * frequency, 2 * decay
    re, im = gain[0], gain[1]
    for k in range(first, last):
        stiff, damp = fma(-w[k], w[k], square), twice * w[k]
        per = mobility / fma(stiff, stiff, damp * damp)
        re[k] = fma(stiff, per, re[k])
        im[k] = fma(-damp, per, im[k])


@kernel
def set_gain(load, forcing, oscillators, gain):
    """Set the gain of the filter at the frequencies of the transform of `size` samples of noise.

    Parameters
    ----------
    load : LOAD
        Of one beam.
    forcing : float
        [rad s-1]
    oscillators : ndarray, shape (3, m)
        w_i [rad s-1], d_i [s-1], b_i [kg-1] of each mode; `RIGID` for the force itself.
    gain : ndarray, shape (2, at least size // 2)
        Set to real and imaginary part, over the size.
    """
    size = load["size"]
    half, step = size // 2, load["rate"] / size
    far = _FAR * load["edge"]
    first = max(0, int((load["low"] - far) / step))
    last = min(half, int((load["high"] + far) / step) + 2)
    gain[:] = 0.0
    w = np.arange(half) * (step * forcing)
    for i in range(oscillators.shape[1]):
        mode = oscillators[0, i], oscillators[1, i], oscillators[2, i]
        _add_mode(mode, w, first, last, gain)
    for k in range(first, last):
        band = _band(load, k * step) / size
        gain[0, k] = band * gain[0, k] if oscillators.shape[1] else band
        gain[1, k] *= band


@kernel
def set_stretches(load, gain, pair, work, samples):
    """Compute two stretches: numbers 2 `pair` and 2 `pair` + 1.

    Parameters
    ----------
    load : LOAD
        Of one beam.
    gain : ndarray, shape (2, at least size // 2)
        As `set_gain` sets it.
    pair : int
    work : Workspace
    samples : ndarray, shape (2, at least samples_per_stretch)
        Set to the output of the filter, from `BEFORE` samples before each stretch on.
    """
    parts, other, turns = work
    size, rate = load["size"], load["rate"]
    for part in range(2):
        first = rate * ((2 * pair + part) * load["stretch"] - load["lead"])
        fill(load["seed"], first, parts[part, :size], other)
    transform(parts, size, turns, FORWARD, other)
    fine = FINER * size
    other[:, :fine] = 0.0
    for k in range(size // 2):
        g, h, u, v = gain[0, k], gain[1, k], parts[0, k], parts[1, k]
        other[0, k], other[1, k] = fma(g, u, -h * v), fma(g, v, h * u)
        if k > 0:
            u, v = parts[0, size - k], parts[1, size - k]
            other[0, fine - k], other[1, fine - k] = fma(g, u, h * v), fma(g, v, -h * u)
    transform(other, fine, turns, INVERSE, parts)
    skipped = FINER * rate * load["lead"] - BEFORE
    for part in range(2):
        for i in range(FINER * rate * load["stretch"] + REACH - 1):
            samples[part, i] = other[part, skipped + i]


@kernel
def _open(load, forcing, oscillators, work, gain, modes):
    """Set `modes` (2, m) to the modes' response of one beam at t = 0, and its velocity."""
    parts, other, turns = work
    size, lead = load["size"], load["rate"] * load["lead"]
    fill(load["seed"], -lead, parts[0, :size], other)
    parts[1, :size] = 0.0
    transform(parts, size, turns, FORWARD, other)
    set_gain(load, forcing, RIGID, gain)
    step = load["rate"] / size * forcing
    modes[:] = 0.0
    for k in range(size // 2):
        if gain[0, k] == 0.0:
            continue
        c, s = cosine_sine(2 * np.pi * ((k * lead) % size / size))
        twice = gain[0, k] * (1.0 if k == 0 else 2.0)
        u, v = (
            twice * fma(parts[0, k], c, -parts[1, k] * s),
            twice * fma(parts[0, k], s, parts[1, k] * c),
        )
        w = k * step
        for i in range(oscillators.shape[1]):
            frequency, decay, mobility = oscillators[0, i], oscillators[1, i], oscillators[2, i]
            stiff, damp = fma(-w, w, frequency * frequency), 2 * decay * w
            per = mobility / fma(stiff, stiff, damp * damp)
            modes[0, i] = fma(per, fma(stiff, u, damp * v), modes[0, i])
            modes[1, i] = fma(per * w, fma(damp, u, -stiff * v), modes[1, i])


def opening(load: NDArray[np.void], forcing: Array, oscillators: Array) -> Array:
    """Return the response of each mode at t = 0 to the random load of n beams, without contact.

    Parameters
    ----------
    load : ndarray of LOAD, shape (n,)
    forcing : ndarray, shape (n,)
        [rad s-1]
    oscillators : ndarray, shape (n, 3, m)
        As in `set_gain`.

    Returns
    -------
    ndarray, shape (n, 2, m)
        Displacements in initial gaps, and velocities in initial gaps per second.
    """
    modes = np.zeros((len(load), 2, oscillators.shape[2]))
    work = Workspace.of(load)
    gain = np.empty((2, work.parts.shape[1] // (2 * FINER)))
    for row in np.flatnonzero(load["power"] > 0):
        _open(load[row], forcing[row], oscillators[row], work, gain, modes[row])
    return modes


@kernel
def _variance(load, forcing, oscillators, gain, variance):
    for n in range(load.size):
        variance[n] = 0.0
        if load[n]["power"] > 0:
            set_gain(load[n], forcing[n], oscillators[n], gain)
            for k in range(load[n]["size"] // 2):
                square = gain[0, k] ** 2 + gain[1, k] ** 2
                variance[n] += load[n]["size"] * square * (1.0 if k == 0 else 2.0)


def tip_deviation(load: NDArray[np.void], forcing: Array, oscillators: Array) -> Array:
    """Return the standard deviation of the tip under the random load alone, without contact.

    Parameters
    ----------
    load, forcing, oscillators
        As in `opening`.

    Returns
    -------
    ndarray, shape (n,)
        In initial gaps: the root of the integral of S_F |H|^2.
    """
    variance = np.empty(len(load))
    gain = np.empty((2, int(load["size"].max()) // 2))
    _variance(load, forcing, oscillators, gain, variance)
    return np.sqrt(variance)


def filtered(load: np.void, forcing: float, oscillators: Array, periods: Array) -> Array:
    """Return the random force of one beam, or its response without contact.

    Parameters
    ----------
    load : LOAD
    forcing : float
        [rad s-1]
    oscillators : ndarray, shape (3, m)
        `RIGID` for the force, as in `set_gain`.
    periods : ndarray, shape (k,)
        Times from the start, in forcing periods.

    Returns
    -------
    ndarray, shape (k,)
        Over the initial gap: force [N m-1] or displacement [1].
    """
    loads = np.array([load], load.dtype)
    work = Workspace.of(loads)
    gain, samples = (
        np.empty((2, work.parts.shape[1] // (2 * FINER))),
        np.empty((2, int(samples_per_stretch(loads)[0]))),
    )
    set_gain(load, forcing, oscillators, gain)
    per_period = FINER * load["rate"]
    whole = np.floor(periods).astype(np.int64)
    place = (periods - whole) * per_period
    interval = np.minimum(place.astype(np.int64), per_period - 1)
    weight = weights(place - interval)
    stretch, since = np.divmod(whole, load["stretch"])
    out = np.empty(len(periods))
    for pair in np.unique(stretch // 2):
        set_stretches(load, gain, pair, work, samples)
        now = np.flatnonzero(stretch // 2 == pair)
        first = since[now] * per_period + interval[now]
        around = samples[stretch[now, None] % 2, first[:, None] + np.arange(REACH)]
        out[now] = (weight[now] * around).sum(axis=1)
    return out
