"""Outputs of the beam, each declared once."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from models.beam.parameters import PERIODS, REGIMES, SITES, Settings
from models.beam.processes import linear_scales, scales
from uq.contract import Output

MAP_NODES = 6
"""Growths of each gap at which work-rates are mapped."""

MAP_POSITIONS = tuple(
    0.5 - 0.5 * math.cos(math.pi * (node + 0.5) / MAP_NODES) for node in range(MAP_NODES)
)
"""These growths over the largest one: zeros of a Chebyshev polynomial."""


def _state_names(settings: Settings) -> tuple[str, ...]:
    """Return the names of the states of duty, or their numbers if they have none of their own."""
    numbers = [str(number) for number in range(1, len(settings.duty) + 1)]
    names = [
        str(dict(state).get("name", number))
        for state, number in zip(settings.duty, numbers, strict=True)
    ]
    return tuple((names if len(set(names)) == len(names) else numbers) or ("operation",))


def coordinates(settings: Settings) -> Mapping[str, Sequence[Any]]:
    """Return the coordinates of the outputs' dimensions."""
    is_mapped = settings.map_growth > 0
    growths = [settings.map_growth * position for position in MAP_POSITIONS * is_mapped]
    return {
        "state": _state_names(settings) if is_mapped else (),
        "right_growth": growths,
        "left_growth": growths,
        "site": SITES,
        "depth": settings.depths,
        "instant": settings.instants,
        "growth": settings.growths,
    }


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
        "time until the scar in the cladding at the site reaches the depth",
        "lifetime",
        ("site", "depth"),
        accuracy="accuracy",
        never_known_at_once=False,  # wear may stop after the horizon
        scales=scales,
    ),
    "time_to_depth_error": Output(
        "s",
        "numerical error of the site's time to depth",
        dims=("site", "depth"),
        may_be_undefined=True,
    ),
    "first_time_to_depth": Output(
        "s",
        "time until the scar in the cladding at either site reaches the depth",
        "lifetime",
        ("depth",),
        accuracy="accuracy",
        never_known_at_once=False,
        scales=scales,
        causes=SITES,
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
        scales=linear_scales,
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
        "depth of the scar in the cladding at the site by the instant, nine in ten within the"
        " accuracy of lives; the last of the depths once that is reached",
        dims=("site", "instant"),
    ),
    "largest_worn_depth": Output(
        "m",
        "depth of the deeper scar in the cladding (followed up to the last depth), at the instant",
        dims=("instant",),
    ),
    "gap": Output(
        "m",
        "gap of the site at the instant, without the offset of a duty state; undefined once the"
        " scar has the last of the depths",
        dims=("site", "instant"),
        may_be_undefined=True,
    ),
    "wear_share": Output(
        "1",
        "share of the gap's growth until the instant that is by wear",
        dims=("site", "instant"),
        may_be_undefined=True,
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
    "time_to_gap_growth": Output(
        "s",
        "time until the site's gap has grown, by wear or by itself",
        "lifetime",
        ("site", "growth"),
        accuracy="accuracy",
        never_known_at_once=False,
        scales=scales,
    ),
    "time_to_gap_growth_error": Output(
        "s",
        "numerical error of the site's time to the growth of its gap",
        dims=("site", "growth"),
        may_be_undefined=True,
    ),
    "time_to_opening": Output(
        "s",
        "time until the site's gap is open",
        "lifetime",
        ("site",),
        accuracy="accuracy",
        success="the gap has opened",
        never_known_at_once=False,
    ),
    "time_to_opening_error": Output(
        "s", "numerical error of the time to opening", dims=("site",), may_be_undefined=True
    ),
    "mapped_gap": Output(
        "m",
        "gap of the site from which its growth counts in mapped_work_rate",
        dims=("state", "site"),
        may_be_undefined=True,
        shown=False,
    ),
    "mapped_work_rate": Output(
        "W",
        "work-rate of the site under the random force of a state of duty, by growth of both gaps",
        dims=("state", "site", "right_growth", "left_growth"),
        may_be_undefined=True,
        shown=False,
    ),
    "mapped_work_rate_error": Output(
        "W",
        "standard error of the mapped work-rate",
        dims=("state", "site", "right_growth", "left_growth"),
        may_be_undefined=True,
        shown=False,
    ),
}
