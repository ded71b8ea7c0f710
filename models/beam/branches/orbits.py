"""Periodic orbits of the beam at constant gaps, by Newton's method, and their stability.

An orbit of period k is a fixed point of the stroboscopic map over k forcing periods. Its Floquet
multipliers, the eigenvalues of the map's Jacobian, are also those of the return map at the section
x = +x_1, v > 0 (eqs 2 to 4 of Knudsen & Massih 2002). Stability ends where one reaches modulus 1.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.exact.events import LEFT, RIGHT
from models.beam.exact.passage import Passage, passage
from models.beam.exact.tuning import Beam
from models.beam.structure.modal import Array
from models.numerics.newton import Linear, find_root

TOLERANCE = 1e-11  # of the state after a period, relative to the state
SYMMETRIC = 1e-6  # difference of the sites' work, relative to their sum
_ROUNDING = 1e-7  # of a double multiplier
_SAME = 1e-6  # between states a divisor of the period apart, relative to the state

_CLOSE = 0.1  # farthest a settled beam may be from its orbit, relative to the state
_ROUND, _ROUNDS = 128, 16  # forcing periods between two checks, and checks

Outcome = Literal["converged", "stalled", "singular", "unstable", "far"]


class Orbit(NamedTuple):
    """A periodic orbit, or the outcome of a failed search for one.

    Attributes
    ----------
    state : ndarray, shape (2 m,)
        z and dz/d(Omega t) of each mode at phase 0 of the force, in initial gaps.
    period : int
        In forcing periods: the smallest period, even if a multiple of it was requested.
    gaps : ndarray, shape (2,)
        Right and left, in initial gaps.
    multipliers : ndarray, shape (2 m,), complex
        Of the stroboscopic map over the period, the largest modulus first.
    work : ndarray, shape (2,)
        Mean dimensionless impact work per forcing period at each site.
    peak : ndarray, shape (2,)
        Deepest penetration at each site, in initial gaps.
    impact_velocities : ndarray
        dx/d(Omega t) at the crossings x = +x_1, v > 0 of a period, in initial gaps.
    contacts : ndarray of int, shape (2,)
        Contacts begun at each site in a period.
    clearance : float
        Smallest distance from a stop's face at which the tip turns, on either side, in initial
        gaps: 0 at grazing.
    residual : float
        Largest component of the state's change over the period.
    iterations : int
        Of Newton's method.
    distance : float
        From the guess to the state, relative to the state (Euclidean).
    outcome : str
        ``converged``; ``stalled`` or ``singular`` if Newton's method failed; ``unstable`` or
        ``far`` if it found an orbit other than requested.
    """

    state: Array
    period: int
    gaps: Array
    multipliers: NDArray[np.complex128]
    work: Array
    peak: Array
    impact_velocities: Array
    contacts: NDArray[np.int64]
    clearance: float
    residual: float
    iterations: int
    distance: float
    outcome: Outcome

    @property
    def is_stable(self) -> bool:
        """Whether no multiplier is outside the unit circle."""
        return not np.isnan(self.multipliers[0]) and self.unstable_directions == 0

    @property
    def unstable_directions(self) -> int:
        """Number of multipliers outside the unit circle by more than rounding."""
        return int((np.abs(self.multipliers) > 1 + _ROUNDING).sum())

    @property
    def is_symmetric(self) -> bool:
        """Whether the work is equal at both sites."""
        return bool(abs(self.work[RIGHT] - self.work[LEFT]) <= SYMMETRIC * self.work.sum())


def find_orbit(
    beam: Beam,
    state: Array,
    gaps: Array,
    period: int = 1,
    stable_only: bool = False,
    farthest: float = np.inf,
) -> Orbit:
    """Find a periodic orbit from a state near it.

    Parameters
    ----------
    beam : Beam
    state : ndarray, shape (2 m,)
        A guess at phase 0 of the force.
    gaps : ndarray, shape (2,)
        In initial gaps.
    period : int
        In forcing periods.
    stable_only : bool
        Whether to reject an unstable orbit.
    farthest : float
        Distance from the guess, relative to the orbit's state, beyond which an orbit is rejected;
        also the longest step of Newton's method.

    Returns
    -------
    Orbit
        See its `outcome`.
    """
    size = float(np.linalg.norm(state)) or 1.0
    root = find_root(
        lambda y: defect(passage(beam, y, gaps, periods=period), y),
        state,
        TOLERANCE * size,
        longest=min(farthest, 0.5) * size,
    )
    motion: Passage = root.linear.about
    outcome: Outcome = root.outcome
    if outcome == "converged":
        for divisor in (q for q in range(1, period) if period % q == 0):
            part = passage(beam, root.state, gaps, periods=divisor)
            if np.linalg.norm(part.state - root.state) < _SAME * size:
                motion, period = part, divisor
                break
    orbit = orbit_of(motion, root.state, gaps, period)
    distance = np.linalg.norm(root.state - state) / (np.linalg.norm(root.state) or 1.0)
    if outcome == "converged" and distance > farthest:
        outcome = "far"
    elif outcome == "converged" and stable_only and not orbit.is_stable:
        outcome = "unstable"
    return orbit._replace(iterations=root.iterations, distance=float(distance), outcome=outcome)


def settled_orbit(beam: Beam, state: Array, gaps: Array, period: int = 1) -> Orbit:
    """Let a beam settle and find the stable orbit that it approaches.

    Parameters
    ----------
    beam : Beam
    state : ndarray, shape (2 m,)
        At phase 0 of the force.
    gaps : ndarray, shape (2,)
        In initial gaps.
    period : int
        In forcing periods.

    Returns
    -------
    Orbit

    Raises
    ------
    ValueError
        If the beam does not settle on an orbit of this period, or `period` is not positive.
    """
    if period < 1:
        raise ValueError(f"period must be positive: {period!r}")
    for _ in range(_ROUNDS):
        orbit = find_orbit(beam, state, gaps, period, stable_only=True, farthest=_CLOSE)
        if orbit.outcome == "converged" and orbit.period == period:
            return orbit
        state = passage(beam, state, gaps, periods=_ROUND).state
    raise ValueError(
        f"the beam does not settle on an orbit of period {period} from this state within "
        f"{_ROUNDS * _ROUND} forcing periods: try another state or period"
    )


def defect(motion: Passage, state: Array, by_parameter: Array | None = None) -> Linear:
    """Return the change of a state over a passage, and its derivatives."""
    size = len(state)
    by_state = motion.tangents[:, :size] - np.eye(size)
    along = np.zeros(size) if by_parameter is None else by_parameter
    return Linear(motion.state - state, by_state, along, motion)


def orbit_of(motion: Passage, state: Array, gaps: Array, period: int) -> Orbit:
    """Describe the orbit of a passage over one period."""
    flow = motion.tangents[:, : len(state)]
    finite = np.isfinite(flow).all()
    multipliers = np.linalg.eigvals(flow) if finite else np.full(len(state), np.nan)
    order = np.argsort(-np.abs(multipliers))
    return Orbit(
        state,
        period,
        gaps,
        multipliers[order].astype(complex),
        motion.work / period,
        motion.peak,
        motion.impacts,
        motion.contacts,
        motion.clearance,
        float(np.abs(motion.state - state).max()),
        0,
        0.0,
        "converged",
    )
