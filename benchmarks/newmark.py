"""The beam as one would write it with numba: Newmark's average acceleration, one row at a time.

Written as a propagator, so that whatever drives `models.beam.exact` can drive it too.
"""

import math
from typing import NamedTuple

import numba
import numpy as np

from models.beam.structure.modal import Beams
from models.beam.structure.propagation import Record


class System(NamedTuple):
    """One beam and its steps in a forcing period."""

    beam: Beams
    steps: int


@numba.njit(cache=True)
def newmark(frequency, decay, mobility, force, stiffness, forcing, gaps, steps, state, work):
    """Advance one beam, from the beginning of a forcing period.

    Parameters
    ----------
    frequency, decay, mobility : ndarray, shape (m,)
        As in `models.beam.structure.modal.Beams`.
    force, stiffness, forcing : float
    gaps : ndarray, shape (2,)
    steps : int
        In a period.
    state : ndarray, shape (3 m + 1,)
        Displacements, velocities, accelerations and the last penetration; updated in place.
    work : ndarray, shape (periods, 2)
        Set to the dimensionless work of each period and site.
    """
    m = len(frequency)
    h = 2 * np.pi / (forcing * steps)
    z, v, a = state[:m], state[m : 2 * m], state[2 * m : 3 * m]
    inertia = 1 + decay * h + (frequency * h / 2) ** 2
    share = mobility / inertia
    give = h * h / 4 * share.sum() * stiffness
    last = state[3 * m]
    work[:] = 0.0
    for n in range(len(work) * steps):
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
        work[n // steps, 0] += 0.5 * abs(max(p, 0.0) ** 2 - max(last, 0.0) ** 2)
        work[n // steps, 1] += 0.5 * abs(max(-p, 0.0) ** 2 - max(-last, 0.0) ** 2)
        last = p
    state[3 * m] = last


def groups(beams, settings):
    """Prepare the first of some beams; the settings say how many steps."""
    yield np.array([0]), System(beams, settings.steps_per_period)


def start(system, displacement, velocity):
    """Return the state at rest; other starts are not needed here."""
    m = system.beam.frequency.shape[1]
    state = np.zeros((1, 3 * m + 1))
    state[0, 2 * m : 3 * m] = system.beam.mobility[0] * system.beam.force[0]
    return state


def advance(system, state, gaps, growth, periods):
    """Advance by whole periods at constant gaps."""
    b = system.beam
    record = Record.empty(1, periods)
    row = (b.frequency[0], b.decay[0], b.mobility[0], b.force[0], b.stiffness[0], b.forcing[0])
    newmark(*row, gaps[0], system.steps, state[0], record.work[0])
    return record
