"""The return map at the Poincare section x_c = +x_1, v > 0 (eqs 2 to 4 of Knudsen & Massih 2002).

A point on the section is a state and the phase of the force at which it is passed. The map's
multipliers at a fixed point are those of the stroboscopic map: a displacement (dy, dtheta) from a
point of the flow y' = f along the section is dy - f dtheta at constant phase of the force, and the
flow carries the one wherever it carries the other.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.exact.events import RIGHT
from models.beam.exact.passage import passage
from models.beam.exact.phases import Phase
from models.beam.exact.tuning import Beam
from models.beam.structure.modal import Array

LONGEST = 64  # forcing periods within which the tip must come back


class Return(NamedTuple):
    """Where the tip next meets the right stop.

    Attributes
    ----------
    state : ndarray, shape (2 m,)
        z and dz/d(Omega t) of each mode there, in initial gaps; NaN if it does not come back.
    phase : float
        Of the force there, counted on from the phase of departure [rad].
    jacobian : ndarray, shape (2 m, 2 m)
        Derivative of (phase, state less its first component) with respect to the same before: on
        the section the first component follows from the others.
    """

    state: Array
    phase: float
    jacobian: Array


def first_crossing(beam: Beam, state: Array, gaps: Array) -> tuple[Array, float]:
    """Follow the tip from phase 0 of the force to its first crossing of the section.

    Parameters
    ----------
    beam : Beam
    state : ndarray, shape (2 m,)
    gaps : ndarray, shape (2,)
        In initial gaps.

    Returns
    -------
    state : ndarray, shape (2 m,)
        On the section; NaN if the tip does not get there.
    phase : float
        Of the force [rad].
    """
    flow = passage(beam, state, gaps, periods=LONGEST, to_section=True)
    if flow.contacts[RIGHT] == 0:
        return np.full_like(state, np.nan), np.nan
    return flow.state, flow.phase


def return_map(beam: Beam, state: Array, phase: float, gaps: Array) -> Return:
    """Follow the tip from one crossing of the section to the next (eq 3).

    Parameters
    ----------
    beam : Beam
    state : ndarray, shape (2 m,)
        With sum of displacements +x_1 and sum of velocities > 0.
    phase : float
        Of the force [rad].
    gaps : ndarray, shape (2,)
        In initial gaps.

    Returns
    -------
    Return

    Raises
    ------
    ValueError
        If the state is not on the section.
    """
    m = len(state) // 2
    x, v = state[:m].sum(), state[m:].sum()
    if abs(x - gaps[RIGHT]) > 1e-9 * gaps[RIGHT] or not v > 0:
        raise ValueError(f"must have x = x_1 = {gaps[RIGHT]!r} and v > 0: x = {x!r}, v = {v!r}")
    turns, theta = divmod(phase, 2 * np.pi)
    end = passage(beam, state, gaps, theta, LONGEST, to_section=True)
    size = len(state)
    if end.contacts[RIGHT] == 0:
        return Return(np.full(size, np.nan), np.nan, np.full((size, size), np.nan))
    after = _on_section(_rate(beam.free, end.state, end.phase))
    before = _on_section(_rate(beam.free, state, phase))
    flow = end.tangents[:, :size]
    jacobian: Any = np.linalg.solve(after, flow @ before)
    return Return(end.state, end.phase + 2 * np.pi * turns, jacobian)


def _rate(phase: Phase, state: Array, theta: float) -> Array:
    """Return dy/d(Omega t) at force phase theta: at the face of a stop, that of free flight."""
    rate, shape, dual = phase.rate[0] + 1j * phase.rate[1], _whole(phase.shape), _whole(phase.dual)
    steady = shape[1] * np.exp(1j * theta)
    decaying = (rate * ((state - steady.real) @ dual)) @ shape
    return (1j * steady + decaying).real


def _whole(parts: Array) -> NDArray[np.complex128]:
    return parts[:, 0] + 1j * parts[:, 1]


def _on_section(rate: Array) -> Array:
    """Return the displacements at constant phase for unit steps of (phase, state less its first).

    Within the section the displacements of the modes add up to nothing.
    """
    size = len(rate)
    steps = np.eye(size)
    steps[0, 1 : size // 2] = -1.0
    steps[:, 0] = -rate
    return steps
