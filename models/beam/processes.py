"""Which processes beside wear by impact are on, and what then still only scales lives."""

from collections.abc import Mapping
from typing import Any

from models.beam.parameters import Settings

_LIFE_SCALES = {"wear_coefficient": -1.0, "contact_area": 1.0}  # eq 12: gaps grow with their ratio

_SWITCHES = (
    "support_wear_ratio",
    "creep_down",
    "preload_deflection",
    "swelling_rate",
    "oxide_thickness",
)
"""Parameters that are above 0 where a process is on."""


def is_neutral(settings: Settings) -> bool:
    """Return whether no setting turns a process beside wear by impact on."""
    chosen = settings.wear_law != "archard" or settings.duty or settings.gap_history
    return settings.scar == "prismatic" and not chosen


def has_processes(p: Any, settings: Settings) -> Any:
    """Return whether a process beside wear by impact is on; of n beams a mask."""
    is_oxidised = (p.oxide_thickness > 0) & (p.oxide_wear_factor != 1)
    moves = (p.creep_down > 0) | (p.preload_deflection > 0) | (p.swelling_rate > 0)
    return moves | (p.support_wear_ratio > 0) | is_oxidised | (not is_neutral(settings))


def scales(settings: Settings, constants: Mapping[str, float]) -> Mapping[str, float]:
    """Return the scaling exponents of lives; none where a process may be on.

    With clocks of their own, processes do not follow the wear. Also where the equations scale,
    as with other scars, lives are integrated row by row: not to the last digits the same.
    """
    is_off = all(constants.get(name) == 0 for name in _SWITCHES)
    return _LIFE_SCALES if is_off and is_neutral(settings) else {}
