"""Which processes beside wear by impact are on, and what then still only scales lives."""

from collections.abc import Mapping
from typing import Any

from models.beam.parameters import Params, Settings

_CLOCKS = ("creep_down", "preload_deflection", "swelling_rate")
"""Parameters that are above 0 where a gap moves by itself."""

_SCAR_SCALES: Mapping[str, Mapping[str, float]] = {
    "prismatic": {"contact_area": 1.0},
    "flat-bar": {"support_width": 1.0, "rod_radius": 0.5},
    "dimple": {"rod_radius": 0.5, "support_radius": 0.5},
    "inclined": {"rod_radius": 0.5},
}
"""Exponents of B, the volume of a scar over a power of its depth."""


def is_neutral(settings: Settings) -> bool:
    """Return whether no setting turns a process beside wear by impact on."""
    chosen = settings.wear_law != "archard" or settings.duty or settings.gap_history
    return settings.scar == "prismatic" and not chosen


def has_processes(p: Any, settings: Settings) -> Any:
    """Return whether a process beside wear by impact is on, or a map is made; of n a mask."""
    is_oxidised = (p.oxide_thickness > 0) & (p.oxide_wear_factor != 1)
    moves = (p.creep_down > 0) | (p.preload_deflection > 0) | (p.swelling_rate > 0)
    is_mapped = (p.random_force_level > 0) & (settings.map_growth > 0)
    is_on = moves | (p.support_wear_ratio > 0) | is_oxidised | is_mapped
    return is_on | (not is_neutral(settings))


def has_clock(p: Any, settings: Settings) -> Any:
    """Return whether a process keeps time by itself, not by the wear; of n beams a mask."""
    moves = (p.creep_down > 0) | (p.preload_deflection > 0) | (p.swelling_rate > 0)
    return moves | _has_clock(settings)


def _has_clock(settings: Settings) -> bool:
    in_sequence = bool(settings.duty) and settings.order == "sequence"
    return bool(settings.gap_history) or settings.wear_law == "edf" or in_sequence


NO_OPENING = (
    "preload_deflection > 0 and nothing opens the gaps: set creep_down, or relaxed_share below 1"
)
NO_BAND = "random_force_level > 0 needs random_force_high above random_force_low"


def never_opens(p: Any, settings: Settings) -> Any:
    """Return whether gaps are preloaded and nothing can open them; of n beams a mask."""
    offsets = [value for state in settings.duty for key, value in state if key == "gap_offset"]
    opens = bool(settings.gap_history) or any(float(offset) > 0 for offset in offsets)
    is_preloaded = (p.preload_deflection > 0) & (p.creep_down == 0) & (p.relaxed_share == 1)
    return is_preloaded & (not opens)


def refusal(settings: Settings, constants: Mapping[str, float]) -> str:
    """Return why no row of a study can be computed; "" if some may be."""

    def given(*names: str) -> Params | None:
        values = {name: constants[name] for name in names if name in constants}
        return Params(**values) if len(values) == len(names) else None

    preload = given("preload_deflection", "creep_down", "relaxed_share")
    if preload and never_opens(preload, settings):
        return NO_OPENING
    band = given("random_force_level", "random_force_low", "random_force_high")
    return NO_BAND if band and not has_band(band) else ""


def has_band(p: Any) -> Any:
    """Return whether there is no random force, or its band has a width; of n beams a mask."""
    return (p.random_force_level == 0) | (p.random_force_high > p.random_force_low)


def scar_scales(settings: Settings) -> Mapping[str, float]:
    """Return the exponents of the parameters that only scale lives by the size of the scars.

    None if the rate of wear depends on the volume of the scar.
    """
    return {} if settings.wear_law == "running-in" else _SCAR_SCALES[settings.scar]


def scales(settings: Settings, constants: Mapping[str, float]) -> Mapping[str, float]:
    """Return the scaling exponents of lives, T ~ B/k; none where a process may keep its own time.

    With scars of any shape, wear of both bodies, oxide, laws of wear that depend on work-rate or
    depth, and mixed duty, the wear coefficient k and the size B of the scars set the time scale.
    """
    is_off = all(constants.get(name) == 0 for name in _CLOCKS)
    if not is_off or _has_clock(settings):
        return {}
    return {"wear_coefficient": -1.0, **scar_scales(settings)}


def linear_scales(settings: Settings, constants: Mapping[str, float]) -> Mapping[str, float]:
    """Return the scaling exponents of lives at constant work-rates by Archard's law."""
    return {"wear_coefficient": -1.0, **_SCAR_SCALES[settings.scar]}
