"""Error-controlled propagation of one machine: the reference for the vibrator.

The equations are integrated by `models.numerics.dop853`; a flight of the feed begins where its
contact force vanishes and ends where its height does.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.numerics.dop853 import GUARDED, Outcome, integrator
from models.numerics.jit import kernel, spliced
from models.vibrator.equations import general, rigid_motion
from models.vibrator.equations.system import System
from models.vibrator.exact import lag
from models.vibrator.exact.ramp import ramped
from models.vibrator.parameters import Params

STEPS_PER_TURN = 400
_SPARE_STEPS = 10_000
_TURNED, _FEED = 0, 1  # guards


class Task(NamedTuple):
    """A mode of motion.

    Attributes
    ----------
    system : System
    last_angle : float
        psi_1 at which to stop [rad].
    riding : bool
        Whether the feed lies on the deck.
    """

    system: System
    last_angle: float
    riding: bool


class Motion(NamedTuple):
    """The motion of one machine.

    Attributes
    ----------
    status : int
        `REACHED_END`, `GUARDED` (turns completed), `OUT_OF_BUDGET` or `STUCK`, of
        `models.numerics.dop853`.
    time : float
        [s] since the start.
    state : ndarray
        At that time.
    samples : ndarray, shape (k, len(state))
        At `times`; NaN after the end of the motion.
    """

    status: int
    time: float
    state: NDArray[np.float64]
    samples: NDArray[np.float64]


@kernel
def _rigid_rates(t, y, task, dy):
    for i in range(rigid_motion.DEGREES):
        dy[i] = y[rigid_motion.DEGREES + i]
    rigid_motion.acceleration(task.system.rigid, y, dy[rigid_motion.DEGREES :])


@kernel
def _turned(t, y, task, guard):
    guard[_TURNED] = task.last_angle - y[3]


@kernel
def _extended_rates(t, y, task, dy):
    for i in range(general.DEGREES):
        dy[i] = y[general.DEGREES + i]
    motion = general.accelerations(task.system, task.riding, y)
    for i in range(general.DEGREES):
        dy[general.DEGREES + i] = motion[i]


@kernel
def _fed_guards(t, y, task, guard):
    guard[_TURNED] = task.last_angle - y[3]
    guard[_FEED] = general.support_of_feed(task.system, y) if task.riding else y[7]


@kernel
def _rigid_rates_in_ramp(t, y, task, dy):
    for i in range(rigid_motion.DEGREES):
        dy[i] = y[rigid_motion.DEGREES + i]
    rigid_motion.acceleration(ramped(task.system, t).rigid, y, dy[rigid_motion.DEGREES :])


@kernel
def _extended_rates_in_ramp(t, y, task, dy):
    for i in range(general.DEGREES):
        dy[i] = y[general.DEGREES + i]
    motion = general.accelerations(ramped(task.system, t), task.riding, y)
    for i in range(general.DEGREES):
        dy[general.DEGREES + i] = motion[i]


@kernel
def _fed_guards_in_ramp(t, y, task, guard):
    guard[_TURNED] = task.last_angle - y[3]
    guard[_FEED] = general.support_of_feed(ramped(task.system, t), y) if task.riding else y[7]


_integrate_rigid = integrator(_rigid_rates, _turned, 1, looks=1)
_integrate_empty = integrator(_extended_rates, _turned, 1, looks=1)
_integrate_fed = integrator(_extended_rates, _fed_guards, 2)
_integrate_rigid_in_ramp = integrator(_rigid_rates_in_ramp, _turned, 1, looks=1)
_integrate_empty_in_ramp = integrator(_extended_rates_in_ramp, _turned, 1, looks=1)
_integrate_fed_in_ramp = integrator(_extended_rates_in_ramp, _fed_guards_in_ramp, 2)


@kernel
def run_rigid(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate the rigid machine; see `models.numerics.dop853` for the arguments."""
    task = Task(system, last_angle, True)
    return _integrate_rigid(0.0, end, state, 0.0, task, 0.0, absolute, budget, times, samples)


@kernel
def run_empty(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate the extended machine without feed; see `run_rigid`."""
    task = Task(system, last_angle, True)
    return _integrate_empty(0.0, end, state, 0.0, task, 0.0, absolute, budget, times, samples)


@spliced
def _through_flights(integrate, system, state, last_angle, end, absolute, budget, times, samples):
    riding = state[7] == 0 and state[general.DEGREES + 7] == 0
    time = step = 0.0
    steps = sampled = 0
    while True:
        ended = integrate(
            time,
            end,
            state,
            step,
            Task(system, last_angle, riding),
            0.0,
            absolute,
            budget - steps,
            times[sampled:],
            samples[sampled:],
        )
        time, step = ended.time, ended.step
        steps += ended.steps
        sampled += ended.sampled
        if ended.status != GUARDED or ended.guard == _TURNED:
            break
        if riding:
            state[7] = state[general.DEGREES + 7] = 0.0
        else:
            general.land(system, state)
        riding = not riding
    return Outcome(ended.status, time, ended.guard, step, steps, sampled)


@kernel
def run_fed(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate the extended machine through all flights of the feed; see `run_rigid`."""
    return _through_flights(
        _integrate_fed, system, state, last_angle, end, absolute, budget, times, samples
    )


@kernel
def run_rigid_in_ramp(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate the rigid machine while synchronous speeds rise; see `run_rigid`."""
    task = Task(system, last_angle, True)
    return _integrate_rigid_in_ramp(
        0.0, end, state, 0.0, task, 0.0, absolute, budget, times, samples
    )


@kernel
def run_empty_in_ramp(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate the extended machine without feed while synchronous speeds rise."""
    task = Task(system, last_angle, True)
    return _integrate_empty_in_ramp(
        0.0, end, state, 0.0, task, 0.0, absolute, budget, times, samples
    )


@kernel
def run_fed_in_ramp(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate the machine through all flights of the feed while synchronous speeds rise."""
    return _through_flights(
        _integrate_fed_in_ramp, system, state, last_angle, end, absolute, budget, times, samples
    )


def is_extended(system: System) -> bool:
    """Whether a machine needs the equations of `models.vibrator.equations.general`."""
    moves = system.exact or system.slides or system.rocks or system.feed_mass
    return bool(moves or system.torque_lag)


def degrees_of(system: System) -> int:
    """Return the number of degrees of freedom, half the length of a state."""
    if system.torque_lag:
        return lag.DEGREES
    return general.DEGREES if is_extended(system) else rigid_motion.DEGREES


def runner(system: System, degrees: int) -> Callable[..., Outcome]:
    """Return the kernel for this many degrees of freedom: `run_rigid` or one with its arguments."""
    in_ramp = system.ramp_left > 0
    if degrees == lag.DEGREES:
        return lag.run_lagging
    if degrees == rigid_motion.DEGREES:
        return run_rigid_in_ramp if in_ramp else run_rigid
    if system.feed_mass:
        return run_fed_in_ramp if in_ramp else run_fed
    return run_empty_in_ramp if in_ramp else run_empty


def start(params: Params, system: System) -> NDArray[np.float64]:
    """Return the state of one machine at rest, at its initial phases.

    Parameters
    ----------
    params : Params
        Each field a float.
    system : System
        The same machine, prepared.

    Returns
    -------
    ndarray, shape (10,), (16,) or (20,)
        Of `models.vibrator.equations.rigid_motion`, of `models.vibrator.equations.general`, or of
        `models.vibrator.exact.lag`.
    """
    row = Params._make(np.array([value]) for value in params)
    (state,) = rigid_motion.initial_state(row)
    if system.torque_lag:
        return lag.extend(general.extend(state))
    return general.extend(state) if is_extended(system) else state


def propagate(
    system: System,
    state: ArrayLike,
    duration: float,
    tolerance: float,
    turns: float = math.inf,
    times: ArrayLike = (),
) -> Motion:
    """Follow one machine, as `models.numerics.propagator.ReferencePropagator` states.

    Parameters
    ----------
    system : System
    state : array_like, shape (10,), (16,) or (20,)
        At time 0; see `start`.
    duration : float
        [s]
    tolerance : float
        Allowed error of a step, in units of the motion: static unbalance over mass, this over
        the radius of gyration, a radian, and these times the synchronous speed.
    turns : float
        Stop after this many turns of vibrator 1, if they come before `duration`.
    times : array_like, shape (k,)
        When to sample the state [s], ascending.

    Returns
    -------
    Motion
    """
    state = np.array(state, float)
    times = np.ascontiguousarray(times, float)
    samples = np.full((len(times), len(state)), np.nan)
    run = runner(system, len(state) // 2)
    revolutions = duration * _speed(system) / (2 * np.pi)
    ended = run(
        system,
        state,
        state[3] + 2 * np.pi * turns,
        float(duration),
        tolerance * scales_of(system, len(state) // 2),
        int(STEPS_PER_TURN * revolutions) + _SPARE_STEPS,
        times,
        samples,
    )
    return Motion(ended.status, ended.time, state, samples)


def _speed(m: System) -> float:
    return max(m.rigid.synchronous_speed_1, m.rigid.synchronous_speed_2)


def scales_of(m: System, degrees: int) -> NDArray[np.float64]:
    """Return the scales of x, y, alpha, psi_1, psi_2, u, chi and height, then of their rates.

    With torques that lag, those of their degrees of freedom, too.
    """
    shift = (m.rigid.unbalance_1 + m.rigid.unbalance_2) / m.rigid.mass
    turn = shift / math.sqrt(m.rigid.inertia / m.rigid.mass)
    sizes = np.array([shift, shift, turn, 1.0, 1.0, shift, turn, shift, 1.0, 1.0])[:degrees]
    rates = sizes * _speed(m)
    if degrees == lag.DEGREES:
        rates[general.DEGREES :] = (
            m.rigid.torque_1 / m.rigid.slip_1,
            m.rigid.torque_2 / m.rigid.slip_2,
        )
    return np.concatenate([sizes, rates])
