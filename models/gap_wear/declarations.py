"""Wear of one gap by a work-rate that is a power of the gap: inputs, settings and outputs.

Equations, with V the worn volume of both bodies, h the growth of the gap by wear and X the gap:

    (1)  dV/dt = (1 + kappa) k U,  U = U_0 (X/X_0)^m,  no wear while X <= 0
    (2)  V = B h^p; for an inclined bar V = B [h^p - (h - theta L_s)^p] where h > theta L_s
    (3)  X = X_i + h + C_c [1 - exp(-t/tau_c)] + delta_0 (1 - phi) [1 - exp(-t/tau_r)]
             - s max(0, t - t_s) + f H(t)
    (4)  X_i = -delta_0 for a support preloaded by delta_0 > 0, else X_0
    (5)  depth of the rod's scar = h/(1 + kappa); down to delta_ox, k U is multiplied by psi_ox

H is `gap_history`. A law of wear (`models.numerics.wear_laws`) changes the rate k U of the rod;
states of duty (`models.numerics.duty`) multiply k and U_0, and offset X.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from uq.contract import Output, Parameter, Setting, Table

SCARS = ("prismatic", "flat-bar", "dimple", "inclined")
"""As in `models.numerics.scars`."""

WEAR_LAWS = ("archard", "power", "running-in", "edf")
"""As in `models.numerics.wear_laws.laws`."""

ORDERS = ("mixed", "sequence")
"""As in `models.numerics.duty`."""

FACTORS = ("work_rate",)
"""Factors of a duty state, beside that on the wear."""

_PLANT = "assumed: order of magnitude of a plant"


# fmt: off
class GapWearParameters(NamedTuple):
    """Inputs of the wear of one gap."""

    initial_gap: Annotated[float, Parameter(
        "X_0", "m", "gap when new, at which the work-rate is U_0", (1e-7, 1e-1), "assumed")] = 1e-4
    work_rate: Annotated[float, Parameter(
        "U_0", "W", "work-rate at the initial gap", (0.0, 1e3), _PLANT)] = 5e-3
    exponent: Annotated[float, Parameter(
        "m", "1", "exponent of the work-rate", (0.0, 8.0), "assumed")] = 0.0
    wear_coefficient: Annotated[float, Parameter(
        "k", "m2 N-1", "volume worn off the rod per work", (0.0, 1e-9),
        "tables of Code_Aster")] = 1e-14
    contact_area: Annotated[float, Parameter(
        "S", "m2", "area of a prismatic scar", (1e-9, 1e-2), "assumed")] = 4.4e-5
    support_wear_ratio: Annotated[float, Parameter(
        "kappa", "1", "volume worn off the support over that of the rod", (0.0, 1e3),
        "assumed")] = 0.0
    creep_down: Annotated[float, Parameter(
        "C_c", "m", "growth of the gap by creep-down in the end", (0.0, 1e-2),
        "assumed: none")] = 0.0
    creep_time: Annotated[float, Parameter(
        "tau_c", "s", "time constant of creep-down", (1e3, 1e12), "assumed: 1.5 years")] = 4.7e7
    rod_radius: Annotated[float, Parameter(
        "R", "m", "radius of the rod, for scars that are not prismatic", (1e-4, 1.0),
        "assumed: a tube of 17.4 mm")] = 8.7e-3
    support_width: Annotated[float, Parameter(
        "L_s", "m", "width of the support, for scars of bars", (1e-4, 1.0), "assumed")] = 1.2e-2
    support_radius: Annotated[float, Parameter(
        "R_s", "m", "radius of the support, for scars of dimples", (1e-4, 1.0), "assumed")] = 1e-2
    support_inclination: Annotated[float, Parameter(
        "theta", "1", "angle of an inclined bar [rad]", (1e-4, 0.5), "assumed")] = 1e-2
    preload_deflection: Annotated[float, Parameter(
        "delta_0", "m", "deflection of a preloaded support when new; 0: the gap is open",
        (0.0, 1e-2), "assumed: none")] = 0.0
    relaxed_share: Annotated[float, Parameter(
        "phi", "1", "preload when relaxed over that when new", (0.0, 1.0),
        "assumed: no relaxation")] = 1.0
    relaxation_time: Annotated[float, Parameter(
        "tau_r", "s", "time constant of relaxation", (1e3, 1e12), "assumed: 1.5 years")] = 4.7e7
    swelling_rate: Annotated[float, Parameter(
        "s", "m s-1", "closing of the gap by swelling", (0.0, 1e-6), "assumed: none")] = 0.0
    swelling_start: Annotated[float, Parameter(
        "t_s", "s", "time from which swelling closes the gap", (0.0, 1e12), "assumed")] = 0.0
    gap_history_factor: Annotated[float, Parameter(
        "f", "1", "factor on the setting gap_history", (0.0, 100.0), "assumed: exact")] = 1.0
    oxide_thickness: Annotated[float, Parameter(
        "delta_ox", "m", "depth of the rod's scar down to which oxide wears", (0.0, 1e-3),
        "assumed: none")] = 0.0
    oxide_wear_factor: Annotated[float, Parameter(
        "psi_ox", "1", "rate of wear of the oxide over that of the rod", (1e-3, 1e3),
        "assumed: wears alike")] = 1.0
# fmt: on


@dataclass(frozen=True)
class GapWearSettings:
    """Numerical choices of the wear of one gap."""

    depths: Annotated[
        tuple[float, ...],
        Setting("depths of the rod's scar whose lives are reported", "m", bounds=(1e-9, 1e-1)),
    ] = (4.36e-4,)
    growths: Annotated[
        tuple[float, ...],
        Setting("growths of the gap whose times are reported", "m", (1e-9, 1e-1), optional=True),
    ] = ()
    scar: Annotated[str, Setting("shape of the scar", choices=SCARS)] = "prismatic"
    wear_law: Annotated[
        str, Setting("law by which volume is worn off, from work-rates", choices=WEAR_LAWS)
    ] = "archard"
    wear_law_numbers: Annotated[
        Table, Setting("numbers of the law of wear, by name", optional=True)
    ] = ()
    gap_history: Annotated[
        tuple[tuple[float, float], ...],
        Setting("times [s] and changes of the gap [m], piecewise linear", optional=True),
    ] = ()
    duty: Annotated[
        tuple[Table, ...],
        Setting(
            "states of operation: name, share or duration [s], factors wear and work_rate,"
            " gap_offset [m]",
            optional=True,
        ),
    ] = ()
    order: Annotated[
        str, Setting("whether the states of duty mix or follow each other", choices=ORDERS)
    ] = "mixed"
    instants: Annotated[
        tuple[float, ...],
        Setting("times at which growth is reported", "s", bounds=(1e-6, 1e15), optional=True),
    ] = ()
    accuracy: Annotated[
        float,
        Setting("relative accuracy of the times; steps follow its square root", "1", (1e-8, 0.1)),
    ] = 1e-4
    horizon: Annotated[
        float, Setting("times beyond it are censored", "s", (1.0, 1e15))
    ] = 1e11  # fmt: skip
    step_budget: Annotated[
        int, Setting("largest number of steps of a row", bounds=(1, 100_000_000))
    ] = 1_000_000

    def __post_init__(self):
        if not self.depths:
            raise ValueError("depths must be a list of increasing numbers")
        for name in ("depths", "growths", "instants"):
            values = getattr(self, name)
            if any(b <= a for a, b in zip(values, values[1:], strict=False)):
                raise ValueError(f"{name} must be a list of increasing numbers")
        if self.instants and self.instants[-1] > self.horizon:
            raise ValueError("instants must not lie beyond the horizon")
        if self.wear_law != "archard" or self.wear_law_numbers or self.duty or self.gap_history:
            from models.numerics.duty import duty_numbers, history_numbers  # import numba
            from models.numerics.wear_laws.laws import law_numbers

            law_numbers(self.wear_law, self.wear_law_numbers)
            duty_numbers(self.duty, self.order, FACTORS)
            history_numbers(self.gap_history)


def coordinates(settings: GapWearSettings) -> Mapping[str, Sequence[Any]]:
    """Return the coordinates of the outputs' dimensions."""
    return {"depth": settings.depths, "growth": settings.growths, "instant": settings.instants}


_EVENTS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "time_to_depth": ("time until the rod's scar reaches the depth", ("depth",)),
    "time_to_gap_growth": ("time until the gap has grown, by wear or by itself", ("growth",)),
    "time_to_opening": ("time until the gap is open", ()),
}

OUTPUTS: Mapping[str, Output] = {
    name: output
    for event, (meaning, dims) in _EVENTS.items()
    for name, output in (
        (event, Output("s", meaning, "lifetime", dims, accuracy="accuracy")),
        (
            f"{event}_error",
            Output("s", f"numerical error of {event}, at most", dims=dims, may_be_undefined=True),
        ),
    )
} | {
    "worn_depth": Output("m", "depth of the rod's scar at the instant", dims=("instant",)),
    "gap": Output("m", "gap at the instant, without the offset of a state", dims=("instant",)),
    "wear_share": Output(
        "1",
        "share of the gap's growth until the instant that is by wear",
        dims=("instant",),
        may_be_undefined=True,
    ),
}
