"""From standstill to the outcome with the exact propagator, one machine after the other.

For machines on flexible mounts, with feed or with exact kinematics, and as the reference for rigid
ones. A run-up is monitored in looks of eight turns. Once the vibrators keep step, their synchronous
running is found as a periodic orbit. If the orbit is stable, the run stops as soon as it stays near
it and free vibration of the body can no longer exceed the largest displacement; otherwise it
continues to the end.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.dop853 import OUT_OF_BUDGET, STUCK
from models.vibrator.equations.system import System
from models.vibrator.equations.time_scales import slowest_period
from models.vibrator.exact import propagator
from models.vibrator.exact.budgeted import Machine, prepare
from models.vibrator.exact.measures import Measures, measure
from models.vibrator.exact.orbit import Orbit, anchored, find_orbit, proposal
from models.vibrator.parameters import Params, Rows, Settings
from models.vibrator.start.instants import note_exactly, run_exactly
from models.vibrator.start.regimes import (
    ASYNCHRONOUS,
    BAND,
    CAPTURED_BELOW,
    Outcome,
    locked_regime,
    unlocked_regime,
    wrapped,
)
from models.vibrator.start.track import LAST, Track
from uq.contract import Status

SAMPLES_PER_TURN = 32  # at the larger synchronous speed
TURNS = 8  # per look
LOOK = SAMPLES_PER_TURN * TURNS
BUDGET = 150_000  # steps of one machine, including orbit searches: about two seconds
_LOOKING = 10  # overhead of a look, in steps
_NEAR = 0.03  # of the orbit's disphasing angle: certain to stay there [rad]
_ALIKE = 0.01  # of the orbit's speed, likewise
_STEADY = 0.02  # range of the disphasing angle in a look below which a search is worth while [rad]
_LOCKED = 0.2  # range in the last second below which an orbit is searched for [rad]
_UNSURE = 1e-6  # error of a multiplier by central differences


def outcomes(p: Rows, settings: Settings) -> tuple[Outcome, NDArray[np.int8]]:
    """Switch on n machines and find their outcomes.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    settings : Settings
        `propagator` and `steps_per_turn` are not used.

    Returns
    -------
    outcome : Outcome
    status : ndarray of int8, shape (n,)
        `OUT_OF_BUDGET` where the steps run out before the end of the longest start simulated; the
        outcome then describes the last second before, if there is one. `NON_FINITE` where the
        motion is not finite; its outcome is unknown.
    """
    n = len(p.body_mass)
    out, status = Outcome.nothing(n, len(settings.instants)), np.zeros(n, np.int8)
    with np.errstate(all="ignore"):
        for i in range(n):
            params = Params._make(float(field[i]) for field in p)
            row = Outcome._make(field[i : i + 1] for field in out)
            status[i] = _switch_on(params, settings, row)
    return out, status


def _switch_on(params: Params, settings: Settings, out: Outcome) -> Status:
    """Set the outcome of one machine, fields of shape (1,)."""
    machine = prepare(params, settings.kinematics, BUDGET)
    state = propagator.start(params, machine.system)
    rigid = machine.system.rigid
    speed = np.max([rigid.synchronous_speed_1, rigid.synchronous_speed_2])
    if not math.isfinite(speed):
        return Status.NON_FINITE
    wanted = math.ceil(settings.run_up * speed * SAMPLES_PER_TURN / (2 * np.pi))
    track = Track(state, settings.run_up / wanted, LOOK)
    guess = proposal(machine)
    orbit, next_search = None, LOOK
    slowest = slowest_period(rigid)
    while track.count < wanted:
        times = track.interval * np.arange(1, min(LOOK, wanted - track.count) + 1)
        ended, samples = run_exactly(machine, state, track.time, times, settings, out)
        if ended == STUCK or not np.isfinite(samples).all():
            return Status.NON_FINITE
        machine.budget -= _LOOKING
        track.add(samples)
        if ended == OUT_OF_BUDGET:
            return _describe_unfinished(machine.system, track, out)
        stays = orbit is not None and _stays_at(orbit, track)
        if orbit is not None and stays and track.time - track.neared >= slowest:
            _describe_orbit(orbit, track, out)
            enough = note_exactly(machine, state, track.time, settings, out)
            return Status.OK if enough else Status.OUT_OF_BUDGET
        arriving = stays or (orbit is not None and _approaches(orbit, track))
        if track.count >= next_search and not arriving and _is_steady(machine.system, track):
            orbit = _search(machine, guess, state, settings.tolerance) or orbit
            guess = None
            # Each search costs dozens of turns; where they fail, they become ever rarer.
            next_search = 4 * track.count
    _describe_end(machine, track, orbit, state, settings.tolerance, out)
    return Status.OK


def _search(
    machine: Machine,
    guess: NDArray[np.float64] | None,
    state: NDArray[np.float64],
    tolerance: float,
) -> Orbit | None:
    """Search for a stable orbit at working speed: near the guess, else near the state."""
    for near in (guess, anchored(machine, state, tolerance)):
        orbit = None if near is None else find_orbit(machine, near, tolerance)
        if orbit and is_at_work(machine.system, orbit):
            return orbit
    return None


def is_at_work(m: System, orbit: Orbit) -> bool:
    """Whether an orbit is stable, at working speed."""
    slowest = CAPTURED_BELOW * max(m.rigid.synchronous_speed_1, m.rigid.synchronous_speed_2)
    return orbit.multiplier < 1 - _UNSURE and 2 * np.pi / orbit.period >= slowest


def _speeds(states: NDArray[np.float64], interval: float) -> NDArray[np.float64]:
    """Return the mean speeds of both vibrators."""
    return (states[-1, 3:5] - states[0, 3:5]) / (interval * (len(states) - 1))


def _by_turns(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of psi_1 - psi_2 over each turn at synchronous speed."""
    angle = states[1:, 3] - states[1:, 4]
    turn = min(SAMPLES_PER_TURN, len(angle))
    return angle[len(angle) % turn :].reshape(-1, turn).mean(axis=1)


def _is_steady(m: System, track: Track) -> bool:
    states = track.last(LOOK)
    speed_1, speed_2 = _speeds(states, track.interval)
    return bool(
        speed_1 >= CAPTURED_BELOW * m.rigid.synchronous_speed_1
        and speed_2 >= CAPTURED_BELOW * m.rigid.synchronous_speed_2
        and np.ptp(_by_turns(states)) < _STEADY
    )


def _stays_at(orbit: Orbit, track: Track) -> bool:
    """Whether the last look was so near to a stable orbit that the machine will not leave it."""
    states = track.last(LOOK)
    mean = orbit.measures.disphasing
    ratio = _speeds(states, track.interval) * orbit.period / (2 * np.pi)
    within = np.abs(wrapped(states[:, 3] - states[:, 4] - mean)) < BAND
    return bool(
        (np.abs(wrapped(_by_turns(states) - mean)) < _NEAR).all()
        and (np.abs(ratio - 1) < _ALIKE).all()
        and (within.all() or orbit.ripple >= BAND)
    )


def _approaches(orbit: Orbit, track: Track) -> bool:
    """Whether the last look drew nearer to an orbit with every turn."""
    off = np.abs(wrapped(_by_turns(track.last(LOOK)) - orbit.measures.disphasing))
    return bool((np.diff(off) < 0).all())


def _describe_orbit(orbit: Orbit, track: Track, out: Outcome) -> None:
    """Set the outcome of a machine that has reached an orbit."""
    seen = orbit.measures
    out.disphasing[:], out.multiplier[:] = seen.disphasing, orbit.multiplier
    _describe(seen, track, out)
    out.speed[:] = 2 * np.pi / orbit.period
    out.regime[:] = locked_regime(out.disphasing)
    out.synchronisation_time[:] = track.last_time_off(seen.disphasing)
    if orbit.ripple >= BAND:
        out.synchronisation_time[:] = np.inf
    elif out.synchronisation_time[0] > track.time - LOOK * track.interval:
        out.synchronisation_time[:], out.censored[:] = track.time, True


def _describe(seen: Measures, track: Track, out: Outcome) -> None:
    out.angular_amplitude[:] = seen.angular_amplitude
    out.stroke_left[:], out.stroke_right[:] = seen.stroke_left, seen.stroke_right
    out.speed[:] = (seen.speed_1 + seen.speed_2) / 2
    out.power_1[:], out.power_2[:] = seen.power_1, seen.power_2
    out.max_excursion[:] = track.excursion


def _describe_last_second(m: System, track: Track, out: Outcome) -> bool:
    """Set the outcome of a machine on no orbit; return whether its motors may have locked."""
    states = track.last()
    seen = measure(m, states, track.interval)
    _describe(seen, track, out)
    top_1, top_2 = m.rigid.synchronous_speed_1, m.rigid.synchronous_speed_2
    w_1, w_2, top_1, top_2 = np.array([[seen.speed_1], [seen.speed_2], [top_1], [top_2]])
    out.regime[:] = unlocked_regime(w_1, w_2, top_1, top_2)
    return bool(out.regime[0] == ASYNCHRONOUS and np.ptp(_by_turns(states)) < _LOCKED)


def _describe_end(
    machine: Machine,
    track: Track,
    orbit: Orbit | None,
    state: NDArray[np.float64],
    tolerance: float,
    out: Outcome,
) -> None:
    """Set the outcome of a machine that is not known to have reached an orbit."""
    locked = _describe_last_second(machine.system, track, out)
    out.synchronisation_time[:] = np.inf
    if not locked:
        return
    if orbit is None or not _approaches(orbit, track):
        orbit = _search(machine, None, state, tolerance)
    states = track.last()
    mean = wrapped(np.mean(states[:, 3] - states[:, 4], keepdims=True))
    if orbit is not None and (
        _approaches(orbit, track) or abs(wrapped(mean - orbit.measures.disphasing)[0]) < _NEAR
    ):
        _describe_orbit(orbit, track, out)
        return
    # A feed in flight need not repeat every turn: the angle must then have stayed for half the run.
    came = track.last_time_off(mean[0])
    if machine.system.feed_mass and came < track.time / 2:
        out.disphasing[:], out.synchronisation_time[:] = mean, came
        out.regime[:] = locked_regime(mean)


def _describe_unfinished(m: System, track: Track, out: Outcome) -> Status:
    """Set the outcome of a machine whose step budget is used up."""
    if track.time >= LAST:
        _describe_last_second(m, track, out)
    out.synchronisation_time[:], out.censored[:] = track.time, True
    return Status.OUT_OF_BUDGET
