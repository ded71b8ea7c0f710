"""Settled responses of many beams, each from its own start or from its neighbour's final state."""

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from models.beam import exact
from models.beam.exact.one_beam import velocities
from models.beam.parameters import Params, Rows, Settings
from models.beam.response.response import Response
from models.beam.response.settling import settle
from models.beam.start import PROPAGATORS, initial_state
from models.beam.structure.modal import Array, beams
from models.beam.structure.propagation import Record

Sweep = Literal["none", "up", "down"]
Settled = tuple[NDArray[np.intp], Response, Record, Array]


def settled_rows(
    p: Rows, gaps: Array, settings: Settings, sweep: Sweep, periods: int
) -> Iterator[Settled]:
    """Settle n beams at their gaps [X0], and trace them over further periods.

    Yields
    ------
    rows : ndarray of int
        Indices of these among the n beams.
    settled : Response
    record : Record
        Of the further periods.
    speed : ndarray
        The tip's dx/d(Omega t) along its trace.

    Raises
    ------
    ValueError
        If `sweep` is not one of the three, or is not ``none`` with residual flexibility.
    """
    if sweep not in ("none", "up", "down"):
        raise ValueError(f"sweep must be 'none', 'up' or 'down', not {sweep!r}")
    if sweep != "none" and settings.residual_flexibility:
        raise ValueError("a sweep requires the exact propagator, without residual_flexibility")
    b = beams(p, settings)
    propagator = PROPAGATORS[settings.propagator] if sweep == "none" else exact

    def look(system: Any, state: Array, at: Array) -> tuple[Response, Record, Array]:
        settled = settle(propagator, system, state, at)
        begin, still = state.copy(), np.zeros_like(at)
        record = propagator.advance(system, state, at.copy(), still, periods, trace=True)
        return settled, record, propagator.speeds(system, begin, at, record.trace)

    for rows, system in propagator.groups(b, settings):
        state = initial_state(propagator, system, Params._make(field[rows] for field in p))
        if sweep == "none":
            yield rows, *look(system, state, gaps[rows])
            continue
        order = rows if sweep == "up" else rows[::-1]
        before, now = order[0], state[order[:1]]
        for row in order:
            index = np.array([row])
            if np.isfinite(now).all():
                speeds = velocities(now)
                speeds *= b.forcing[before] / b.forcing[row]
            else:  # the neighbour could not be followed
                now = state[index]
            yield index, *look(system.take(index), now, gaps[index])
            before = row
