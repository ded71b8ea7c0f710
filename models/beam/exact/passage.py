"""The variational flow of the exact propagator: an orbit, its tangents and its contacts.

Contact is elastic, so the vector field is continuous where phases meet, the saltation matrices are
the identity, and tangents cross events unchanged. Within a phase they are exact: see
`models.beam.exact.within_phase.carry`. A gap shifts the rest position of a contact, so its tangent,
less that shift, is carried like any other.

The forcing frequency enters through the time Omega t. In real time t only the steady response Z
depends on it, and with D = diag(1, Omega) the state Y = D y obeys

    Y(t) = gap + Re(Z exp(i theta)) + Phi(t - t_0) (Y_0 - gap - Re(Z exp(i theta_0))),

which is differentiated at constant phase theta of the force.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.exact.events import (
    EVALUATIONS_PER_PERIOD,
    NOWHERE,
    RIGHT,
    nearest_turn,
    next_event,
    scratch,
    site_of,
)
from models.beam.exact.tuning import Beam
from models.beam.exact.within_phase import carry, join
from models.beam.structure.modal import Array
from models.numerics.jit import kernel

_SECTION = 1e-9  # distance from the section, relative to the gap, within which a point is on it
IMPACTS = 64  # right-site impacts of a passage whose velocities are recorded, at most


class Passage(NamedTuple):
    """The motion of a beam between two phases of the force, at constant gaps.

    Attributes
    ----------
    state : ndarray, shape (2 m,)
        z and dz/d(Omega t) of each mode at the end.
    phase : float
        Of the force at the end, Omega t.
    tangents : ndarray, shape (2 m, 2 m + 3)
        Derivatives of `state` with respect to the first state, the right and the left gap, and
        log Omega.
    work, peak : ndarray, shape (2,)
        Nondimensional impact work and deepest penetration at each site.
    contacts : ndarray of int, shape (2,)
        Contacts begun at each site.
    impacts : ndarray, shape (min(contacts[0], IMPACTS),)
        dx/d(Omega t) at the inward crossings of the right stop's face.
    clearance : float
        Smallest distance from a stop's face at which the tip turns, on either side of it: zero at
        grazing.
    """

    state: Array
    phase: float
    tangents: Array
    work: Array
    peak: Array
    contacts: NDArray[np.int64]
    impacts: Array
    clearance: float


def passage(
    beam: Beam,
    state: Array,
    gaps: Array,
    phase: float = 0.0,
    periods: int = 1,
    to_section: bool = False,
) -> Passage:
    """Follow a beam and its tangents.

    Parameters
    ----------
    beam : Beam
    state : ndarray, shape (2 m,)
        Not changed.
    gaps : ndarray, shape (2,)
        In initial gaps.
    phase : float
        Of the force, in [0, 2 pi).
    periods : int
        Whole periods of the force, counted from its phase 0, after which the passage ends.
    to_section : bool
        Whether to end the passage at the next crossing x = +x_1, v > 0.

    Returns
    -------
    Passage
        Its `state` is NaN beyond `models.beam.exact.events.EVALUATIONS_PER_PERIOD`.
    """
    size = len(state)
    y, tangents = state.copy(), np.eye(size, size + 3)
    work, peak, contacts = np.zeros(2), np.zeros(2), np.zeros(2, np.int64)
    impacts = np.empty(IMPACTS)
    end, clearance = _follow(
        *beam, y, gaps, phase, periods, to_section, tangents, work, peak, contacts, impacts
    )
    impacts = impacts[: contacts[RIGHT]]
    return Passage(y, end, tangents, work, peak, contacts, impacts, clearance)


@kernel
def _follow(
    free,
    contact,
    detuning,
    y,
    gaps,
    theta,
    periods,
    to_section,
    tangents,
    work,
    peak,
    contacts,
    impacts,
):
    """Follow y and its tangents; return the phase of the force and the clearance."""
    size = len(y)
    m = size // 2
    room = scratch(free, contact)
    modal = np.empty((2, len(room.weight[0]), tangents.shape[1]))
    for i in range(m, len(y)):
        tangents[i, size + 2] += y[i]
    clearance = math.inf
    x, v = y[:m].sum(), y[m:].sum()
    on_section = to_section and v > 0 and x >= gaps[RIGHT] * (1 - _SECTION)
    site = RIGHT if on_section else site_of(x, gaps)
    period = evaluations = 0
    while period < periods:
        to_end = 2 * math.pi - theta
        kind = 0 if site == NOWHERE else 1
        phase = free if site == NOWHERE else contact
        event = next_event(phase, y, gaps, site, theta, to_end, room)
        evaluations += event.effort
        if evaluations >= EVALUATIONS_PER_PERIOD * periods:
            y[:] = tangents[:] = math.nan
            break
        clearance = min(clearance, nearest_turn(phase, gaps, event.after, room))
        join(phase, room.coefficient, event.after, room.power, y)
        until = theta + event.after if event.after < to_end else 2 * math.pi
        _shift(-1.0, phase, detuning[kind], site, theta, tangents)
        carry(phase, room.power, tangents, modal)
        _shift(1.0, phase, detuning[kind], site, until, tangents)
        _stretch(phase, room, event.after, tangents)
        theta = until
        if site != NOWHERE:
            work[site] += event.work
            peak[site] = max(peak[site], event.deepest)
        elif event.site != NOWHERE:
            if event.site == RIGHT and contacts[RIGHT] < len(impacts):
                impacts[contacts[RIGHT]] = y[m:].sum()
            contacts[event.site] += 1
            if to_section and event.site == RIGHT:
                break
        site = event.site
        if theta == 2 * math.pi:
            theta = 0.0
            period += 1
    for i in range(m, len(y)):
        tangents[i, size + 2] -= y[i]
    return theta + 2 * math.pi * period, clearance


@kernel
def _shift(sign, phase, detuning, site, theta, tangents):
    """Add, or subtract, the part of the tangents to gap and frequency that does not decay."""
    size = len(tangents)
    c, e = math.cos(theta), math.sin(theta)
    for i in range(size):
        tangents[i, size + 2] += sign * (detuning[0, i] * c - detuning[1, i] * e)
        if site != NOWHERE:
            side = 1.0 if site == RIGHT else -1.0
            tangents[i, size + site] += sign * side * phase.shape[0, 0, i]


@kernel
def _stretch(phase, room, s, tangents):
    """Account for the real time s/Omega of a phase, which is shorter at a higher frequency."""
    size = len(tangents)
    for k in range(2, len(phase.speed)):
        c, e = room.coefficient[0, k], room.coefficient[1, k]
        u, v = 1 + room.power[0, k], room.power[1, k]
        a, b = c * u - e * v, c * v + e * u
        u, v = phase.rate[0, k] * s, phase.rate[1, k] * s
        a, b = a * u - b * v, a * v + b * u
        for i in range(size):
            tangents[i, size + 2] -= phase.shape[k, 0, i] * a - phase.shape[k, 1, i] * b
