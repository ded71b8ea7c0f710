"""The steady response to the random force, line by line, without sampling in time."""

import math

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.random_lines import (
    AMPLITUDE,
    COUNT,
    SPEED,
    TURN,
    Array,
    turn_at,
)
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel

SURE = 9.0  # standard deviations not exceeded in a life: once in about 10^17 oscillations
_NODES = 4  # of the quadrature of each sub-band


@inlined
def _mode(w, frequency, decay, mobility):
    """Return stiffness and damping of a mode at w, and its mobility over their squared modulus."""
    stiff, damp = fma(-w, w, frequency**2), 2 * decay * w
    return stiff, damp, mobility / fma(stiff, stiff, damp * damp)


@kernel
def respond(lines, forcing, frequency, decay, mobility):
    """Convert the lines of a beam's force to those of its steady tip displacement [X0]."""
    for j in range(COUNT):
        w = lines[j, SPEED] * forcing
        re = im = 0.0
        for i in range(frequency.size):
            stiff, damp, per = _mode(w, frequency[i], decay[i], mobility[i])
            re = fma(stiff, per, re)
            im = fma(-damp, per, im)
        lines[j, AMPLITUDE] *= np.sqrt(re * re + im * im)
        lines[j, TURN] += math.atan2(im, re) / (2 * np.pi)


@kernel
def add_modes(lines, period, sign, forcing, frequency, decay, mobility, modes):
    """Add to `modes` (2, m), or subtract, the modes' steady response to the lines of a force.

    Rows: displacements and velocities, in initial gaps (per second), at the start of a period of
    the epoch.
    """
    for j in range(COUNT):
        w = lines[j, SPEED] * forcing
        angle = 2 * np.pi * turn_at(lines[j, SPEED], lines[j, TURN], period)
        c = sign * lines[j, AMPLITUDE] * math.cos(angle)
        s = sign * lines[j, AMPLITUDE] * math.sin(angle)
        for i in range(frequency.size):
            stiff, damp, per = _mode(w, frequency[i], decay[i], mobility[i])
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
