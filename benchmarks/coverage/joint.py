"""Tolerance bounds that hold for several outputs at once."""

import numpy as np

from benchmarks.coverage.tally import Tally
from uq.stats.order_statistics import joint_bounds

ROWS = (93, 124, 500, 2000)
OUTPUTS = 2
DEPENDENCE = {
    "independent": (lambda u: (u[0], u[1]), lambda a, b: a * b),
    "equal": (lambda u: (u[0], u[0]), min),
    "opposite": (lambda u: (u[0], 1 - u[0]), lambda a, b: max(a + b - 1, 0.0)),
}
"""How two uniform outputs depend -> their values, and P(both lie below a and b)."""


def bounds(repetitions):
    """Count how often 95 % of all rows lie within both bounds at once."""
    tally = Tally("joint 95/95 bounds of two outputs")
    for how, (values, within) in DEPENDENCE.items():
        for rows in ROWS:
            rng = np.random.default_rng(rows)
            for _ in range(repetitions):
                limits = joint_bounds(values(rng.random((OUTPUTS, rows))), 0, 0.95, 0.95)
                tally.add(f"{how} outputs, {rows} rows", 0.95, -np.inf, within(*limits))
    return tally.lines()
