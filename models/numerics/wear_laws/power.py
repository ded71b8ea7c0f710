"""Wear as a power of the work-rate above a threshold: k U_ref (U/U_ref - x_th)^b, U_ref = 1 W."""

import math

from models.numerics.jit import kernel
from models.numerics.wear_laws.law import Argument, WearLaw


@kernel
def _rate(before, work_rate, t, depth, volume, values):
    above = work_rate - values[1]
    if above <= 0:
        return 0.0
    return before / work_rate * math.pow(above, values[0])


@kernel
def _threshold(values):
    return values[1]


POWER = WearLaw(
    "power",
    "a power of the work-rate above a threshold",
    (
        Argument("exponent", "1", "exponent b", (0.1, 10.0), 1.0),
        Argument("threshold", "W", "work-rate without wear", (0.0, 1e3), 0.0),
    ),
    _rate,
    _threshold,
)
