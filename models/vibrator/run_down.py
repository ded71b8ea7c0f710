"""Run-down: synchronous motors are switched off, and the machine passes its resonances once more.

Without motor torque the vibrators are braked by their bearings, rho m e w^2, and by the body, whose
dampers take energy. As friction falls with the square of the speed, they never stop entirely: at
rest is a machine both of whose vibrators turn slower than 0.05 of their synchronous speed, with
gravity also when their unbalances swing through the lowest point. The excursion depends on where
the unbalances are at the resonance, so on the phase at which the motors are switched off.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.numerics.dop853 import REACHED_END
from models.vibrator.equations.rigid import Rigid
from models.vibrator.exact.budgeted import prepare
from models.vibrator.exact.measures import excursion
from models.vibrator.exact.orbit import find_orbit, proposal
from models.vibrator.lanes.fixed_steps import advance
from models.vibrator.lanes.machines import Machines, prepared
from models.vibrator.lanes.notes import EXCURSION
from models.vibrator.lanes.packed import Array, pack
from models.vibrator.lanes.steps import STABLE
from models.vibrator.parameters import Params, Rows, Settings
from models.vibrator.start.exact import BUDGET, is_at_work
from models.vibrator.start.regimes import LOCKED_0, LOCKED_PI, STALLED_BELOW
from models.vibrator.start.synchronous import search

STEPS = 12  # per turn, of order 8
_LOOK = 96  # steps
_SHIFT = 96  # steps of a turn, to the phase at which motors are switched off
_PER_TURN, _TURNS = 32, 16  # samples of the exact propagator, turns of a look


def run_downs(
    p: Rows,
    regime: NDArray[np.int8],
    angle: Array,
    speed: Array,
    quick: NDArray[np.bool_],
    settings: Settings,
) -> dict[str, NDArray[Any]]:
    """Switch off n machines that run as they do at the end of their starts.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    regime : ndarray of int8, shape (n,)
    angle, speed : ndarray, shape (n,)
        Disphasing angle and speed of those that are locked [rad, rad s-1].
    quick : ndarray of bool, shape (n,)
        Which machines lanes can follow.
    settings : Settings
        With phases at which motors are switched off.

    Returns
    -------
    dict of str to ndarray, shape (n, k)
        ``run_down_excursion``, the largest displacement of C [m], ``run_down_time`` [s] and
        ``run_down_time_censored``; NaN where the motors are not locked.
    """
    n, phases = len(regime), np.asarray(settings.run_down_phases, float)
    far, time = np.full((2, n, len(phases)), np.nan)
    locked = (regime == LOCKED_0) | (regime == LOCKED_PI)
    rows = np.flatnonzero(locked & quick)
    with np.errstate(all="ignore"):
        if len(rows):
            machines = prepared(Params._make(field[rows] for field in p))
            wanted = np.ones(len(rows), bool)
            at = search(machines, speed[rows], angle[rows], wanted, settings.steps_per_turn)
            kept = np.repeat(np.flatnonzero(at.exists), len(phases))
            phase = np.tile(phases, int(at.exists.sum()))
            time_off = at.orbits.period[kept] * phase / (2 * np.pi)
            state = _at_phase(machines.take(kept), at.orbits.state[kept], time_off)
            ends = _run_down(machines.take(kept), state, settings.run_down)
            rows = rows[at.exists]
            far[rows], time[rows] = (each.reshape(-1, len(phases)) for each in ends)
        for i in np.flatnonzero(locked & ~quick).tolist():
            params = Params._make(float(field[i]) for field in p)
            far[i], time[i] = _run_down_exactly(params, phases, settings)
    censored = np.isfinite(time) & (time >= settings.run_down)
    return {
        "run_down_excursion": far,
        "run_down_time": np.where(censored, settings.run_down, time),
        "run_down_time_censored": censored,
    }


def _at_phase(machines: Machines, start: Array, time: Array) -> Array:
    """Return the states of n machines some time after those at psi_1 = 0."""
    state = start.copy()
    nowhere = np.full(len(state), np.nan)
    advance(machines, state, time / _SHIFT, nowhere, _SHIFT, 0.0, True)
    return state


def _switched_off(machines: Machines) -> Machines:
    none = np.zeros(len(machines.fastest))
    rigid = machines.rigid._replace(torque_1=none, torque_2=none)
    return machines._replace(rigid=rigid, constants=pack(rigid))


def _lowest_speeds(m: Rigid, state: Array) -> Array:
    """Return the speeds of both vibrators when their unbalances next pass the lowest point.

    Of n states, shape (n, 10) or (n, 16), of n machines or of one; if nothing brakes them.
    """
    at = state.shape[1] // 2 + 3
    angle_1, angle_2 = m.working_angle + state[:, 3], m.working_angle - state[:, 4]
    height_1, height_2 = 1 + elementary.sin(angle_1), 1 + elementary.sin(angle_2)
    fall_1 = 2 * m.gravity * m.unbalance_1 * m.mobility_1 * height_1
    fall_2 = 2 * m.gravity * m.unbalance_2 * m.mobility_2 * height_2
    return np.sqrt(state[:, at : at + 2] ** 2 + np.stack([fall_1, fall_2], axis=1))


def _run_down(machines: Machines, state: Array, longest: float) -> tuple[Array, Array]:
    """Return the largest displacement of C [m] and the time to rest [s]; `state` is updated."""
    machines, n = _switched_off(machines), len(state)
    far, time = np.zeros(n), np.full(n, longest)
    slow = STALLED_BELOW * machines.synchronous_speed
    rows, now = np.arange(n), np.zeros(n)
    while len(rows):
        part, here = machines.take(rows), state[rows]
        before = _lowest_speeds(part.rigid, here)
        h = np.minimum(2 * np.pi / (STEPS * before.max(axis=1)), STABLE / part.fastest)
        notes = advance(part, here, h, np.full(len(rows), np.nan), _LOOK, 0.0, True)
        state[rows] = here
        far[rows] = np.maximum(far[rows], notes[:, EXCURSION])
        after, limit = _lowest_speeds(part.rigid, here), slow[rows]
        # By friction alone the reciprocal of the speed grows at a constant rate.
        part_of_look = (1 / limit - 1 / before) / (1 / after - 1 / before)
        part_of_look = np.where(before > limit, part_of_look, 0.0).max(axis=1)
        rest = (after <= limit).all(axis=1)
        time[rows[rest]] = (now + _LOOK * h * part_of_look)[rest]
        now = now + _LOOK * h
        going = ~rest & (now < longest) & np.isfinite(here).all(axis=1)
        rows, now = rows[going], now[going]
    finite = np.isfinite(state).all(axis=1)
    return np.where(finite, np.sqrt(far), np.nan), np.where(finite, time, np.nan)


def _run_down_exactly(params: Params, phases: Array, settings: Settings) -> Any:
    """Return the displacement and the time of one machine for each phase; NaN without an orbit."""
    far, time = np.full((2, len(phases)), np.nan)
    machine = prepare(params, settings.kinematics, BUDGET)
    guess = proposal(machine)
    orbit = None if guess is None else find_orbit(machine, guess, settings.tolerance)
    if orbit is None or not is_at_work(machine.system, orbit):
        return far, time
    rigid = machine.system.rigid
    slow = STALLED_BELOW * np.array([rigid.synchronous_speed_1, rigid.synchronous_speed_2])
    times = np.arange(1, _PER_TURN * _TURNS + 1)
    for k, phase in enumerate(phases.tolist()):
        off = prepare(params, settings.kinematics, BUDGET)
        state, largest, now = orbit.state.copy(), 0.0, 0.0
        off.run(state, orbit.period * phase / (2 * np.pi), settings.tolerance)
        off.system = off.system._replace(rigid=rigid._replace(torque_1=0.0, torque_2=0.0))
        while now < settings.run_down:
            first = state.copy()
            fastest = max(*_lowest_speeds(rigid, first[None])[0], *slow)
            interval = 2 * np.pi / (_PER_TURN * float(fastest))
            look = interval * times
            ended, samples = off.run(state, float(look[-1]), settings.tolerance, math.inf, look)
            if ended.status != REACHED_END or not np.isfinite(samples).all():
                largest = now = math.nan
                break
            largest = max(largest, excursion(np.vstack([first, samples]), interval))
            moving = np.flatnonzero((_lowest_speeds(rigid, samples) > slow).any(axis=1))
            last = int(moving[-1]) + 1 if len(moving) else 0
            if last < len(times):
                now += last * interval
                break
            now += float(look[-1])
        far[k], time[k] = largest, now
    return far, time
