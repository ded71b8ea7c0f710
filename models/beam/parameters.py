"""Parameters, settings and outputs of the beam, each declared once.

Nominal values after Knudsen & Massih (ASME IMECE 2002), whose printed table is only partly legible:
a source is "given" where the number is legible, "inferred" where it was recovered from the paper's
results, "fitted" where it was chosen to match them, "assumed" where the paper has none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

from uq.contract import Output, Parameter, Setting

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
# fmt: on


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
        tuple[float, ...],
        Setting("gap growths whose lifetimes are reported", "m", bounds=(1e-9, 1e-1)),
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

    def __post_init__(self):
        if self.residual_flexibility and self.propagator == "exact":
            raise ValueError("residual_flexibility needs propagator = 'fast'")
        depths = self.depths
        if not depths or any(b <= a for a, b in zip(depths, depths[1:], strict=False)):
            raise ValueError("depths must be a list of increasing numbers")
        instants = self.instants
        if any(b <= a for a, b in zip(instants, instants[1:], strict=False)):
            raise ValueError("instants must be a list of increasing numbers")
        if instants and instants[-1] > self.horizon:
            raise ValueError("instants must not lie beyond the horizon")


def coordinates(settings: Settings) -> Mapping[str, Sequence[Any]]:
    """Return the coordinates of the outputs' dimensions."""
    return {"site": SITES, "depth": settings.depths, "instant": settings.instants}


_LIFE_SCALES = {"wear_coefficient": -1.0, "contact_area": 1.0}  # eq 12: gaps grow with their ratio

OUTPUTS: Mapping[str, Output] = {
    "work_rate": Output("W", "impact work-rate of each site at the initial gaps", dims=("site",)),
    "work_rate_error": Output(
        "W",
        "numerical error of the work-rate in the response from this start: of the steps and of the"
        " time mean; also the distance of other responses from further starts, if set",
        dims=("site",),
    ),
    "work_rate_heavy": Output("W", "the larger of the two sites' work-rates"),
    "work_rate_light": Output("W", "the smaller of the two sites' work-rates"),
    "peak_contact_force": Output(
        "N", "largest contact force of each site at the initial gaps", dims=("site",)
    ),
    "time_to_depth": Output(
        "s",
        "time until the site's gap has grown by the depth",
        "lifetime",
        ("site", "depth"),
        accuracy="accuracy",
        never_known_at_once=False,  # wear may stop after the horizon
        scales=_LIFE_SCALES,
    ),
    "time_to_depth_error": Output(
        "s",
        "numerical error of the site's time to depth",
        dims=("site", "depth"),
        may_be_undefined=True,
    ),
    "first_time_to_depth": Output(
        "s",
        "time until either site's gap has grown by the depth",
        "lifetime",
        ("depth",),
        accuracy="accuracy",
        never_known_at_once=False,
        scales=_LIFE_SCALES,
    ),
    "first_time_to_depth_error": Output(
        "s",
        "numerical error of the earlier time to depth",
        dims=("depth",),
        may_be_undefined=True,
    ),
    "linear_time_to_depth": Output(
        "s",
        "earlier time to depth at constant initial work-rates",
        "lifetime",
        ("depth",),
        may_be_censored=False,
        scales=_LIFE_SCALES,
    ),
    "lifetime_ratio": Output(
        "1",
        "time to depth at the initial wear rate, over that with wear followed as the gaps grow",
        dims=("depth",),
        may_be_undefined=True,
    ),
    "gap_ratio": Output(
        "1",
        "gap of the less worn site over that of the more worn one at the first time to depth",
        dims=("depth",),
        may_be_undefined=True,
    ),
    "worn_depth": Output(
        "m",
        "growth of the site's gap by the instant, nine in ten within the accuracy of lives;"
        " the last of the depths once that is reached",
        dims=("site", "instant"),
    ),
    "largest_worn_depth": Output(
        "m",
        "larger worn depth of the two sites, at most the last of the depths, at the instant",
        dims=("instant",),
    ),
    "regime": Output("1", "type of response at the initial gaps", "category", categories=REGIMES),
    "period": Output(
        "1", "period of the response in forcing periods", "category", categories=PERIODS
    ),
    "floquet_multiplier": Output(
        "1",
        "largest modulus of the periodic response's Floquet multipliers, over its period",
        may_be_undefined=True,
    ),
    "regime_changes": Output(
        "1", "changes of regime until both sites have worn by the last depth, or wear has stopped"
    ),
    "fundamental_frequency": Output("Hz", "first natural frequency of the beam out of contact"),
}
