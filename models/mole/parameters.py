"""Parameters, settings and outputs of the mole, each declared once.

Nominal values after Ho, Nguyen & Woo (Nonlinear Dyn. 63, 2011). The bar's displacement u is
relative to the mole, measured from the middle of the solenoid, positive forwards.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, pi
from typing import Annotated, Any, Literal, NamedTuple

from uq.contract import Output, Parameter, Setting

PAPER = "Ho, Nguyen & Woo 2011"
GIVEN, FITTED, ZERO = f"{PAPER}: given", f"{PAPER}: fitted", f"{PAPER}: zero in the simulations"
DIFFERENTIATED = f"{GIVEN}, estimated there by differentiating displacements twice"
RMS_GIVEN, MAINS = f"{PAPER}: 58 V RMS given", "assumed: European mains"
TURN = 2 * pi

LONGEST_PERIOD = 64
"""Common periods of the longest response that is recognised as periodic."""
PERIODS = ("non-repeating", *map(str, range(1, LONGEST_PERIOD + 1)))
REGIMES = ("no-impact", "periodic", "quasi-periodic", "chaotic", "undecided", "resting-on-stop")
FORMULATIONS = ("physical", "paper", "as-printed")
NO_IMPACT, PERIODIC, QUASI_PERIODIC, CHAOTIC, UNDECIDED, ON_STOP = range(6)
PHYSICAL, PAPERS, AS_PRINTED = range(3)
CAUSES = ("distance", "refusal", "heat")
"""Of the end of a drive: it arrives; or it never does, as the ground, or a warm coil, holds it."""
BY_DISTANCE, BY_REFUSAL, BY_HEAT = range(3)


# fmt: off
class Params(NamedTuple):
    """Physical inputs of the mole."""

    bar_mass: Annotated[float, Parameter(
        "m_1", "kg", "mass of the bar", (0.0099, 8.91), GIVEN)] = 0.297
    mole_mass: Annotated[float, Parameter(
        "m_2", "kg", "mass of the mole without bar", (0.098, 88.2), GIVEN)] = 2.94
    stop_gap: Annotated[float, Parameter(
        "G", "m", "displacement u at which the bar meets the stop", (-0.06, 0.06), GIVEN)] = -2e-3
    spring_stiffness: Annotated[float, Parameter(
        "k_1", "N m-1", "stiffness of the return spring", (0.0, 6e3), GIVEN)] = 200.0
    spring_rest: Annotated[float, Parameter(
        "X_0", "m", "displacement u at which the spring is slack", (-0.66, 0.66), GIVEN)] = -22e-3
    contact_stiffness: Annotated[float, Parameter(
        "k_0", "N m-1", "stiffness of the stop", (4e3, 3.8e6), DIFFERENTIATED)] = 1.24e5
    viscous_damping: Annotated[float, Parameter(
        "c", "kg s-1", "viscous damping of the bar", (0.0, 4.8), FITTED)] = 0.155
    bar_friction: Annotated[float, Parameter(
        "mu_1", "1", "friction of the bar in the mole", (0.0, 9.0), FITTED)] = 0.295
    mole_friction: Annotated[float, Parameter(
        "mu_2", "1", "friction of the mole on the ground", (0.0, 7.1), GIVEN)] = 0.235
    coil_inductance: Annotated[float, Parameter(
        "L_0", "H", "inductance of the coil without bar", (5e-3, 5.0), GIVEN)] = 0.1658
    inductance_coefficient: Annotated[float, Parameter(
        "A", "H m", "inductance added by the bar: area under L - L_0",
        (8e-4, 0.75), GIVEN)] = 0.02494
    inductance_width: Annotated[float, Parameter(
        "sigma", "m", "width of the added inductance about the middle",
        (1.6e-3, 1.45), GIVEN)] = 0.0483
    resistance: Annotated[float, Parameter(
        "R", "ohm", "resistance of the coil", (0.9, 825.0), GIVEN)] = 27.5
    capacitance: Annotated[float, Parameter(
        "C", "F", "capacitance in series", (1e-6, 9.6e-4), GIVEN)] = 32e-6
    supply_voltage: Annotated[float, Parameter(
        "V_s", "V", "amplitude of the supply voltage", (2.7, 2500.0), RMS_GIVEN)] = 82.02
    supply_frequency: Annotated[float, Parameter(
        "Omega/(2 pi)", "Hz", "frequency of the supply", (1.6, 1500.0), MAINS)] = 50.0
    control_frequency: Annotated[float, Parameter(
        "F_ctr", "Hz", "switching cycles per second", (0.08, 400.0), GIVEN)] = 8.0
    supply_phase: Annotated[float, Parameter(
        "phi", "rad", "phase of the supply when the relay first closes", (-TURN, TURN), ZERO)] = 0.0
    initial_displacement: Annotated[float, Parameter(
        "u(0)", "m", "displacement u at the start", (-0.66, 0.66), GIVEN,
        initial=True)] = -0.022
    initial_velocity: Annotated[float, Parameter(
        "v(0)", "m s-1", "rate of u at the start", (-10.0, 10.0), GIVEN, initial=True)] = 0.0
    friction_gradient: Annotated[float, Parameter(
        "mu_2'", "m-1", "growth of the mole's friction per distance driven", (-10.0, 10.0),
        "assumed: ground that does not change")] = 0.0
    coil_thermal_resistance: Annotated[float, Parameter(
        "R_th", "K W-1", "temperature rise of the coil per power; 0: it stays cold", (0.0, 1e3),
        "assumed: perfect cooling")] = 0.0
    coil_thermal_capacity: Annotated[float, Parameter(
        "C_th", "J K-1", "heat that warms the coil by 1 K", (1.0, 1e6),
        "assumed: about 1 kg of copper")] = 400.0
    soil_limit: Annotated[float, Parameter(
        "F_0", "N", "force at which the soil ahead of the mole gives way", (0.0, 1e4),
        "assumed: an open hole")] = 0.0
    soil_limit_gradient: Annotated[float, Parameter(
        "F'", "N m-1", "growth of that force per distance driven", (0.0, 1e4),
        "assumed: an open hole")] = 0.0
    soil_stiffness: Annotated[float, Parameter(
        "k_s", "N m-1", "stiffness of the soil until it gives way", (1e3, 1e7),
        "assumed: about that of the stop")] = 1e5
    soil_damping: Annotated[float, Parameter(
        "c_s", "kg s-1", "damping of the soil", (0.0, 1e4), "assumed: elastic soil")] = 0.0
# fmt: on


Rows = Any
"""`Params` of n moles, each field an ndarray of shape (n,)."""


@dataclass(frozen=True)
class Settings:
    """Numerical choices of the mole."""

    formulation: Annotated[
        Literal["physical", "paper", "as-printed"],
        Setting(
            "physical: the voltage jumps when the relay switches; paper: it does not, as in (12) "
            "and (17); as-printed: (20) to the letter, which creates energy",
            choices=FORMULATIONS,
        ),
    ] = "physical"
    transient: Annotated[
        int,
        Setting("control periods dropped; 0: until the motion repeats", bounds=(0, 100_000)),
    ] = 0
    duration: Annotated[
        int,
        Setting(
            "control periods averaged, rounded up to whole periods of the response, or to 20 "
            "times the common period where it does not repeat; 0: one period, or 200. Up to 16 "
            "times as many where the Lyapunov exponent is indistinguishable from zero",
            bounds=(0, 100_000),
        ),
    ] = 0
    tolerance: Annotated[float, Setting("relative tolerance of a step", bounds=(1e-13, 1e-4))] = (
        1e-8
    )
    distance: Annotated[
        tuple[float, ...],
        Setting("distances whose times are reported", "m", (0.0, 1e6), optional=True),
    ] = ()
    temperature: Annotated[
        tuple[float, ...],
        Setting(
            "temperature rises of the coil whose times are reported",
            "K",
            (0.0, 1e4),
            optional=True,
        ),
    ] = ()
    horizon: Annotated[
        float,
        Setting("times to distance and temperature beyond it are censored", "s", (0.0, inf)),
    ] = inf

    def __post_init__(self) -> None:
        for name in ("distance", "temperature"):
            values: Any = getattr(self, name)
            values = tuple(values) if isinstance(values, tuple | list) else (float(values),)
            values = () if values == (0.0,) else values  # 0 asks for nothing
            object.__setattr__(self, name, values)
            if any(b <= a for a, b in zip((0.0, *values), values, strict=False)):
                raise ValueError(f"{name} must be a list of increasing positive numbers")


def coordinates(settings: Settings) -> Mapping[str, Sequence[Any]]:
    """Return the coordinates of the outputs' dimensions."""
    return {"distance": settings.distance, "temperature": settings.temperature}


_EXTREME = "over the averaging time, with which it grows where the motion does not repeat"
_GROWTH = "expected at most over a time twenty times as long; 0 where the motion repeats"

OUTPUTS: Mapping[str, Output] = {
    "progression_rate": Output("m s-1", "mean velocity of the mole, positive forwards"),
    "progression_rate_error": Output(
        "m s-1", "standard error of the mean velocity, 0 where the motion repeats"
    ),
    "peak_contact_force": Output("N", f"largest force of the stop on the bar {_EXTREME}"),
    "peak_contact_force_error": Output("N", f"growth of the largest force {_GROWTH}"),
    "impact_work_rate": Output("W", "mean power of the contact force on the mole"),
    "impact_work_rate_error": Output(
        "W", "standard error of the impact work-rate, 0 where the motion repeats"
    ),
    "impacts_per_period": Output("1", "contacts per control period"),
    "impacts_per_period_error": Output(
        "1", "standard error of the contacts per control period, 0 where the motion repeats"
    ),
    "impact_impulse": Output(
        "N s", "mean impulse of the contact force per contact", may_be_undefined=True
    ),
    "impact_impulse_error": Output(
        "N s",
        "standard error of the mean impulse, 0 where the motion repeats",
        may_be_undefined=True,
    ),
    "impact_energy": Output(
        "J", "mean work of the contact force on the mole per contact", may_be_undefined=True
    ),
    "impact_energy_error": Output(
        "J", "standard error of the mean work, 0 where the motion repeats", may_be_undefined=True
    ),
    "displacement_range": Output("m", f"peak-to-peak displacement u {_EXTREME}"),
    "displacement_range_error": Output("m", f"growth of the peak-to-peak displacement {_GROWTH}"),
    "electrical_power": Output("W", "mean power drawn from the supply"),
    "electrical_power_error": Output(
        "W", "standard error of the electrical power, 0 where the motion repeats"
    ),
    "efficiency": Output("1", "impact work-rate over electrical power"),
    "efficiency_error": Output("1", "standard error of the efficiency, 0 where the motion repeats"),
    "lyapunov_exponent": Output(
        "s-1", "largest Lyapunov exponent, natural logarithm, excluding progression"
    ),
    "lyapunov_exponent_error": Output(
        "s-1", "standard error of the Lyapunov exponent, 0 where the motion repeats"
    ),
    "regime": Output("1", "type of settled response", "category", categories=REGIMES),
    "period": Output(
        "1", "common periods after which the response repeats", "category", categories=PERIODS
    ),
    "time_to_distance": Output(
        "s",
        "time until the mole has driven the distance",
        "lifetime",
        ("distance",),
        success="the distance has been driven",
        never_known_at_once=False,  # whether an irregular mole creeps at all may be undecided
        causes=CAUSES,
    ),
    "time_to_distance_error": Output(
        "s",
        "numerical error of the time to the distance, by the mean velocities and the steps",
        dims=("distance",),
        may_be_undefined=True,
    ),
    "time_to_temperature": Output(
        "s",
        "time until the coil has warmed by the temperature",
        "lifetime",
        ("temperature",),
        never_known_at_once=False,
    ),
    "time_to_temperature_error": Output(
        "s",
        "numerical error of the time to the temperature, by the mean powers and the steps",
        dims=("temperature",),
        may_be_undefined=True,
    ),
    "warm_temperature": Output(
        "K",
        "temperature rise of the coil: the temperature, or less where it settles before",
        dims=("temperature",),
        may_be_undefined=True,
    ),
    "warm_temperature_error": Output(
        "K",
        "numerical error of the warm temperature; 0 where the temperature is reached",
        dims=("temperature",),
        may_be_undefined=True,
    ),
    "warm_progression_rate": Output(
        "m s-1",
        "mean velocity of the mole with the coil at the warm temperature",
        dims=("temperature",),
        may_be_undefined=True,
    ),
    "warm_progression_rate_error": Output(
        "m s-1",
        "numerical error of the mean velocity when warm, by the means and the steps",
        dims=("temperature",),
        may_be_undefined=True,
    ),
}
