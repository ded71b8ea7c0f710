"""Settled responses of many rods in the states of their duty, each from the one before it.

Several stable responses may exist at the same gaps. A response is settled from that of the same
state of duty at the latest earlier time, so that a rod follows its branch as its gaps change.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Params, Rows, Settings
from models.beam.response.averages import NINE_IN_TEN
from models.beam.response.settling import settle
from models.beam.service.growth import FORCE, FREQUENCY, RANDOM_LEVEL
from models.beam.start import PROPAGATORS, initial_state
from models.beam.structure.modal import Array, beams, free_reach
from models.beam.structure.propagation import FIRST_MODE, Propagator, System
from models.beam.units import watt

_PUSH = 1e-6  # of the first mode [X0], to leave an orbit that has lost its stability
_SEGMENTS = 8  # in which a response is observed, at least: a life averages many of them


class _Settled(NamedTuple):
    """One response: its time [s], state and regime."""

    time: float
    state: Array
    regime: int


class _Group(NamedTuple):
    """Rods that are advanced together in one state of duty."""

    rows: NDArray[np.intp]
    system: System
    params: Rows


def _in_state(p: Rows, factors: Array) -> Rows:
    """Return the parameters of n beams in a state of duty."""
    return p._replace(
        force_amplitude=p.force_amplitude * factors[FORCE],
        forcing_frequency=p.forcing_frequency * factors[FREQUENCY],
        random_force_level=p.random_force_level * factors[RANDOM_LEVEL],
    )


def reach_of(p: Rows, duty: Array, settings: Settings, seed: NDArray[np.uint64]) -> Array:
    """Return a bound of the tips' displacements without contact [m], shape (n, s)."""
    reaches = [free_reach(beams(_in_state(p, factors), settings, seed)) for factors in duty]
    return np.stack(reaches, axis=1) * p.initial_gap[:, None]


class Responses:
    """Responses of n rods.

    Parameters
    ----------
    p : Params
        Of the beams, each field an ndarray of shape (n,).
    duty : ndarray, shape (s, 6)
    settings : Settings
    seed : ndarray of uint64, shape (n,)
    """

    def __init__(self, p: Rows, duty: Array, settings: Settings, seed: NDArray[np.uint64]) -> None:
        self._propagator: Propagator = PROPAGATORS[settings.propagator]
        self._gap = p.initial_gap
        self._states: list[list[_Group]] = []
        self.reach = np.zeros((len(seed), len(duty)))
        self._watt = np.empty_like(self.reach)
        for s, factors in enumerate(duty):
            q = _in_state(p, factors)
            groups = []
            for rows, system in self._propagator.groups(beams(q, settings, seed), settings):
                part: Rows = Params._make(field[rows] for field in q)
                groups.append(_Group(rows, system, part))
                self.reach[rows, s] = system.free_reach * self._gap[rows]
            self._states.append(groups)
            self._watt[:, s] = watt(q)
        self._settled: list[list[list[_Settled]]] = [[[] for _ in duty] for _ in seed]

    def settle(self, rows: NDArray[np.intp], times: Array, gaps: Array) -> tuple[Array, Array]:
        """Return the work-rates of some rods, and their standard errors.

        Parameters
        ----------
        rows : ndarray of int, shape (m,)
        times : ndarray, shape (m,)
            [s]
        gaps : ndarray, shape (m, s, 2)
            [m]; NaN where no response is asked for.

        Returns
        -------
        work, error : ndarray, shape (m, s, 2)
            [W]; NaN where no propagator can follow, 0 where no response is asked for.
        """
        work, error = np.zeros((2, *gaps.shape))
        for s, groups in enumerate(self._states):
            asked = np.isfinite(gaps[:, s, 0])
            work[asked, s] = np.nan
            for group in groups:
                here = np.flatnonzero(asked & np.isin(rows, group.rows))
                if len(here):
                    out = self._settle(group, s, rows[here], times[here], gaps[here, s])
                    to_watt = self._watt[rows[here], s, None]
                    # In lasting contact the sum of a period may be negative by rounding.
                    work[here, s] = np.maximum(out.work, 0.0) * to_watt
                    error[here, s] = out.error / NINE_IN_TEN * to_watt
        return work, error

    def _settle(
        self, group: _Group, s: int, rows: NDArray[np.intp], times: Array, gaps: Array
    ) -> Any:
        places = np.searchsorted(group.rows, rows)
        system = group.system.take(places)
        part: Rows = Params._make(field[places] for field in group.params)
        state = initial_state(self._propagator, system, part)
        for j, (row, time) in enumerate(zip(rows.tolist(), times.tolist(), strict=True)):
            before = self._before(row, s, time)
            if before is not None:
                state[j] = before.state
                state[j, FIRST_MODE] += _PUSH
        out = settle(self._propagator, system, state, gaps / self._gap[rows, None], _SEGMENTS)
        for j, (row, time) in enumerate(zip(rows.tolist(), times.tolist(), strict=True)):
            self._settled[row][s].append(_Settled(time, state[j].copy(), int(out.regime[j])))
        return out

    def _before(self, row: int, s: int, time: float) -> _Settled | None:
        """Return the last accepted response before a time; None without one.

        A rod that goes back in time has taken a step back: later responses were of this step. The
        end of a step is settled twice, both times from its beginning.
        """
        kept = [response for response in self._settled[row][s] if response.time <= time]
        self._settled[row][s] = kept
        earlier = [response for response in kept if response.time < time]
        chosen = earlier or kept
        return chosen[-1] if chosen else None

    def forget(self, rows: NDArray[np.intp]) -> None:
        """Forget the responses of some rods, as if none had been settled."""
        for row in rows.tolist():
            for settled in self._settled[row]:
                settled.clear()

    def regime_changes(self, row: int) -> int:
        """Return how often the regime of a rod has changed, in all states of duty."""
        changes = 0
        for settled in self._settled[row]:
            last = {
                response.time: response.regime for response in settled
            }  # a step is settled twice at its end
            regimes = [last[time] for time in sorted(last)]
            changes += sum(a != b for a, b in zip(regimes, regimes[1:], strict=False))
        return changes
