"""Parameters and settings of the beam, each declared once.

Nominal values after Knudsen & Massih (ASME IMECE 2002), whose printed table is only partly legible:
a source is "given" where the number is legible, "inferred" where it was recovered from the paper's
results, "fitted" where it was chosen to match them, "assumed" where the paper has none.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

from uq.contract import Parameter, Setting, Table

PAPER = "Knudsen & Massih 2002, Table 1"
GIVEN, INFERRED = f"{PAPER}: given", f"{PAPER}: inferred"
SITES = ("right", "left")
LONGEST_PERIOD = 16
"""Forcing periods of the longest response that is recognised as periodic."""
PERIODS = ("aperiodic", *map(str, range(1, LONGEST_PERIOD + 1)))
REGIMES = ("no-impact", "period-1-symmetric", "period-1-asymmetric", "period-k", "aperiodic")


# fmt: off
class Params(NamedTuple):
    """Physical inputs of the beam."""

    length: Annotated[float, Parameter(
        "L", "m", "length of the beam", (0.02, 20.0), GIVEN)] = 0.64
    flexural_rigidity: Annotated[float, Parameter(
        "EI", "N m2", "flexural rigidity of the rod", (0.4, 450.0),
        f"{GIVEN}, its leading digit restored")] = 14.90
    mass_per_length: Annotated[float, Parameter(
        "rho A", "kg m-1", "mass per length, pellets included", (0.02, 22.0),
        "assumed: area 7.1e-5 m2 given, density 1e4 kg m-3 assumed")] = 0.71
    lateral_support_stiffness: Annotated[float, Parameter(
        "k_tra", "N m-1", "lateral stiffness of the support", (6e3, 6e6),
        "fitted to the published frequencies of period-one branches; rivals 1.2e5, 2.1e5")] = 1.84e5
    rotational_support_stiffness: Annotated[float, Parameter(
        "k_rot", "N m rad-1", "rotational stiffness of the support", (15.0, 1.7e4),
        f"{GIVEN}, its exponent inferred")] = 535.0
    contact_stiffness: Annotated[float, Parameter(
        "k_c", "N m-1", "stiffness of each elastic stop", (1e2, 1e7),
        f"{INFERRED}, printed without its leading digit")] = 13750.0
    force_amplitude: Annotated[float, Parameter(
        "F", "N", "amplitude of the harmonic force at the tip", (0.0, 200.0), GIVEN)] = 6.0
    forcing_frequency: Annotated[float, Parameter(
        "Omega/(2 pi)", "Hz", "frequency of the force", (1.0, 1800.0),
        "the paper's second case, omega = 9.900; its first, omega = 5.61, is 32.3591 Hz")] = 57.1042
    initial_gap: Annotated[float, Parameter(
        "X0", "m", "mean gap between rod and stop when new", (8e-6, 8e-3), INFERRED)] = 2.5e-4
    gap_asymmetry: Annotated[float, Parameter(
        "a", "1", "right gap X0 (1 + a/2), left gap X0 (1 - a/2)", (-1.9, 1.9),
        "assumed: the paper's stops are placed symmetrically")] = 0.0
    mass_damping: Annotated[float, Parameter(
        "c_m", "s-1", "mass-proportional damping", (0.05, 60.0),
        "inferred: 1 to 6 reproduce the paper equally well")] = 2.0
    stiffness_damping: Annotated[float, Parameter(
        "c_k", "s", "stiffness-proportional damping", (4e-7, 3.6e-4),
        "inferred: 1e-5 to 2.5e-5 reproduce the paper equally well")] = 1.2e-5
    wear_coefficient: Annotated[float, Parameter(
        "k", "m2 N-1", "worn volume per impact work at the right site", (1e-18, 1e-10),
        "assumed: the paper keeps k symbolic")] = 1e-14
    wear_coefficient_ratio: Annotated[float, Parameter(
        "k_2/k_1", "1", "wear coefficient of the left site over that of the right", (1 / 30, 30.0),
        "assumed: both sites of one material")] = 1.0
    contact_area: Annotated[float, Parameter(
        "S", "m2", "worn area of each site", (1e-8, 1e-2), "assumed")] = 4e-6
    initial_displacement: Annotated[float, Parameter(
        "X_c(0)", "m", "tip displacement at the start, in the shape of the first mode", (-0.1, 0.1),
        "at rest, assumed", initial=True)] = 0.0
    initial_velocity: Annotated[float, Parameter(
        "dX_c/dt(0)", "m s-1", "tip velocity at the start, in the shape of the first mode",
        (-10.0, 10.0), "at rest, assumed", initial=True)] = 0.0
    random_force_level: Annotated[float, Parameter(
        "S_F", "N2 Hz-1", "one-sided spectral level of the random force at the tip", (0.0, 1e3),
        "no random force, assumed: the paper names it as the next step")] = 0.0
    random_force_low: Annotated[float, Parameter(
        "f_low", "Hz", "lower end of the random force's band", (0.0, 1e3),
        "assumed: well below the first natural frequency, 5.8 Hz")] = 2.0
    random_force_high: Annotated[float, Parameter(
        "f_high", "Hz", "upper end of the random force's band; it must be above the lower one",
        (1.0, 6e3),
        "assumed: the first four natural frequencies, up to 189 Hz, are within the band")] = 200.0
    support_wear_ratio: Annotated[float, Parameter(
        "kappa", "1", "volume worn off the support over that of the rod", (0.0, 1e3),
        "assumed: the rod alone wears")] = 0.0
    rod_radius: Annotated[float, Parameter(
        "R", "m", "radius of the rod, for scars that are not prismatic", (1e-4, 1.0),
        "assumed: cladding of 9.5 mm")] = 4.75e-3
    support_width: Annotated[float, Parameter(
        "L_s", "m", "width of the support, for scars of bars", (1e-4, 0.3), "assumed")] = 3e-3
    support_radius: Annotated[float, Parameter(
        "R_s", "m", "radius of the support, for scars of dimples", (1e-4, 1.0), "assumed")] = 1e-2
    support_inclination: Annotated[float, Parameter(
        "theta", "1", "angle of an inclined bar [rad]", (1e-4, 0.5), "assumed")] = 1e-2
    creep_down: Annotated[float, Parameter(
        "C_c", "m", "growth of the gaps by creep-down of the rod in the end", (0.0, 1e-2),
        "assumed: none")] = 0.0
    creep_time: Annotated[float, Parameter(
        "tau_c", "s", "time constant of creep-down", (1e3, 1e12), "assumed: 1.5 years")] = 4.7e7
    preload_deflection: Annotated[float, Parameter(
        "delta_0", "m", "deflection of preloaded supports when new; 0: the gaps are open",
        (0.0, 1e-2), "assumed: none")] = 0.0
    relaxed_share: Annotated[float, Parameter(
        "phi", "1", "preload when relaxed over that when new", (0.0, 1.0),
        "assumed: no relaxation")] = 1.0
    relaxation_time: Annotated[float, Parameter(
        "tau_r", "s", "time constant of relaxation", (1e3, 1e12), "assumed: 1.5 years")] = 4.7e7
    swelling_rate: Annotated[float, Parameter(
        "s", "m s-1", "closing of the gaps by swelling", (0.0, 1e-6), "assumed: none")] = 0.0
    swelling_start: Annotated[float, Parameter(
        "t_s", "s", "time from which swelling closes the gaps", (0.0, 1e12), "assumed")] = 0.0
    gap_history_factor: Annotated[float, Parameter(
        "f", "1", "factor on the setting gap_history", (0.0, 100.0), "assumed: exact")] = 1.0
    oxide_thickness: Annotated[float, Parameter(
        "delta_ox", "m", "depth of the scar in the cladding down to which oxide wears", (0.0, 1e-3),
        "assumed: none")] = 0.0
    oxide_wear_factor: Annotated[float, Parameter(
        "psi_ox", "1", "rate of wear of the oxide over that of the rod", (1e-3, 1e3),
        "assumed: wears alike")] = 1.0
# fmt: on

OF_PROCESSES = Params._fields[Params._fields.index("support_wear_ratio") :]
"""Inputs of processes beside wear by impact, and of shapes of scars."""

FACTORS = ("force", "frequency", "random_level")
"""Factors of a duty state, beside that on the wear."""

SCARS = ("prismatic", "flat-bar", "dimple", "inclined")
"""As in `models.numerics.scars`."""

WEAR_LAWS = ("archard", "power", "running-in", "edf")
"""As in `models.numerics.wear_laws.laws`."""

ORDERS = ("mixed", "sequence")
"""As in `models.numerics.duty`."""


Rows = Any
"""n beams at once: a `Params` whose fields are arrays of shape (n,)."""


@dataclass(frozen=True)
class Settings:
    """Numerical choices of the beam."""

    propagator: Annotated[
        Literal["fast", "exact"],
        Setting(
            "fast: fixed steps, many rows at once; exact: event-driven, one row at a time",
            choices=("fast", "exact"),
        ),
    ] = "fast"
    elements: Annotated[int, Setting("finite elements; part of the model", bounds=(1, 40))] = 10
    modes: Annotated[
        int, Setting("modes kept, lowest first; 0 keeps all 2 elements + 2", bounds=(0, 82))
    ] = 0
    residual_flexibility: Annotated[
        bool,
        Setting("whether the truncated modes still yield to the contact force, as springs"),
    ] = False
    steps_per_period: Annotated[
        int,
        Setting(
            "steps of the fast propagator per forcing period; 0 chooses for each row",
            bounds=(0, 100_000),
        ),
    ] = 0
    depths: Annotated[
        tuple[float | str, ...],
        Setting(
            "depths of the scar in the cladding whose lives are reported; '40 %' is a share of the"
            " wall",
            "m",
            bounds=(1e-9, 1e-1),
        ),
    ] = (1.25e-4, 2.5e-4, 5e-4)
    instants: Annotated[
        tuple[float, ...],
        Setting(
            "times at which the worn depth is reported; rows that differ only in the wear "
            "coefficient or the contact area then no longer share a simulation",
            "s",
            bounds=(1e-6, 1e12),
            optional=True,
        ),
    ] = ()
    horizon: Annotated[
        float, Setting("lifetimes beyond it are censored", "s", bounds=(0.0, float("inf")))
    ] = float("inf")
    accuracy: Annotated[
        float, Setting("target relative error of each lifetime", bounds=(1e-4, 1.0))
    ] = 0.02

    starts: Annotated[
        int,
        Setting(
            "further initial states from which each beam is settled, in search of coexisting "
            "responses; work_rate_error then covers all that are reached",
            bounds=(0, 1000),
        ),
    ] = 0

    wall_thickness: Annotated[
        float, Setting("wall that depths in percent refer to; 0: none", "m", bounds=(0.0, 1.0))
    ] = 0.0
    growths: Annotated[
        tuple[float, ...],
        Setting("growths of the gap whose times are reported", "m", (1e-9, 1e-1), optional=True),
    ] = ()
    scar: Annotated[str, Setting("shape of the scars", choices=SCARS)] = "prismatic"
    wear_law: Annotated[
        str, Setting("law by which volume is worn off, from work-rates", choices=WEAR_LAWS)
    ] = "archard"
    wear_law_numbers: Annotated[
        Table, Setting("numbers of the law of wear, by name", optional=True)
    ] = ()
    gap_history: Annotated[
        tuple[tuple[float, float], ...],
        Setting("times [s] and changes of the gaps [m], piecewise linear", optional=True),
    ] = ()
    duty: Annotated[
        tuple[Table, ...],
        Setting(
            "states of operation: name, share or duration [s], factors wear, force, frequency and"
            " random_level, gap_offset [m]",
            optional=True,
        ),
    ] = ()
    order: Annotated[
        str, Setting("whether the states of duty mix or follow each other", choices=ORDERS)
    ] = "mixed"
    map_growth: Annotated[
        float,
        Setting(
            "growth of each gap up to which the work-rates of rods under a random force are mapped"
            " and kept, so that lives under other wear, creep and duty need no new rows; 0: none",
            "m",
            bounds=(0.0, 1e-1),
        ),
    ] = 0.0
    response_budget: Annotated[
        int,
        Setting(
            "largest number of responses settled in a life with processes beside wear by impact",
            bounds=(1, 100_000),
        ),
    ] = 1000

    def __post_init__(self):
        depths = tuple(_depth(value, self.wall_thickness) for value in self.depths)
        object.__setattr__(self, "depths", depths)
        if self.residual_flexibility and self.propagator == "exact":
            raise ValueError("residual_flexibility needs propagator = 'fast'")
        if not depths or any(b <= a for a, b in zip(depths, depths[1:], strict=False)):
            raise ValueError("depths must be a list of increasing numbers")
        instants = self.instants
        if any(b <= a for a, b in zip(instants, instants[1:], strict=False)):
            raise ValueError("instants must be a list of increasing numbers")
        if instants and instants[-1] > self.horizon:
            raise ValueError("instants must not lie beyond the horizon")
        if any(b <= a for a, b in zip(self.growths, self.growths[1:], strict=False)):
            raise ValueError("growths must be a list of increasing numbers")
        if self.wear_law != "archard" or self.wear_law_numbers or self.duty or self.gap_history:
            from models.numerics.duty import duty_numbers, history_numbers  # import numba
            from models.numerics.wear_laws.laws import law_numbers

            law_numbers(self.wear_law, self.wear_law_numbers)
            duty = duty_numbers(self.duty, self.order, FACTORS)
            if not (duty[:, -len(FACTORS) + FACTORS.index("frequency")] > 0).all():
                raise ValueError("the frequency factor of every duty state must be positive")
            history_numbers(self.gap_history)


def _depth(value: float | str, wall: float) -> float:
    """Return a depth [m]; raise a `ValueError` in one line."""
    if not isinstance(value, str):
        return float(value)
    number = value.removesuffix("%").strip()
    try:
        percent = float(number)
    except ValueError:
        percent = 0.0
    if number == value.strip() or not 0 < percent <= 100:
        raise ValueError(f"depths: {value!r} must be a number of metres, or like '40 %'")
    if wall == 0:
        raise ValueError(f"depths: {value!r} needs wall_thickness")
    return percent / 100 * wall
