"""Run-down: synchronous motors are switched off, and the machine passes its resonances once more.

Without motor torque the vibrators are braked by their bearings, rho m e w^2, and by the body, whose
dampers take energy. As friction falls with the square of the speed, they never stop entirely: at
rest is a machine once both vibrators turn slower than 0.05 of their synchronous speed, with gravity
also when their unbalances swing through the lowest point. Its motion counts until then. The
excursion depends on where the unbalances are at the resonance, so on the phase at which the motors
are switched off.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.numerics.dop853 import REACHED_END
from models.vibrator.equations.rigid import Rigid
from models.vibrator.exact.budgeted import Machine, prepare
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
_NEAR = 2.0  # times the speed at rest, below which every step is looked at
_HALVINGS = 30  # of a step
_WHOLE = 1 - 1e-12


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
    limit = STALLED_BELOW * machines.synchronous_speed
    now, left = np.zeros(n), np.arange(n)
    for steps, above in ((_LOOK, _NEAR), (1, 1.0)):
        rows, left = left, left[:0]
        while len(rows):
            part, here = machines.take(rows), state[rows]
            fastest = _lowest_speeds(part.rigid, here).max(axis=1)
            h = np.minimum(2 * np.pi / (STEPS * fastest), STABLE / part.fastest)
            h = np.minimum(h, (longest - now[rows]) / steps)
            notes = _advance(part, here, h, steps)
            ends = (_lowest_speeds(part.rigid, here) <= above * limit[rows]).all(axis=1)
            on, at = rows[~ends], rows[ends]
            if steps > 1:  # the end is near, and sought step by step
                left = np.concatenate([left, at])
            elif len(at):
                span, at_end = _crossing(part.take(ends), state[at], h[ends], limit[at])
                far[at] = np.maximum(far[at], at_end)
                time[at] = now[at] + span
            state[on], far[on] = here[~ends], np.maximum(far[on], notes[~ends])
            now[on] += steps * h[~ends]
            is_over = now[on] >= longest * _WHOLE
            rows = on[~is_over & np.isfinite(state[on]).all(axis=1)]
    finite = np.isfinite(state).all(axis=1)
    return np.where(finite, np.sqrt(far), np.nan), np.where(finite, time, np.nan)


def _advance(machines: Machines, state: Array, h: Array, steps: int) -> Array:
    """Advance states by some steps; return the largest squares of the displacement of C [m2]."""
    nowhere = np.full(len(state), np.nan)
    return np.asarray(advance(machines, state, h, nowhere, steps, 0.0, True)[:, EXCURSION])


def _crossing(machines: Machines, state: Array, h: Array, limit: Array) -> tuple[Array, Array]:
    """Return the time within a step at which machines come to rest, and the square as `_advance`.

    The step is halved: one of any length has the order of the method.
    """
    low, high = np.zeros(len(h)), np.ones(len(h))
    far = np.zeros(len(h))
    for _ in range(_HALVINGS):
        middle, here = 0.5 * (low + high), state.copy()
        far = _advance(machines, here, middle * h, 1)
        rests = (_lowest_speeds(machines.rigid, here) <= limit).all(axis=1)
        low, high = np.where(rests, low, middle), np.where(rests, middle, high)
    return high * h, far


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
    for k, phase in enumerate(phases.tolist()):
        off = prepare(params, settings.kinematics, BUDGET)
        state, largest, now = orbit.state.copy(), 0.0, 0.0
        off.run(state, orbit.period * phase / (2 * np.pi), settings.tolerance)
        off.system = off.system._replace(rigid=rigid._replace(torque_1=0.0, torque_2=0.0))
        while now < settings.run_down:
            first = state.copy()
            fastest = max(*_lowest_speeds(rigid, first[None])[0], *slow)
            interval = 2 * np.pi / (_PER_TURN * float(fastest))
            count = min(_PER_TURN * _TURNS, math.ceil((settings.run_down - now) / interval))
            look = interval * np.arange(1, count + 1)
            ended, samples = off.run(state, float(look[-1]), settings.tolerance, math.inf, look)
            if ended.status != REACHED_END or not np.isfinite(samples).all():
                largest = now = math.nan
                break
            rests = np.flatnonzero((_lowest_speeds(rigid, samples) <= slow).all(axis=1))
            moving = int(rests[0]) if len(rests) else count
            path = np.vstack([first, samples[:moving]])
            if moving:
                largest = max(largest, excursion(path, interval))
            now += moving * interval
            if moving < count:
                span, at = _crossing_exactly(off, path[-1], interval, slow, settings.tolerance)
                largest, now = max(largest, math.hypot(at[0], at[1])), now + span
                break
        far[k], time[k] = largest, now
    return far, time


def _crossing_exactly(
    off: Machine, state: Array, interval: float, slow: Array, tolerance: float
) -> tuple[float, Array]:
    """Return the time within an interval at which a machine comes to rest, and its state then."""
    low, high, at = 0.0, 1.0, state
    for _ in range(_HALVINGS):
        middle, here = 0.5 * (low + high), state.copy()
        off.run(here, middle * interval, tolerance)
        if (_lowest_speeds(off.system.rigid, here[None])[0] <= slow).all():
            high, at = middle, here
        else:
            low = middle
    return high * interval, at
