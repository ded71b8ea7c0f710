"""The statistics of an output. To add one, write its maker and list it here."""

from uq.assess.statistic import Maker
from uq.assess.statistics.causes import causes
from uq.assess.statistics.counts import accuracy, counts, effective, ended_at_once
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
    "ended_at_once": ended_at_once,
    "causes": causes,
    "between_regimes": between_regimes,
    "counts": counts,
    "effective": effective,
    "accuracy": accuracy,
    "integrated": integrated,
}
"""Name -> maker, in the order in which a terminal and a report show them."""
