"""One mole over any time: a `models.numerics.propagator.ReferencePropagator`."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.mole.exact.events import run, run_in_soil
from models.mole.exact.states import Motion, State
from models.mole.parameters import Params
from models.mole.theory import equations
from models.mole.theory.friction import decide
from models.mole.theory.soil import started
from models.mole.theory.system import Mole

STEPS_PER_RADIAN = 10
_SPARE_STEPS = 10_000


def start(params: Params, q: Mole) -> State:
    """Return the state of one mole before its relay first closes."""
    y = np.zeros(equations.SIZE_IN_SOIL if _has_soil(q) else equations.SIZE)
    y[0], y[1] = u, v = params.initial_displacement, params.initial_velocity
    contact = u > q.stop_gap
    bar, mole = decide(q, v, 0.0, equations.force(q, contact, u, v, 0.0))
    soil = started(q, 0, 0.0, 0.0, q.soil_limit, mole) if _has_soil(q) else 0
    return State(0.0, y, contact, bar, mole, 0, soil)


def _has_soil(q: Mole) -> bool:
    return bool(q.soil_limit > 0 or q.soil_limit_gradient > 0)


def propagate(q: Mole, state: State, end: float, tolerance: float, times: ArrayLike = ()) -> Motion:
    """Follow one mole, as `models.numerics.propagator.ReferencePropagator` states.

    Parameters
    ----------
    q : Mole
    state : State
        Not changed.
    end : float
        When to stop [s], since the relay first closed.
    tolerance : float
        Allowed error of a step, relative to each component of the state, or to its `scales` if
        these are larger.
    times : array_like, shape (k,)
        When to sample the state [s], ascending.

    Returns
    -------
    Motion
    """
    q = Mole._make([*(float(field) for field in q[:-1]), int(q.formulation)])
    times = np.ascontiguousarray(times, float)
    y = np.array(state.y, float)
    samples = np.full((len(times), len(y)), np.nan)
    ended = (run_in_soil if len(y) == equations.SIZE_IN_SOIL else run)(
        q,
        float(state.time),
        y,
        bool(state.contact),
        int(state.bar),
        int(state.mole),
        int(state.switched),
        int(state.soil),
        float(end),
        float(tolerance),
        tolerance * scales(q)[: len(y)],
        int(STEPS_PER_RADIAN * _fastest(q) * max(end - state.time, 0.0)) + _SPARE_STEPS,
        times,
        samples,
    )
    return Motion(
        ended.status,
        State(ended.time, y, ended.contact, ended.bar, ended.mole, ended.switched, ended.soil),
        ended.contacts,
        ended.events,
        ended.lowest,
        ended.highest,
        ended.steps,
        samples,
    )


def _fastest(q: Mole) -> float:
    """Return the sum of the characteristic rates [s-1]."""
    soil = math.sqrt(q.soil_stiffness / q.mole_mass) + q.soil_damping / q.mole_mass
    soil += q.soil_stiffness / q.soil_damping if q.soil_damping > 0 else 0.0
    return (
        math.sqrt((q.contact_stiffness + q.spring_stiffness) / q.mass)
        + q.damping / q.mass
        + q.resistance / q.coil_inductance
        + math.sqrt(q.elastance / q.coil_inductance)
        + q.supply_speed
        + 2 * math.pi / q.control_period
        + (soil if _has_soil(q) else 0.0)
    )


def scales(q: Mole) -> NDArray[np.float64]:
    """Return the scale of each component of the state.

    Those of voltage and displacement are given; that of the current follows from the resistance; of
    energy from this current in the inductance added by the bar; of velocity and impulse from a bar
    with that energy.
    """
    current = q.voltage / q.resistance
    energy = 0.5 * q.bar_inductance * current**2
    velocity = math.sqrt(2 * energy / q.mass)
    length = 1 / math.sqrt(q.sharpness)
    motion = [length, velocity, velocity * q.mass / q.mole_mass, current, q.voltage, length]
    soil = [length, length, energy]
    return np.array([*motion, *[energy] * 5, velocity * q.mass, *soil])
