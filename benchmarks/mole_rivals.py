"""The mole as one would write it with scipy or numba: one machine at a time."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks import mole_modes as modes
from models.mole.lanes.modes import mole_of
from models.mole.lanes.rows import HALF
from models.numerics.jit import kernel

_SCALES = np.array([1e-2, 1.0, 0.1, 1.0, 1.0, 1.0, 1.0, 1e-2, 1e-4, 1e-3])
_LONGEST = 2e-3  # s: with longer steps scipy misses events that undo each other


@kernel
def _added(y, c):
    return c[modes.BAR_COIL] * math.exp(0.5 * c[modes.SLOPE] * y[modes.U] ** 2)


@kernel
def _rates(t, y, c):
    return np.array(modes.motion(y, c, _added(y, c))[0])


@kernel
def _guard(y, c, which):
    return modes.motion(y, c, _added(y, c))[1][which]


def _event(which):
    """Return a terminal event; scipy knows it by attributes, which a kernel has no place for."""

    def event(t, y, c):
        return _guard(y, c, which)

    event.terminal, event.direction = True, -1
    return event


_EVENTS = [_event(which) for which in range(modes.EVENTS)]


def by_scipy(table, record, halves, tolerance):
    """Return the states, shape (10, n), of n machines after some halves of control periods."""
    end = np.empty((modes.STATE, len(table)))
    for row in range(len(table)):
        machine = table[row : row + 1]
        half_period = 0.5 * mole_of(machine, 0).control_period
        state, constants = np.empty((modes.STATE, 1)), np.empty((modes.CONSTANTS, 1))
        parts = state, constants, np.empty((modes.MODE, 1))
        modes.begin(machine, 0, record[row], *parts)
        for _ in range(halves):
            time = 0.0
            while time < half_period:
                run = solve_ivp(
                    _rates,
                    (time, half_period),
                    state[:, 0],
                    "DOP853",
                    events=_EVENTS,
                    args=(constants[:, 0],),
                    rtol=tolerance,
                    atol=tolerance * _SCALES,
                    max_step=_LONGEST,
                )
                time, state[:, 0] = run.t[-1], run.y[:, -1]
                for which, times in enumerate(run.t_events):
                    if len(times):
                        modes.happen(which, machine, 0, *parts)
            modes.turn_relay(machine, 0, *parts)
        end[:, row] = state[:, 0]
    return end


@kernel
def _slide(q, drive, t, y, k):
    """Set k to the rates of (u, v, x, i, p, w, impact work, electric work)."""
    u, v, x, i, p = y[0], y[1], y[2], y[3], y[4]
    added = q.bar_inductance * math.exp(-q.sharpness * u * u)
    rise = -2 * q.sharpness * u * added
    magnetic = 0.5 * i * i * rise
    contact = q.contact_stiffness * (u - q.stop_gap) if u > q.stop_gap else 0.0
    pull = magnetic - q.damping * v - q.spring_stiffness * (u - q.spring_rest) - contact
    pull -= q.bar_limit * np.sign(v)
    ground = q.mole_limit * np.sign(x)
    k[0] = v
    k[1] = pull / q.mass + ground / q.mole_mass
    k[2] = -(pull + ground) / q.mole_mass
    k[3] = (p - (q.resistance + rise * v) * i) / (q.coil_inductance + added)
    k[4] = drive * math.cos(q.supply_speed * t + q.supply_phase) - q.elastance * i
    k[5] = x
    k[6] = contact * x
    k[7] = q.resistance * i * i + magnetic * v


@kernel
def by_runge_kutta(table, record, halves, steps):
    """Return (u, v, x, i, p, w, impact work, electric work), shape (8, n), friction by signum.

    Classical steps of constant length, so many in half a control period.
    """
    end = np.empty((8, len(table)))
    y, stage, k, total = np.empty(8), np.empty(8), np.empty(8), np.empty(8)
    for row in range(len(table)):
        q, first = mole_of(table, row), int(record[row, HALF])
        h = 0.5 * q.control_period / steps
        y[:5], y[5:] = record[row, :5], 0.0
        for half in range(first, first + halves):
            on = half % 2 == 0
            drive = q.supply_speed * q.voltage if on else 0.0
            for step in range(steps):
                t = (half * steps + step) * h
                stage[:] = y
                for i in range(4):
                    reach = 0.0 if i == 0 else (h if i == 3 else 0.5 * h)
                    _slide(q, drive, t + reach, stage, k)
                    weight = h / 6 if i == 0 or i == 3 else h / 3
                    reach = h if i == 2 else 0.5 * h
                    for j in range(8):
                        total[j] = weight * k[j] + (0.0 if i == 0 else total[j])
                        stage[j] = y[j] + reach * k[j]
                for j in range(8):
                    y[j] += total[j]
            due = (half + 1) * 0.5 * q.control_period
            jump = q.voltage * math.sin(q.supply_speed * due + q.supply_phase)
            y[4] += -jump if on else jump
        end[:, row] = y
    return end
