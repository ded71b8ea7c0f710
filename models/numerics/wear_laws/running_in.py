"""Running-in: a rate of wear that changes as the rod's scar grows."""

import math

from models.numerics.jit import kernel
from models.numerics.wear_laws.law import Argument, WearLaw


@kernel
def _rate(before, work_rate, t, depth, volume, values):
    return before * (values[0] + (1 - values[0]) * math.exp(-volume / values[1]))


RUNNING_IN = WearLaw(
    "running-in",
    "a rate that tends to a share of the first one as the rod's scar grows",
    (
        Argument("share", "1", "rate in the end over that at first", (1e-4, 1e4)),
        Argument("volume", "m3", "volume of the rod's scar in which the rate changes", (1e-18, 1)),
    ),
    _rate,
)
