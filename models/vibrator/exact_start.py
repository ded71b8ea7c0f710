"""From standstill to the outcome with the exact propagator, one machine after the other.

For machines on flexible mounts, with feed or with exact kinematics, and as the yardstick of
rigid ones. A run-up is watched in looks of eight turns. Once the vibrators keep step, their
synchronous running is found as a periodic orbit; the run stops as soon as it stays near that orbit,
if it is stable, and goes on to the end where it does not.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.dop853 import OUT_OF_BUDGET, STUCK
from models.vibrator import exact
from models.vibrator.exact_orbit import Machine, Orbit, anchored, find_orbit, prepare, proposal
from models.vibrator.measures import excursion, measure, refine
from models.vibrator.outcome import (
    ASYNCHRONOUS,
    BAND,
    CAPTURED_BELOW,
    Outcome,
    locked_regime,
    unlocked_regime,
    wrapped,
)
from models.vibrator.parameters import Params, Rows, Settings
from models.vibrator.system import System
from uq.contract import Status

SAMPLES_PER_TURN = 32  # at the larger synchronous speed
TURNS = 8  # in a look
LOOK = SAMPLES_PER_TURN * TURNS
BUDGET = 80_000  # steps of one machine, searches of orbits included: about a second
_NEAR = 0.03  # of the orbit's disphasing angle: certain to stay [rad]
_ALIKE = 0.01  # of the orbit's speed, likewise
_STEADY = 0.02  # range of the disphasing angle in a look that is worth a search [rad]
_LOCKED = 0.2  # range in the last second below which motors are locked [rad]
_LAST = 1.0  # [s]


class Track:
    """A run-up sampled at equal intervals of time, as far as it has gone.

    Attributes
    ----------
    interval : float
        [s]
    count : int
        Samples after the first.
    excursion : float
        Largest displacement of C so far [m].
    """

    def __init__(self, state: NDArray[np.float64], interval: float) -> None:
        self.interval = interval
        self.count = 0
        self.excursion = 0.0
        self._keep = math.ceil(_LAST / interval) + 1
        self._states = state[None]
        self._angles = [self._angle(self._states)]

    @staticmethod
    def _angle(states: NDArray[np.float64]) -> NDArray[np.float64]:
        rate = states.shape[1] // 2
        return np.stack([states[:, 3] - states[:, 4], states[:, rate + 3] - states[:, rate + 4]])

    def add(self, samples: NDArray[np.float64]) -> None:
        """Append samples."""
        joined = np.concatenate([self._states[-1:], samples])
        self.excursion = max(self.excursion, excursion(joined, self.interval))
        self.count += len(samples)
        self._states = np.concatenate([self._states, samples])[-max(self._keep, LOOK + 1) :]
        self._angles.append(self._angle(samples))

    @property
    def time(self) -> float:
        """Of the last sample [s]."""
        return self.count * self.interval

    def last(self, samples: int = 0) -> NDArray[np.float64]:
        """Return the last states, one more than so many; those of the last second by default."""
        return self._states[-(samples + 1 if samples else self._keep) :]

    def last_time_off(self, mean: float) -> float:
        """Return the last time psi_1 - psi_2 is out of the band about its mean, 0 if never."""
        angle, rate = np.concatenate(self._angles, axis=1)
        off = wrapped(angle - mean)
        out = np.flatnonzero(np.abs(off) > BAND)
        if not len(out):
            return 0.0
        i = out[-1]
        if i == self.count:
            return self.time
        # Unwrapped: both ends on the branch of the first.
        ends = off[i] + angle[i : i + 2] - angle[i]
        gap = np.abs(wrapped(refine(ends[:, None], rate[i : i + 2, None], self.interval)[0]))
        k = np.flatnonzero(gap > BAND)[-1]
        part = (k + (gap[k] - BAND) / (gap[k] - gap[k + 1])) / (len(gap) - 1)
        return float(self.interval * (i + part))


def outcomes(p: Rows, settings: Settings) -> tuple[Outcome, NDArray[np.int8]]:
    """Switch on n machines and see what becomes of them.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    settings : Settings
        `propagator` and `steps_per_turn` do not matter here.

    Returns
    -------
    outcome : Outcome
    status : ndarray of int8, shape (n,)
        `OUT_OF_BUDGET` where the steps end before the longest start simulated; what is known is
        then of the last second before, if there is one. `NON_FINITE` where the motion is not
        finite; nothing is known of it.
    """
    n = len(p.body_mass)
    out, status = Outcome.nothing(n), np.zeros(n, np.int8)
    with np.errstate(all="ignore"):
        for i in range(n):
            params = Params._make(float(field[i]) for field in p)
            row = Outcome._make(field[i : i + 1] for field in out)
            status[i] = _switch_on(params, settings, row)
    return out, status


def _switch_on(params: Params, settings: Settings, out: Outcome) -> Status:
    """Set the outcome of one machine, fields of shape (1,)."""
    machine = prepare(params, settings.kinematics, BUDGET)
    state = exact.start(params, machine.system)
    speed = max(machine.system.synchronous_speed_1, machine.system.synchronous_speed_2)
    wanted = math.ceil(settings.run_up * speed * SAMPLES_PER_TURN / (2 * np.pi))
    track = Track(state, settings.run_up / wanted)
    guess = proposal(machine)
    orbit, next_search = None, LOOK
    while track.count < wanted:
        times = track.interval * np.arange(1, min(LOOK, wanted - track.count) + 1)
        ended, samples = machine.run(state, times[-1], settings.tolerance, times=times)
        if ended.status == STUCK or not np.isfinite(samples[: ended.sampled]).all():
            return Status.NON_FINITE
        track.add(samples[: ended.sampled])
        if ended.status == OUT_OF_BUDGET:
            return _describe_unfinished(machine.system, track, out)
        if orbit is not None and _stays_at(orbit, track):
            _describe_orbit(orbit, track, out)
            return Status.OK
        if track.count >= next_search and _is_steady(machine.system, track):
            orbit = _search(machine, guess, state, settings.tolerance) or orbit
            guess = None
            # Each search costs some dozens of turns; where they fail, ever fewer.
            next_search = 2 * track.count
    _describe_end(machine, track, orbit, state, settings.tolerance, out)
    return Status.OK
