"""A machine whose motor torques lag: tau_e dT/dt + T = T_Kloss, (22), (23) without bearing loss.

A state is that of `models.vibrator.equations.general` with two degrees of freedom more, whose
rates are the torques T_1 and T_2 [N m]; their positions stay at 0.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.dop853 import GUARDED, Outcome, integrator
from models.numerics.jit import inlined, kernel
from models.vibrator.equations import general
from models.vibrator.equations.rigid import Rigid
from models.vibrator.equations.system import System
from models.vibrator.exact.ramp import ramped

DEGREES = general.DEGREES + 2
"""Those of `models.vibrator.equations.general`, then one for each torque."""

_TURNED, _FEED = 0, 1  # guards


class Task(NamedTuple):
    """A mode of motion; `room` holds a state of `models.vibrator.equations.general`."""

    system: System
    last_angle: float
    riding: bool
    room: NDArray[np.float64]


def extend(state: NDArray[np.float64]) -> NDArray[np.float64]:
    """Extend a state of `models.vibrator.equations.general`, shape (16,), without torque."""
    longer = np.zeros(2 * DEGREES)
    longer[: general.DEGREES] = state[: general.DEGREES]
    longer[DEGREES : DEGREES + general.DEGREES] = state[general.DEGREES :]
    return longer


@inlined
def _driven(m, w_1, w_2, torque_1, torque_2):
    """Return the `System` whose motors have these torques at these speeds: slip 0, lag 1."""
    r = m.rigid
    return System(
        Rigid(
            r.mass,
            r.moment_x,
            r.moment_y,
            r.inertia,
            r.working_angle,
            r.shaft_x_1,
            r.shaft_y_1,
            r.shaft_x_2,
            r.shaft_y_2,
            r.unbalance_1,
            r.unbalance_2,
            r.mobility_1,
            r.mobility_2,
            torque_1,
            torque_2,
            w_1 + 1.0,
            w_2 + 1.0,
            0.0,
            0.0,
            r.bearing_loss_1,
            r.bearing_loss_2,
            r.stiffness_x,
            r.stiffness_y,
            r.damping_x,
            r.damping_y,
            r.support_offset,
            r.half_spacing,
            r.gravity,
            r.support_lever,
        ),
        m.unbalanced_mass,
        m.rotor_inertia,
        m.body_mass,
        m.body_inertia,
        m.mount_x,
        m.mount_y,
        m.slides,
        m.rocks,
        m.slide_x,
        m.slide_y,
        m.mount_mass,
        m.mount_inertia,
        m.slide_stiffness,
        m.slide_damping,
        m.rock_stiffness,
        m.rock_damping,
        m.feed_mass,
        m.feed_gravity,
        m.feed_position,
        m.exact,
        m.ramp_time,
        m.ramp_left,
        m.torque_lag,
    )


@inlined
def _unpack(y, room):
    for i in range(general.DEGREES):
        room[i] = y[i]
        room[general.DEGREES + i] = y[DEGREES + i]


@inlined
def _kloss(torque, synchronous_speed, slip, w):
    behind = synchronous_speed - w
    return torque * behind / (slip * slip + behind * behind)


@kernel
def _rates(t, y, task, dy):
    for i in range(DEGREES):
        dy[i] = y[DEGREES + i]
    dy[general.DEGREES] = dy[general.DEGREES + 1] = 0.0
    _unpack(y, task.room)
    w_1, w_2 = y[DEGREES + 3], y[DEGREES + 4]
    torque_1, torque_2 = y[DEGREES + general.DEGREES], y[DEGREES + general.DEGREES + 1]
    m = task.system
    motion = general.accelerations(_driven(m, w_1, w_2, torque_1, torque_2), task.riding, task.room)
    for i in range(general.DEGREES):
        dy[DEGREES + i] = motion[i]
    r = ramped(m, t).rigid
    kloss_1 = _kloss(r.torque_1, r.synchronous_speed_1, r.slip_1, w_1)
    kloss_2 = _kloss(r.torque_2, r.synchronous_speed_2, r.slip_2, w_2)
    dy[DEGREES + general.DEGREES] = (kloss_1 - torque_1) / m.torque_lag
    dy[DEGREES + general.DEGREES + 1] = (kloss_2 - torque_2) / m.torque_lag


@kernel
def _guards(t, y, task, guard):
    guard[_TURNED] = task.last_angle - y[3]
    guard[_FEED] = y[7]
    if task.riding:
        _unpack(y, task.room)
        w_1, w_2 = y[DEGREES + 3], y[DEGREES + 4]
        torque_1, torque_2 = y[DEGREES + general.DEGREES], y[DEGREES + general.DEGREES + 1]
        m = _driven(task.system, w_1, w_2, torque_1, torque_2)
        guard[_FEED] = general.support_of_feed(m, task.room)


_integrate = integrator(_rates, _guards, 2)


@kernel
def run_lagging(system, state, last_angle, end, absolute, budget, times, samples):
    """Integrate through all flights of the feed; see `models.vibrator.exact.propagator`."""
    room = np.empty(2 * general.DEGREES)
    riding = state[7] == 0 and state[DEGREES + 7] == 0
    time = step = 0.0
    steps = sampled = 0
    while True:
        ended = _integrate(
            time,
            end,
            state,
            step,
            Task(system, last_angle, riding, room),
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
            state[7] = state[DEGREES + 7] = 0.0
        else:
            _unpack(state, room)
            general.land(system, room)
            for i in range(general.DEGREES):
                state[i], state[DEGREES + i] = room[i], room[general.DEGREES + i]
        riding = not riding
    return Outcome(ended.status, time, ended.guard, step, steps, sampled)


def start_torques(system: System, speed: float) -> tuple[float, float]:
    """Return the torques of (22), (23) of both motors at a steady speed [N m]."""
    r = system.rigid
    behind_1, behind_2 = r.synchronous_speed_1 - speed, r.synchronous_speed_2 - speed
    return (
        r.torque_1 * behind_1 / (r.slip_1**2 + behind_1**2),
        r.torque_2 * behind_2 / (r.slip_2**2 + behind_2**2),
    )
