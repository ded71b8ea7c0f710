"""Outputs of the beam, each declared once."""

from collections.abc import Mapping, Sequence
from typing import Any

from models.beam.parameters import PERIODS, REGIMES, SITES, Settings
from models.beam.processes import scales
from uq.contract import Output


def coordinates(settings: Settings) -> Mapping[str, Sequence[Any]]:
    """Return the coordinates of the outputs' dimensions."""
    return {
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
        scales=scales,
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
}
