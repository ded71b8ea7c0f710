"""EDF's law of the wear of tubes: S_inf + (A U^b - S_inf) exp(-n t), U in watts.

A is the wear coefficient. Published values for steam-generator tubes: A = 1e-13, b = 1.2,
S_inf = 1.14e-16 m3/s, n = 2.44e-8 1/s (Code_Aster, documentation of POST_USURE).
"""

import math

from models.numerics.jit import kernel
from models.numerics.wear_laws.law import Argument, WearLaw


@kernel
def _rate(before, work_rate, t, depth, volume, values):
    first = before / work_rate * math.pow(work_rate, values[0])
    return values[1] + (first - values[1]) * math.exp(-values[2] * t)


@kernel
def _clock(values):
    return 1 / values[2]


EDF = WearLaw(
    "edf",
    "a power of the work-rate that tends to a given rate in time",
    (
        Argument("exponent", "1", "exponent b", (0.1, 10.0), 1.2),
        Argument("steady_rate", "m3 s-1", "volume per time in the end", (0.0, 1e-6), 1.14e-16),
        Argument("decay", "s-1", "rate at which the first one is forgotten", (1e-12, 1e3), 2.44e-8),
    ),
    _rate,
    clock=_clock,
)
