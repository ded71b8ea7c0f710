"""The statistics of an output. To add one, write its maker and list it here."""

from typing import Any

from uq.assess.statistic import Maker
from uq.assess.statistics.counts import accuracy, counts, effective
from uq.assess.statistics.moments import between_regimes, moments_of
from uq.assess.statistics.quantiles import b_lives, integrated, quantiles, thresholds
from uq.assess.statistics.tolerance import joint, tolerance

STATISTICS: dict[str, Maker] = {
    "moments": moments_of,
    "quantiles": quantiles,
    "b_lives": b_lives,
    "tolerance": tolerance,
    "joint_bounds": joint,
    "thresholds": thresholds,
    "between_regimes": between_regimes,
    "counts": counts,
    "effective": effective,
    "accuracy": accuracy,
    "integrated": integrated,
}
"""Name -> maker, in the order in which they are shown."""

EMPTY: dict[str, Any] = {"tolerance": None, "quantiles": {}, "thresholds": {}, "b_lives": {}}
"""Their JSON where they do not apply to an output; others are then left out."""

JSON_ORDER = ("moments", *EMPTY, "counts")
COLUMN_ORDER = ("moments", "quantiles", "tolerance", "counts", "accuracy")
"""The promised order in JSON and in pandas; all others follow in the order of the table."""
