"""Constants of the equations, of one mole or of n."""

import math
from typing import Any, NamedTuple

from models.mole.parameters import FORMULATIONS, Params

GRAVITY = 9.81  # m s-2


class Mole(NamedTuple):
    """Constants of the equations of motion, of one mole or of n as arrays of shape (n,).

    Attributes
    ----------
    mass : float
        m = m1 m2/(m1 + m2) [kg].
    bar_mass, mole_mass : float
        m1, m2 [kg].
    stop_gap, spring_rest : float
        G, X0 [m].
    spring_stiffness, contact_stiffness : float
        k1, k0 [N m-1].
    damping : float
        c [kg s-1].
    bar_limit, mole_limit : float
        Largest friction forces f1, f2 [N].
    coil_inductance, bar_inductance : float
        L0, and the largest inductance added by the bar [H].
    sharpness : float
        2/sigma^2 [m-2].
    resistance : float
        R [ohm].
    elastance : float
        1/C [F-1].
    voltage : float
        Vs [V].
    supply_speed : float
        Omega [rad s-1].
    supply_phase : float
        [rad]
    control_period : float
        [s]
    soil_stiffness, soil_damping : float
        k [N m-1], c [kg s-1] of the soil.
    soil_limit, soil_limit_gradient : float
        F_0 [N], F' [N m-1]: the force at which the soil gives way.
    formulation : int
        `PHYSICAL`, `PAPERS` or `AS_PRINTED`.
    """

    mass: Any
    bar_mass: Any
    mole_mass: Any
    stop_gap: Any
    spring_rest: Any
    spring_stiffness: Any
    contact_stiffness: Any
    damping: Any
    bar_limit: Any
    mole_limit: Any
    coil_inductance: Any
    bar_inductance: Any
    sharpness: Any
    resistance: Any
    elastance: Any
    voltage: Any
    supply_speed: Any
    supply_phase: Any
    control_period: Any
    soil_stiffness: Any
    soil_damping: Any
    soil_limit: Any
    soil_limit_gradient: Any
    formulation: Any


def mole(p: Params, formulation: str) -> Mole:
    """Return the constants of a mole; the fields of `p` may be arrays."""
    both = p.bar_mass + p.mole_mass
    return Mole(
        mass=p.bar_mass * p.mole_mass / both,
        bar_mass=p.bar_mass,
        mole_mass=p.mole_mass,
        stop_gap=p.stop_gap,
        spring_rest=p.spring_rest,
        spring_stiffness=p.spring_stiffness,
        contact_stiffness=p.contact_stiffness,
        damping=p.viscous_damping,
        bar_limit=p.bar_friction * p.bar_mass * GRAVITY,
        mole_limit=p.mole_friction * both * GRAVITY,
        coil_inductance=p.coil_inductance,
        bar_inductance=p.inductance_coefficient / (p.inductance_width * math.sqrt(math.pi / 2)),
        sharpness=2 / p.inductance_width**2,
        resistance=p.resistance,
        elastance=1 / p.capacitance,
        voltage=p.supply_voltage,
        supply_speed=2 * math.pi * p.supply_frequency,
        supply_phase=p.supply_phase,
        control_period=1 / p.control_frequency,
        soil_stiffness=p.soil_stiffness,
        soil_damping=p.soil_damping,
        soil_limit=p.soil_limit,
        soil_limit_gradient=p.soil_limit_gradient,
        formulation=FORMULATIONS.index(formulation),
    )
