"""The stable orbits that many beams approach at once, by Newton's method on the map of k periods.

A beam's state is near an orbit when Newton's steps from it shrink as they do where the map is
nearly linear: then a stable orbit is also the one that the beam comes to in time. A step that is
long, or not much shorter than the one before, ends the search.
"""

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.modal import Array
from models.numerics.linear import inverse
from models.numerics.multipliers import largest_multiplier

_FARTHEST = 0.3  # longest first step, relative to the response
_FASTER = 0.3  # each step over the one before, at most
_LAST = 1e-6  # a step so short, relative to the response, is the last one
_STEPS = 8
_SAME = 1e-5  # of strobe points, relative to the response


class Approached(NamedTuple):
    """The orbits that n beams approach.

    Attributes
    ----------
    found : ndarray of bool, shape (n,)
        Where there is a stable orbit near the state; nothing else is said of the others.
    state : ndarray, shape (n, k)
        On the orbit.
    work : ndarray, shape (n, 2)
        Mean nondimensional work per forcing period at the right and the left site.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    period : ndarray of int, shape (n,)
        In forcing periods, the shortest.
    multiplier : ndarray, shape (n,)
        Largest modulus of the Floquet multipliers over that period.
    """

    found: NDArray[np.bool_]
    state: Array
    work: Array
    peak: Array
    period: NDArray[np.int64]
    multiplier: Array


def approached(
    propagator: ModuleType, system: Any, state: Array, gaps: Array, size: Array, periods: int
) -> Approached:
    """Find the stable orbits of k periods, or of a divisor of k, that n beams approach.

    Parameters
    ----------
    propagator : module
        `models.beam.lanes` or `models.beam.exact`.
    system
        What the propagator prepared.
    state : ndarray, shape (n, k)
        Not changed.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    size : ndarray, shape (n,)
        Of the response: its largest displacement and velocity, in initial gaps.
    periods : int

    Returns
    -------
    Approached
    """
    n = len(state)
    out = Approached(
        np.zeros(n, bool),
        state.copy(),
        np.zeros((n, 2)),
        np.zeros((n, 2)),
        np.full(n, periods),
        np.full(n, np.inf),
    )
    inverted, left = _newton(propagator, system, state, gaps, periods)
    longest = _FARTHEST * size
    for _ in range(_STEPS):
        if not len(left):
            break
        residual = _advanced(propagator, system, out.state, gaps, periods, left)[0]
        steps = (inverted @ residual[:, :, None])[:, :, 0]
        out.state[left] += steps
        length = np.abs(steps).max(axis=1)
        going = length <= longest[left]
        longest[left] = _FASTER * length
        last = going & (length <= _LAST * size[left])
        out.found[left[last]] = True
        going &= ~last
        left, inverted = left[going], inverted[going]
    _describe(propagator, system, gaps, size, periods, out)
    return out


def _newton(propagator, system, state, gaps, periods):
    flow = propagator.monodromy(system, state, gaps, periods)
    inverted, regular = inverse(np.eye(state.shape[1]) - flow)
    rows = np.flatnonzero(regular)
    return inverted[rows], rows


def _advanced(propagator, system, state, gaps, periods, rows):
    here, at = state[rows], gaps[rows]
    there = here.copy()
    record = propagator.advance(system.take(rows), there, at, np.zeros_like(at), periods)
    return there - here, record


def _describe(
    propagator: ModuleType, system: Any, gaps: Array, size: Array, periods: int, out: Approached
) -> None:
    """Note work, peak and shortest period of the orbits that were found."""
    rows = np.flatnonzero(out.found)
    flow = propagator.monodromy(system.take(rows), out.state[rows], gaps[rows], periods)
    out.multiplier[rows] = largest_multiplier(flow)
    out.found[:] = out.multiplier < 1
    rows = np.flatnonzero(out.found)
    _, record = _advanced(propagator, system, out.state, gaps, periods, rows)
    out.work[rows], out.peak[rows] = record.work.mean(axis=1), record.peak
    for shorter in range(periods - 1, 0, -1):
        if periods % shorter == 0:
            apart = np.abs(record.strobe[:, shorter - 1] - record.strobe[:, -1]).max(axis=1)
            same = rows[apart <= _SAME * size[rows]]
            out.period[same] = shorter
    out.multiplier[rows] **= out.period[rows] / periods
