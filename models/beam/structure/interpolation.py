"""A signal between its samples, as a few harmonic terms in each interval.

With samples X_n at unit distance,

    x(u) = sum_n X_n K(u - n),    K(v) = sum_k c_k cos(2 pi k v/L) for |v| < L/2, else 0,

so that between two samples the signal is a sum of harmonics k/L, which the exact propagator takes
as they are. The coefficients minimise the largest deviation, over all frequencies up to
`HIGHEST`, of K's transform from 1 in the band, and from 0 at its images; K and its first three
derivatives vanish at the ends. The largest deviation is 4e-6.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel

Array = NDArray[np.float64]
HIGHEST = 1 / 4.4  # turns per sample
REACH = 14  # samples: L
BEFORE = REACH // 2 - 1  # samples of an interval before its first
COEFFICIENTS = np.array(
    [
        0.0714283039018265,
        0.142857434492257,
        0.142857526503936,
        0.142857597345263,
        0.142387887955343,
        0.134455818008678,
        0.102925342338607,
        0.0522063160814143,
        0.014229083067358386,
        0.0014509778394585845,
    ]
)


@kernel
def _fill(places, coefficients, out):
    for i in range(len(places)):
        for m in range(REACH):
            total = 0.0
            for k in range(len(coefficients)):
                angle = 2 * math.pi * k * (places[i] + BEFORE - m) / REACH
                total += coefficients[k] * math.cos(angle)
            out[i, m] = total


def weights(places: Array) -> Array:
    """Return the weights of the samples around an interval.

    Parameters
    ----------
    places : ndarray, shape (n,)
        Within the interval, from 0 to 1.

    Returns
    -------
    ndarray, shape (n, REACH)
        Of the samples from `BEFORE` before the interval's first on.
    """
    out = np.empty((len(places), REACH))
    _fill(places, COEFFICIENTS, out)
    return out


@kernel
def set_phasors(samples, first, coefficients, phasor):
    """Set the harmonics of one interval.

    Parameters
    ----------
    samples : ndarray, shape (k,)
    first : int
        Number of the interval; that number of the samples is the first of its `REACH`.
    coefficients : ndarray, shape (K,)
    phasor : ndarray, shape (2, K)
        Set so that the signal is the real part of their sum, each turned by k/`REACH` per sample
        since the start of interval 0.
    """
    for k in range(len(coefficients)):
        re = im = 0.0
        for m in range(REACH):
            angle = 2 * math.pi * (k * (first + m - BEFORE) % REACH) / REACH
            re += samples[first + m] * math.cos(angle)
            im -= samples[first + m] * math.sin(angle)
        phasor[0, k], phasor[1, k] = coefficients[k] * re, coefficients[k] * im
