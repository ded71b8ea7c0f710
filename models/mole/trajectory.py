"""One labelled time history of the mole, from its start."""

import math

import numpy as np
from numpy.typing import NDArray

from models.mole import exact
from models.mole.parameters import AS_PRINTED, PHYSICAL, Params, Settings
from models.mole.theory.system import Mole, mole
from uq.contract import Trajectory

LEAST, LEAST_PERIODS = 4.0, 10  # s, and control periods
MOST_SAMPLES = 100_000
SHOWN = (
    "displacement",
    "contact_force",
    "mole_displacement",
    "mole_velocity",
    "current",
    "capacitor_voltage",
)
_PER_SUPPLY_CYCLE, _PER_CONTACT, _PER_CONTROL_PERIOD = 100, 20, 400

Array = NDArray[np.float64]


def simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    """Follow one mole from its start, for four seconds or ten control periods if longer.

    Parameters
    ----------
    params : Params
    settings : Settings
        Only formulation and tolerance are used.
    seed : int
        Not used: the mole is deterministic.

    Returns
    -------
    Trajectory
        It ends early if the step budget runs out.
    """
    q = mole(params, settings.formulation)
    time = _times(q)
    motion = exact.propagate(q, exact.start(params, q), time[-1], settings.tolerance, time)
    reached = time <= motion.state.time
    time = time[reached]
    u, v, x, i, p, w = motion.samples[reached].T[:6]
    relay, source = _supply(q, time)
    contact = q.contact_stiffness * np.maximum(u - q.stop_gap, 0.0)
    bar_friction, mole_friction = _friction(q, u, v, x, i, contact)
    quantities = {
        "displacement": ("m", "displacement u of the bar relative to the mole", u),
        "velocity": ("m s-1", "rate of u", v),
        "mole_displacement": ("m", "progression of the mole", w),
        "mole_velocity": ("m s-1", "velocity of the mole", x),
        "current": ("A", "current through the coil", i),
        "source_voltage": ("V", "voltage of the supply behind the relay", source),
        "capacitor_voltage": ("V", "voltage of the capacitor", source - p),
        "contact_force": ("N", "force of the bar on the stop", contact),
        "bar_friction": ("N", "friction of the mole on the bar, against its slip", bar_friction),
        "mole_friction": ("N", "friction of the ground on the mole", mole_friction),
        "relay": ("1", "1 while the relay is closed, else 0", relay),
    }
    return Trajectory(
        time,
        quantities,
        period=q.control_period,
        shown=SHOWN,
        stops={"displacement": (math.nan, q.stop_gap)},
    )


def _times(q: Mole) -> Array:
    end = max(LEAST, LEAST_PERIODS * q.control_period)
    contact = math.pi * math.sqrt(q.mass / q.contact_stiffness)
    supply = 2 * math.pi / q.supply_speed
    spacing = min(
        supply / _PER_SUPPLY_CYCLE,
        contact / _PER_CONTACT,
        q.control_period / _PER_CONTROL_PERIOD,
    )
    return np.linspace(0.0, end, min(math.ceil(end / spacing), MOST_SAMPLES) + 1)


def _supply(q: Mole, time: Array) -> tuple[Array, Array]:
    """Return relay and source voltage; at a switching instant, those before it.

    If the voltage does not jump, every switching leaves a permanent offset.
    """
    due = 0.5 * q.control_period * np.arange(2 + math.floor(2 * time[-1] / q.control_period))
    switched = np.searchsorted(due, time)
    relay = (switched % 2).astype(float)
    source = relay * q.voltage * np.sin(q.supply_speed * time + q.supply_phase)
    if q.formulation != PHYSICAL:
        jumps = q.voltage * np.sin(q.supply_speed * due + q.supply_phase)
        jumps[::2] *= -1
        source += np.concatenate([[0.0], np.cumsum(jumps)])[switched]
    return relay, source


def _friction(
    q: Mole, u: Array, v: Array, x: Array, i: Array, contact: Array
) -> tuple[Array, Array]:
    """Return T1 and T2 of (17); an interface at exactly zero velocity sticks.

    One that has just begun to slip, from zero, does so at the limit of sticking.
    """
    slope = -2 * q.sharpness * u * q.bar_inductance * np.exp(-q.sharpness * u**2)
    spring = q.spring_stiffness * (u - q.spring_rest)
    force = 0.5 * i**2 * slope - q.damping * v - spring - contact
    slipping = q.mole_limit * np.sign(x)
    coupled = 0.0 if q.formulation == AS_PRINTED else q.mass / q.mole_mass
    bar = np.where(v == 0, force + coupled * slipping, q.bar_limit * np.sign(v))
    return bar, np.where(x == 0, bar - force, slipping)
