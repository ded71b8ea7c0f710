"""Parameters, settings and outputs of the vibrator, each declared once.

Nominal values after Michalczyk & Cieplok (Arch. Min. Sci. 59, 2014), not all of whose digits are
legible: a source is "given" where the number is legible, "inferred" where it was recovered from the
paper's results, "assumed" where the paper has none.

C is the mass centre of the bare body, xi the working axis through C at the working angle from the
horizontal x, eta perpendicular to it, a quarter turn counter-clockwise of xi.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, pi
from typing import Annotated, Any, Literal, NamedTuple

from uq.contract import Output, Parameter, Setting, Table

PAPER = "Michalczyk & Cieplok 2014"
GIVEN, INFERRED = f"{PAPER}: given", f"{PAPER}: inferred"
SYMBOLIC, HANGING = "assumed: the paper keeps it symbolic", "assumed: hanging down"
BOLTED, IN_BODY = (
    "assumed: bolted to the body; the paper keeps it symbolic",
    "assumed: part of the body",
)
BEARING = "assumed: friction coefficient times half the bore, 0 to 3e-4 likely"
REGIMES = ("locked-0", "locked-pi", "asynchronous", "captured", "one-stalled")
CAUSES = ("angle", "lost-synchronisation", "spring-break")
NO_AGEING = "assumed: no ageing; 2e7 to 2e8, 5,000 to 50,000 hours, likely"


# fmt: off
class Params(NamedTuple):
    """Physical inputs of the vibrator."""

    body_mass: Annotated[float, Parameter(
        "M_k", "kg", "mass of the body without motor set", (60.0, 6e4), GIVEN)] = 2000.0
    body_inertia: Annotated[float, Parameter(
        "J_Ck", "kg m2", "moment of inertia of the body about its mass centre C", (80.0, 8.1e4),
        f"{INFERRED}, printed 667, which cannot give the published angles")] = 2667.0
    unbalance_1: Annotated[float, Parameter(
        "m e_1", "kg m", "static unbalance of vibrator 1", (0.1, 150.0), GIVEN)] = 5.0
    unbalance_2: Annotated[float, Parameter(
        "m e_2", "kg m", "static unbalance of vibrator 2", (0.1, 150.0), GIVEN)] = 5.0
    unbalanced_mass: Annotated[float, Parameter(
        "m", "kg", "unbalanced mass of each vibrator", (3.0, 3000.0),
        "assumed: 50 to 200 likely")] = 100.0
    rotor_inertia: Annotated[float, Parameter(
        "J_zr", "kg m2", "moment of inertia of each rotor about its own mass centre", (0.015, 15.0),
        GIVEN)] = 0.5
    support_half_spacing: Annotated[float, Parameter(
        "l", "m", "half the distance between the supports", (0.03, 30.0), GIVEN)] = 1.0
    working_angle: Annotated[float, Parameter(
        "beta", "rad", "angle from x to the working axis", (-pi, pi), GIVEN)] = pi / 6
    shaft_half_angle: Annotated[float, Parameter(
        "gamma", "rad", "half the angle between the shafts seen from C", (0.0, pi),
        f"{GIVEN}, 14 degrees")] = 14 * pi / 180
    shaft_distance: Annotated[float, Parameter(
        "D", "m", "distance from C to each shaft", (0.02, 24.0), GIVEN)] = 0.8
    axis_offset: Annotated[float, Parameter(
        "w_C", "m", "distance of the midpoint of the shafts from xi, along eta", (-24.0, 24.0),
        f"{GIVEN}, its symmetric case")] = 0.0
    rated_torque_1: Annotated[float, Parameter(
        "M_zn1", "N m", "rated torque of motor 1", (8.0, 7200.0),
        f"{INFERRED}, printed 40")] = 240.0
    rated_torque_2: Annotated[float, Parameter(
        "M_zn2", "N m", "rated torque of motor 2", (8.0, 7200.0),
        f"{INFERRED}, printed 40")] = 240.0
    overload_capacity: Annotated[float, Parameter(
        "p", "1", "breakdown torque over rated torque", (0.08, 75.0), GIVEN)] = 2.5
    synchronous_speed_1: Annotated[float, Parameter(
        "omega_s1", "rad s-1", "synchronous speed of motor 1", (5.0, 4710.0), INFERRED)] = 157.0
    synchronous_speed_2: Annotated[float, Parameter(
        "omega_s2", "rad s-1", "synchronous speed of motor 2", (5.0, 4710.0), INFERRED)] = 157.0
    breakdown_speed_1: Annotated[float, Parameter(
        "omega_u1", "rad s-1", "speed of motor 1 at its breakdown torque", (4.0, 3780.0),
        INFERRED)] = 126.0
    breakdown_speed_2: Annotated[float, Parameter(
        "omega_u2", "rad s-1", "speed of motor 2 at its breakdown torque", (4.0, 3780.0),
        INFERRED)] = 126.0
    bearing_constant_1: Annotated[float, Parameter(
        "rho_1", "m", "bearing torque of vibrator 1 over its centrifugal force", (0.0, 3e-3),
        BEARING)] = 1e-4
    bearing_constant_2: Annotated[float, Parameter(
        "rho_2", "m", "bearing torque of vibrator 2 over its centrifugal force", (0.0, 3e-3),
        BEARING)] = 1e-4
    stiffness_x: Annotated[float, Parameter(
        "k_x", "N m-1", "horizontal stiffness of all supports", (2e4, 6.3e7),
        f"{INFERRED}; 2.07e6 in its symmetric case")] = 6.21e5
    stiffness_y: Annotated[float, Parameter(
        "k_y", "N m-1", "vertical stiffness of all supports", (6.9e4, 6.3e7), INFERRED)] = 2.07e6
    damping_ratio: Annotated[float, Parameter(
        "xi", "1", "damping of the supports, b = 2 xi sqrt((M_k + 2m) k)", (0.0, 1.0),
        f"{GIVEN}, 0.01 on steel springs, 0.07 on rubber")] = 0.01
    support_offset: Annotated[float, Parameter(
        "h", "m", "depth of the supports below C", (-12.0, 12.0),
        f"{INFERRED}; 0 in its symmetric case")] = -0.4
    mount_stiffness: Annotated[float, Parameter(
        "k_psi", "N m-1", "stiffness between motor set and body along the mount's direction",
        (1e4, inf), BOLTED)] = inf
    mount_angle: Annotated[float, Parameter(
        "psi", "rad", "angle from xi to the mount's direction", (-pi, pi), SYMBOLIC)] = 0.0
    mount_mass: Annotated[float, Parameter(
        "m_0", "kg",
        "mass of the motor set without unbalanced masses, at the midpoint of the shafts",
        (0.0, 6e3), IN_BODY)] = 0.0
    mount_damping_ratio: Annotated[float, Parameter(
        "zeta", "1",
        "damping of the mounts, with the whole set as the mass in 2 zeta sqrt(mass stiffness)",
        (0.0, 1.0), "assumed: none")] = 0.0
    mount_rotational_stiffness: Annotated[float, Parameter(
        "k_o", "N m rad-1",
        "stiffness against rotation of the motor set about the midpoint of the shafts",
        (1e3, inf), BOLTED)] = inf
    mount_inertia: Annotated[float, Parameter(
        "J_0", "kg m2",
        "moment of inertia of the motor set without unbalanced masses about that midpoint",
        (0.0, 6e3), IN_BODY)] = 0.0
    feed_mass: Annotated[float, Parameter(
        "m_n", "kg", "mass of the feed thrown by the deck", (0.0, 6e3), "assumed: empty")] = 0.0
    throw_coefficient: Annotated[float, Parameter(
        "k_p", "1",
        "vertical acceleration amplitude of the deck over gravity; sets the gravity of the feed",
        (0.05, 60.0), f"assumed: within single-stroke motion, as studied in {PAPER}")] = 2.0
    feed_position: Annotated[float, Parameter(
        "x_n", "m", "position of the feed from C along x", (-30.0, 30.0), "assumed: at C")] = 0.0
    initial_phase_1: Annotated[float, Parameter(
        "psi_1(0)", "rad", "phase of vibrator 1 at the start, from hanging down", (-pi, pi),
        HANGING, initial=True)] = 0.0
    initial_phase_2: Annotated[float, Parameter(
        "psi_2(0)", "rad", "phase of vibrator 2 at the start, from hanging down", (-pi, pi),
        HANGING, initial=True)] = 0.0
    gravity: Annotated[float, Parameter(
        "g", "m s-2", "gravity on the unbalanced masses; 9.81 matters while the motors start",
        (0.0, 30.0), f"assumed: none, as in (13) to (23) of {PAPER}")] = 0.0
    voltage_factor: Annotated[float, Parameter(
        "u", "1", "voltage of the supply over its rated value; torques go with its square",
        (0.03, 30.0), "assumed: rated voltage")] = 1.0
    support_imbalance: Annotated[float, Parameter(
        "kappa", "1",
        "stiffness and damping of the right support less those of the left, over their sum",
        (-0.95, 0.95), "assumed: equal supports")] = 0.0
    ramp_time: Annotated[float, Parameter(
        "t_r", "s", "time in which an inverter raises the synchronous speeds from 0", (0.0, 3600.0),
        "assumed: switched on directly")] = 0.0
    torque_lag: Annotated[float, Parameter(
        "tau_e", "s", "time constant by which motor torques follow (22)", (0.0, 10.0),
        "assumed: at once, as in the paper")] = 0.0
    ageing_time_1: Annotated[float, Parameter(
        "t_1", "s", "time in which the friction of bearing 1 doubles", (1e3, inf),
        NO_AGEING)] = inf
    ageing_time_2: Annotated[float, Parameter(
        "t_2", "s", "time in which the friction of bearing 2 doubles", (1e3, inf),
        NO_AGEING)] = inf
    ageing_exponent: Annotated[float, Parameter(
        "nu", "1", "exponent of time by which the friction of bearings grows", (0.03, 30.0),
        "assumed: 1 to 3 likely")] = 1.0
    support_hardening: Annotated[float, Parameter(
        "c", "1", "relative growth of the supports' stiffness per decade of time over 1000 hours",
        (0.0, 1.0), "assumed: none; 0 to 0.15 likely of rubber")] = 0.0
    spring_life: Annotated[float, Parameter(
        "eta_s", "s", "Weibull scale of the times at which springs break", (1e3, inf),
        "assumed: springs do not break")] = inf
    spring_shape: Annotated[float, Parameter(
        "b_s", "1", "Weibull shape of these times", (0.06, 60.0),
        "assumed: fatigue, 1.5 to 4 likely")] = 2.0
# fmt: on


FACTORS = ("feed_mass", "feed_position")
"""Parameters that a state of duty multiplies."""

Rows = Any
"""n machines at once: a `Params` whose fields are arrays of shape (n,)."""


@dataclass(frozen=True)
class Settings:
    """Numerical choices of the vibrator."""

    kinematics: Annotated[
        Literal["small", "exact"],
        Setting(
            "small: forces at the undeflected geometry; exact: at the deflected one",
            choices=("small", "exact"),
        ),
    ] = "small"
    propagator: Annotated[
        Literal["fast", "exact"],
        Setting(
            "fast: fixed steps, many rows at once; exact: error control, one row at a time",
            choices=("fast", "exact"),
        ),
    ] = "fast"
    run_up: Annotated[float, Setting("longest start simulated", "s", bounds=(1.0, 3600.0))] = 60.0
    instants: Annotated[
        tuple[float, ...],
        Setting(
            "times at which the speeds and the disphasing angle are reported",
            "s",
            bounds=(1e-6, 3600.0),
            optional=True,
        ),
    ] = ()
    tolerance: Annotated[
        float, Setting("relative tolerance of the exact propagator", bounds=(1e-13, 1e-3))
    ] = 1e-8
    steps_per_turn: Annotated[
        int,
        Setting(
            "steps of the fast propagator per revolution, of order 8; 0: of order 5, "
            "as many as each row needs",
            bounds=(0, 1000),
        ),
    ] = 0
    angle_limit: Annotated[
        float,
        Setting("disphasing angle beyond which a machine has failed", "rad", bounds=(0.0, pi)),
    ] = pi / 15
    springs: Annotated[
        int, Setting("springs at each side, which break one by one", bounds=(1, 100))
    ] = 4
    horizon: Annotated[
        float,
        Setting("times to disphasing beyond it are censored", "s", bounds=(1.0, 1e12)),
    ] = 3.15576e9
    run_down_phases: Annotated[
        tuple[float, ...],
        Setting(
            "phases of vibrator 1, from the working axis at its mean speed, at which synchronous"
            " motors are switched off; the run-down is then reported",
            "rad",
            bounds=(0.0, 2 * pi),
            optional=True,
        ),
    ] = ()
    run_down: Annotated[
        float, Setting("longest run-down simulated", "s", bounds=(1.0, 36000.0))
    ] = 1000.0
    service_times: Annotated[
        tuple[float, ...],
        Setting(
            "times in service at which the disphasing angle is reported",
            "s",
            bounds=(0.0, 1e11),
            optional=True,
        ),
    ] = ()
    duty: Annotated[
        tuple[Table, ...],
        Setting(
            "states of operation that a life counts: name, share of the time, wear (factor of the"
            " ageing), factors feed_mass and feed_position",
            optional=True,
        ),
    ] = ()
    body_points: Annotated[
        tuple[tuple[float, float], ...],
        Setting(
            "points of the body, [along the deck, above it] from C at rest, whose motion is "
            "included in the trajectory of a single run; rows of a study do not depend on them",
            "m",
            bounds=(-30.0, 30.0),
        ),
    ] = ()

    def __post_init__(self):
        instants = self.instants
        if any(b <= a for a, b in zip(instants, instants[1:], strict=False)):
            raise ValueError("instants must be a list of increasing numbers")
        if instants and instants[-1] > self.run_up:
            raise ValueError("instants must not lie beyond the run_up")
        times = self.service_times
        if any(b <= a for a, b in zip(times, times[1:], strict=False)):
            raise ValueError("service_times must be a list of increasing numbers")
        phases = self.run_down_phases
        if any(b <= a for a, b in zip(phases, phases[1:], strict=False)):
            raise ValueError("run_down_phases must be a list of increasing numbers")
        if self.duty:
            from models.numerics.duty import TIME, WEAR, duty_numbers  # imports numba

            duty = duty_numbers(self.duty, "mixed", FACTORS, has_gaps=False)
            if not (duty[:, TIME] * duty[:, WEAR] > 0).any():
                raise ValueError("a duty state must have a positive share and wear")


def coordinates(settings: Settings) -> Mapping[str, Sequence[Any]]:
    """Return the coordinates of the outputs' dimensions."""
    return {
        "instant": settings.instants,
        "run_down_phase": settings.run_down_phases,
        "service_time": settings.service_times,
    }


OUTPUTS: Mapping[str, Output] = {
    "disphasing_angle": Output(
        "rad",
        "disphasing angle psi_1 - psi_2, mean of one turn",
        "angle",
        may_be_undefined=True,
    ),
    "theory_disphasing_angle": Output(
        "rad", "disphasing angle by the averaged theory", "angle", may_be_undefined=True
    ),
    "angular_amplitude": Output(
        "rad",
        "amplitude of the body's rotation: first harmonic, one cycle per turn; half "
        "peak-to-peak where unlocked",
    ),
    "stroke_left": Output("m", "half peak-to-peak displacement along xi of the left deck end"),
    "stroke_right": Output("m", "half peak-to-peak displacement along xi of the right deck end"),
    "speed": Output("rad s-1", "mean speed of the vibrators"),
    "power_1": Output("W", "mean power of motor 1 before bearing loss"),
    "power_2": Output("W", "mean power of motor 2 before bearing loss"),
    "floquet_multiplier": Output(
        "1",
        "largest modulus of the Floquet multipliers over one revolution, except the trivial 1",
        may_be_undefined=True,
    ),
    "synchronisation_time": Output(
        "s",
        "time until the disphasing angle stays within 0.05 rad of its mean",
        "lifetime",
        success="the motors have locked",
        never_known_at_once=False,  # the step budget may end before the motors lock
    ),
    "max_excursion": Output(
        "m", "largest displacement of C during start-up, until its free vibration has died away"
    ),
    "run_up_speed_1": Output("rad s-1", "speed of vibrator 1 at the instant", dims=("instant",)),
    "run_up_speed_2": Output("rad s-1", "speed of vibrator 2 at the instant", dims=("instant",)),
    "run_up_angle": Output(
        "rad", "disphasing angle psi_1 - psi_2 at the instant", "angle", dims=("instant",)
    ),
    "regime": Output(
        "1", "type of steady state reached from the start", "category", categories=REGIMES
    ),
    "run_down_excursion": Output(
        "m",
        "largest displacement of C from switching off at the phase until the machine has run down",
        dims=("run_down_phase",),
        may_be_undefined=True,
    ),
    "run_down_time": Output(
        "s",
        "time until both vibrators turn slower than 0.05 of their synchronous speed",
        "lifetime",
        ("run_down_phase",),
        may_be_undefined=True,
        success="the machine has run down",
        never_known_at_once=False,  # without friction and damping it never comes to rest
    ),
    "service_angle": Output(
        "rad",
        "disphasing angle after the time in service",
        "angle",
        dims=("service_time",),
        may_be_undefined=True,
    ),
    "time_to_disphasing": Output(
        "s",
        "time in service until the disphasing angle exceeds the limit or synchronisation is lost",
        "lifetime",
        never_known_at_once=False,  # after the horizon, supports may harden without consequence
        causes=CAUSES,
    ),
    "time_to_disphasing_error": Output(
        "s", "numerical error of the time to disphasing", may_be_undefined=True
    ),
}
