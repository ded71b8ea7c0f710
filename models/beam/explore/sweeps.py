"""Settled responses of many beams, each from its own start or from its neighbour's response."""

from collections.abc import Iterator
from types import ModuleType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from models.beam import exact
from models.beam.batch import PROPAGATORS
from models.beam.parameters import Rows, Settings
from models.beam.response.settling import Response, settle
from models.beam.structure.modal import Array, Record, beams

Sweep = Literal["none", "up", "down"]
Settled = tuple[NDArray[np.intp], Response, Record]


def settled_rows(
    p: Rows, gaps: Array, settings: Settings, sweep: Sweep, periods: int
) -> Iterator[Settled]:
    """Settle n beams at their gaps [X0], and trace them over some periods more.

    Yields
    ------
    rows : ndarray of int
        Which of the n beams these are.
    settled : Response
    record : Record
        Of the further periods.
    """
    if sweep not in ("none", "up", "down"):
        raise ValueError(f"sweep must be 'none', 'up' or 'down', not {sweep!r}")
    if sweep != "none" and settings.residual_flexibility:
        raise ValueError("a sweep is by the exact propagator, without residual_flexibility")
    b = beams(p, settings)
    propagator = PROPAGATORS[settings.propagator] if sweep == "none" else exact
    u, v = p.initial_displacement / p.initial_gap, p.initial_velocity / p.initial_gap

    def look(system: Any, state: Array, at: Array) -> tuple[Response, Record]:
        settled = settle(propagator, system, state, at)
        still = np.zeros_like(at)
        return settled, propagator.advance(system, state, at.copy(), still, periods, trace=True)

    for rows, system in propagator.groups(b, settings):
        state = propagator.start(system, u[rows], v[rows])
        if sweep == "none":
            yield rows, *look(system, state, gaps[rows])
            continue
        order = rows if sweep == "up" else rows[::-1]
        before, now = order[0], state[order[:1]]
        m = system.modal.shape[1]
        for row in order:
            one = np.array([row])
            if np.isfinite(now).all():
                # The state holds velocities per radian of the force.
                now[:, m : 2 * m] *= b.forcing[before] / b.forcing[row]
            else:  # the neighbour was lost
                now = state[one]
            yield one, *look(system.take(one), now, gaps[one])
            before = row


def upcrossing_rates(trace: Array, level: float) -> Array:
    """Return the slopes, per sample, with which a trace rises through a level.

    By the cubic through the two samples before and the two after.
    """
    below = trace[1:-2] < level
    k = 1 + np.flatnonzero(below & (trace[2:-1] >= level))
    y = np.stack([trace[k - 1], trace[k], trace[k + 1], trace[k + 2]]) - level
    c1 = -y[0] / 3 - y[1] / 2 + y[2] - y[3] / 6
    c2 = y[0] / 2 - y[1] + y[2] / 2
    c3 = (y[3] - y[0]) / 6 + (y[1] - y[2]) / 2
    s = -y[1] / (y[2] - y[1])
    for _ in range(3):
        slope = c1 + s * (2 * c2 + 3 * s * c3)
        off = y[1] + s * (c1 + s * (c2 + s * c3))
        s = np.clip(s - np.divide(off, slope, out=np.zeros_like(s), where=slope > 0), 0.0, 1.0)
    return c1 + s * (2 * c2 + 3 * s * c3)


def one_system(p: Rows, settings: Settings) -> tuple[ModuleType, Any]:
    """Return the propagator of one beam, and what it prepares."""
    b = beams(p, settings)
    for propagator in (PROPAGATORS[settings.propagator], exact):
        for _, system in propagator.groups(b, settings):
            return propagator, system
    raise AssertionError("the exact propagator takes any beam")
