"""The beam as one would write it with numba: Newmark's average acceleration, one row at a time."""

import math

import numba
import numpy as np


@numba.njit(cache=True)
def newmark(frequency, decay, mobility, force, stiffness, forcing, gaps, steps, transient, periods):
    """Advance one beam from rest; return its mean nondimensional work per period and site.

    Parameters
    ----------
    frequency, decay, mobility : ndarray, shape (m,)
        As in `models.beam.modal.Beams`.
    force, stiffness, forcing : float
    gaps : ndarray, shape (2,)
    steps, transient, periods : int
        Steps per period; periods left out of the mean, and in it.

    Returns
    -------
    ndarray, shape (2,)
    """
    m = len(frequency)
    h = 2 * np.pi / (forcing * steps)
    z, v, a = np.zeros(m), np.zeros(m), np.zeros(m)
    inertia = 1 + decay * h + (frequency * h / 2) ** 2
    share = mobility / inertia
    give = h * h / 4 * share.sum() * stiffness
    for i in range(m):
        a[i] = mobility[i] * force
    work = np.zeros(2)
    last = 0.0
    for n in range((transient + periods) * steps):
        drive = force * math.cos(2 * np.pi * ((n + 1) % steps) / steps)
        x = 0.0
        for i in range(m):
            z[i] += h * v[i] + h * h / 4 * a[i]
            v[i] += h / 2 * a[i]
            a[i] = share[i] * drive - (2 * decay[i] * v[i] + frequency[i] ** 2 * z[i]) / inertia[i]
            x += z[i] + h * h / 4 * a[i]
        p = (max(x - gaps[0], 0.0) - max(-x - gaps[1], 0.0)) / (1 + give)
        for i in range(m):
            a[i] -= share[i] * stiffness * p
            z[i] += h * h / 4 * a[i]
            v[i] += h / 2 * a[i]
        if n >= transient * steps:
            work[0] += 0.5 * abs(max(p, 0.0) ** 2 - max(last, 0.0) ** 2)
            work[1] += 0.5 * abs(max(-p, 0.0) ** 2 - max(-last, 0.0) ** 2)
        last = p
    return work / periods
