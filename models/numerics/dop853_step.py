"""One step of Dormand and Prince's method of order 8(5,3), with its error and its dense output.

Coefficients, error estimate and first step are those of E. Hairer, S. P. Norsett, G. Wanner,
"Solving Ordinary Differential Equations I", Sec. II.4, II.5 and II.10, as in scipy's ``DOP853``.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from models.numerics.fma import fma
from models.numerics.jit import kernel
from models.numerics.tableaux import (
    DENSE_STAGES,
    DENSE_WEIGHTS,
    DORMAND_PRINCE_8,
    ERROR_3,
    ERROR_5,
)

STAGES, ALL_STAGES, POWER = 12, 16, 7
"""Stages of a step, including those of its dense output, and number of coefficients of the
latter."""

_A, _B, _C = DENSE_STAGES.matrix(), np.array(DORMAND_PRINCE_8.b), np.array(DENSE_STAGES.c)
_E3, _E5, _D = np.array(ERROR_3), np.array(ERROR_5), np.array(DENSE_WEIGHTS)


class Step(NamedTuple):
    """Kernels of one system.

    Attributes
    ----------
    guess : kernel
        ``guess(t, end, y, p, relative, absolute, k, trial)`` returns a first step.
    attempt : kernel
        ``attempt(t, h, y, p, relative, absolute, k, new)`` tries a step.
    densify : kernel
        ``densify(t, h, y, p, k, new, dense, trial)`` prepares `interpolate`.
    """

    guess: Callable[..., float]
    attempt: Callable[..., float]
    densify: Callable[..., None]


def stepper(rhs: Callable[..., None]) -> Step:
    """Compile the steps of one system, whose slopes k have shape (`ALL_STAGES`, n).

    Parameters
    ----------
    rhs : kernel
        ``rhs(t, y, p, dy)`` sets dy to the time derivative of y.
    """

    @kernel
    def guess(t, end, y, p, relative, absolute, k, trial):
        """Return a first step (Sec. II.4); k[0] holds the derivative at t."""
        d0 = d1 = d2 = 0.0
        for i in range(len(y)):
            scale = absolute[i] + relative * abs(y[i])
            d0 += (y[i] / scale) ** 2
            d1 += (k[0, i] / scale) ** 2
        d0, d1 = math.sqrt(d0 / len(y)), math.sqrt(d1 / len(y))
        h = 1e-6 if min(d0, d1) < 1e-5 else 0.01 * d0 / d1
        h = min(h, end - t)
        for i in range(len(y)):
            trial[i] = y[i] + h * k[0, i]
        rhs(t + h, trial, p, k[1])
        for i in range(len(y)):
            scale = absolute[i] + relative * abs(y[i])
            d2 += ((k[1, i] - k[0, i]) / scale) ** 2
        d2 = math.sqrt(d2 / len(y)) / h
        steepest = max(d1, d2)
        second = max(1e-6, 1e-3 * h) if steepest <= 1e-15 else (0.01 / steepest) ** 0.125
        return min(100 * h, second)

    @kernel
    def stages(first, last, t, h, y, p, k, trial):
        """Evaluate the stages first <= s < last."""
        for s in range(first, last):
            for i in range(len(y)):
                trial[i] = 0.0
            for j in range(s):
                a = _A[s, j]
                if a != 0.0:
                    for i in range(len(y)):
                        trial[i] = fma(a, k[j, i], trial[i])
            for i in range(len(y)):
                trial[i] = fma(h, trial[i], y[i])
            rhs(t + _C[s] * h, trial, p, k[s])

    @kernel
    def attempt(t, h, y, p, relative, absolute, k, new):
        """Try a step: set `new`, and return its error in units of the one allowed."""
        stages(1, STAGES, t, h, y, p, k, new)
        e3 = e5 = 0.0
        for i in range(len(y)):
            rise = third = fifth = 0.0
            for j in range(STAGES):
                rise = fma(_B[j], k[j, i], rise)
                third = fma(_E3[j], k[j, i], third)
                fifth = fma(_E5[j], k[j, i], fifth)
            new[i] = fma(h, rise, y[i])
            scale = fma(relative, max(abs(y[i]), abs(new[i])), absolute[i])
            e3 += (third / scale) ** 2
            e5 += (fifth / scale) ** 2
        return 0.0 if e5 == 0 else h * e5 / math.sqrt(fma(0.01, e3, e5) * len(y))

    @kernel
    def densify(t, h, y, p, k, new, dense, trial):
        """Set dense (7, n), the coefficients of the dense output over an accepted step."""
        stages(STAGES + 1, ALL_STAGES, t, h, y, p, k, trial)
        for i in range(len(y)):
            rise = new[i] - y[i]
            dense[0, i] = rise
            dense[1, i] = fma(h, k[0, i], -rise)
            dense[2, i] = fma(2.0, rise, -h * (k[STAGES, i] + k[0, i]))
            for q in range(3, POWER):
                total = 0.0
                for j in range(ALL_STAGES):
                    total = fma(_D[q - 3, j], k[j, i], total)
                dense[q, i] = h * total

    return Step(guess, attempt, densify)


@kernel
def interpolate(theta, y, dense, out):
    """Set `out` to the state at the fraction theta of a step."""
    rest = 1 - theta
    for i in range(len(y)):
        value = fma(dense[6, i], theta, dense[5, i])
        value = fma(value, rest, dense[4, i])
        value = fma(value, theta, dense[3, i])
        value = fma(value, rest, dense[2, i])
        value = fma(value, theta, dense[1, i])
        value = fma(value, rest, dense[0, i])
        out[i] = fma(value, theta, y[i])
