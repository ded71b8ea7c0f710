"""The stable orbits that many beams approach at once, by Newton's method on the map of k periods.

A beam's state is near an orbit if steps with the Jacobian at its first point shrink fast: the map
is then nearly linear between the two, and a stable orbit is the one that the beam approaches. A
step that is long, or not much shorter than the one before, ends the search.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, Record, System
from models.numerics.linear import inverse, product
from models.numerics.multipliers import largest_multiplier

_FARTHEST = 0.3  # longest first step, relative to the response
_FASTER = 0.3  # largest ratio of a step to the one before
_LAST = 1e-6  # last step, relative to the response
_STEPS = 12
_SAME = 1e-5  # distance of equal strobe points, relative to the response


class Approached(NamedTuple):
    """The orbits that n beams approach.

    Attributes
    ----------
    exists : ndarray of bool, shape (n,)
        Where there is a stable orbit near the state; elsewhere the other fields are undefined.
    state : ndarray, shape (n, k)
        On the orbit.
    work : ndarray, shape (n, 2)
        Mean dimensionless work per forcing period at the right and the left site.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    period : ndarray of int, shape (n,)
        The smallest, in forcing periods.
    multiplier : ndarray, shape (n,)
        Largest modulus of the Floquet multipliers over that period.
    """

    exists: NDArray[np.bool_]
    state: Array
    work: Array
    peak: Array
    period: NDArray[np.int64]
    multiplier: Array


class _Map(NamedTuple):
    """The map of k periods of n beams at constant gaps, strobed at phase 0 of the force."""

    propagator: Propagator
    system: System
    gaps: Array
    periods: int

    def take(self, rows: NDArray[np.intp]) -> "_Map":
        return self._replace(system=self.system.take(rows), gaps=self.gaps[rows])

    def advance(self, state: Array) -> tuple[Array, Record]:
        """Return the image of the state, and the record of the motion."""
        image, gaps = state.copy(), self.gaps.copy()
        still = np.zeros_like(gaps)
        record = self.propagator.advance(self.system, image, gaps, still, self.periods)
        clock = self.propagator.CLOCK
        image[:, clock] = state[:, clock]  # the clock is not periodic
        return image, record

    def derivative(self, state: Array) -> Array:
        return self.propagator.monodromy(self.system, state, self.gaps, self.periods)


def approached(
    propagator: Propagator, system: System, state: Array, gaps: Array, size: Array, periods: int
) -> Approached:
    """Find the stable orbits of k periods, or of a divisor of k, that n beams approach.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    state : ndarray, shape (n, k)
        Not changed.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    size : ndarray, shape (n,)
        Size of the response: its largest displacement and velocity, in initial gaps.
    periods : int

    Returns
    -------
    Approached
    """
    n = len(state)
    strobed = _Map(propagator, system, gaps, periods)
    fixed = state.copy()
    rows = _fixed_points(strobed, fixed, size)
    out = Approached(
        np.zeros(n, bool),
        fixed,
        np.zeros((n, 2)),
        np.zeros((n, 2)),
        np.full(n, periods),
        np.full(n, np.inf),
    )
    if not len(rows):
        return out
    orbits = strobed.take(rows)
    out.multiplier[rows] = largest_multiplier(orbits.derivative(fixed[rows]))
    out.exists[:] = out.multiplier < 1
    _, record = orbits.advance(fixed[rows])
    out.work[rows], out.peak[rows] = record.work.mean(axis=1), record.peak
    for divisor in range(periods - 1, 0, -1):
        if periods % divisor == 0:
            apart = np.abs(record.strobe[:, divisor - 1] - record.strobe[:, -1]).max(axis=1)
            out.period[rows[apart <= _SAME * size[rows]]] = divisor
    out.multiplier[:] **= out.period / periods
    return out


def _fixed_points(strobed: _Map, state: Array, size: Array) -> NDArray[np.intp]:
    """Move states to nearby fixed points of the map; return the rows where there is one."""
    by_residual, regular = inverse(np.eye(state.shape[1]) - strobed.derivative(state))
    converged = np.zeros(len(state), bool)
    left, going, longest = np.arange(len(state)), regular, _FARTHEST * size
    for _ in range(_STEPS):
        if not going.all():
            rows = np.flatnonzero(going)
            left, by_residual, strobed = left[rows], by_residual[rows], strobed.take(rows)
        if not len(left):
            break
        image, _ = strobed.advance(state[left])
        residual = (image - state[left])[:, :, None]
        step = product(by_residual, residual)[:, :, 0]
        state[left] += step
        length = np.abs(step).max(axis=1)
        shrinking = length <= longest[left]
        longest[left] = _FASTER * length
        last = shrinking & (length <= _LAST * size[left])
        converged[left[last]] = True
        going = shrinking & ~last
    return np.flatnonzero(converged)
