"""Runge-Kutta steps of many systems at a time: Dormand and Prince's method of order 8.

Like `models.numerics.tsit5`, with an error estimate for each lane, after E. Hairer, S. P. Norsett,
G. Wanner, "Solving Ordinary Differential Equations I", Sec. II.5 and II.10.
"""

import math
from collections.abc import Callable
from typing import Any

from models.numerics.blocks import LANES, layout
from models.numerics.fma import fma
from models.numerics.jit import lean
from models.numerics.tableaux import DORMAND_PRINCE_8, ERROR_3, ERROR_5

STAGES = 12


def _at(values, *places):
    """Return the coefficients at these places; all others are zero."""
    return tuple(values[i] for i in places)


_A = DORMAND_PRINCE_8.a
_LATE = (0, 5, 6, 7, 8, 9, 10, 11)
(_A2,) = _at(_A[1], 0)
_A3_1, _A3_2 = _at(_A[2], 0, 1)
_A4_1, _A4_3 = _at(_A[3], 0, 2)
_A5_1, _A5_3, _A5_4 = _at(_A[4], 0, 2, 3)
_A6_1, _A6_4, _A6_5 = _at(_A[5], 0, 3, 4)
_A7_1, _A7_4, _A7_5, _A7_6 = _at(_A[6], 0, 3, 4, 5)
_A8_1, _A8_4, _A8_5, _A8_6, _A8_7 = _at(_A[7], 0, 3, 4, 5, 6)
_A9_1, _A9_4, _A9_5, _A9_6, _A9_7, _A9_8 = _at(_A[8], 0, 3, 4, 5, 6, 7)
_A10_1, _A10_4, _A10_5, _A10_6, _A10_7, _A10_8, _A10_9 = _at(_A[9], 0, 3, 4, 5, 6, 7, 8)
_A11_1, _A11_4, _A11_5, _A11_6 = _at(_A[10], 0, 3, 4, 5)
_A11_7, _A11_8, _A11_9, _A11_10 = _at(_A[10], 6, 7, 8, 9)
_A12_1, _A12_4, _A12_5, _A12_6 = _at(_A[11], 0, 3, 4, 5)
_A12_7, _A12_8, _A12_9, _A12_10, _A12_11 = _at(_A[11], 6, 7, 8, 9, 10)
_B1, _B6, _B7, _B8, _B9, _B10, _B11, _B12 = _at(DORMAND_PRINCE_8.b, *_LATE)
_T1, _T6, _T7, _T8, _T9, _T10, _T11, _T12 = _at(ERROR_3, *_LATE)
_F1, _F6, _F7, _F8, _F9, _F10, _F11, _F12 = _at(ERROR_5, *_LATE)

WEIGHTS = DORMAND_PRINCE_8.b
"""Of the stages in the new state."""


def combiner(quantities: int) -> Callable[[int, Any], None]:
    """Return the kernel that prepares the next stage; see `models.numerics.tsit5.combiner`."""
    y, out, k, _ = layout(quantities, STAGES)
    n = quantities * LANES
    k1, k2, k3, k4, k5, k6, k7, k8, k9, k10, k11, k12 = (k + i * n for i in range(STAGES))

    @lean
    def combine(stage, w):
        if stage == 1:
            for j in range(n):
                w[out + j] = fma(_A2, w[k1 + j], w[y + j])
        elif stage == 2:
            for j in range(n):
                w[out + j] = w[y + j] + fma(_A3_1, w[k1 + j], _A3_2 * w[k2 + j])
        elif stage == 3:
            for j in range(n):
                w[out + j] = w[y + j] + fma(_A4_1, w[k1 + j], _A4_3 * w[k3 + j])
        elif stage == 4:
            for j in range(n):
                rise = fma(_A5_4, w[k4 + j], fma(_A5_1, w[k1 + j], _A5_3 * w[k3 + j]))
                w[out + j] = w[y + j] + rise
        elif stage == 5:
            for j in range(n):
                rise = fma(_A6_5, w[k5 + j], fma(_A6_1, w[k1 + j], _A6_4 * w[k4 + j]))
                w[out + j] = w[y + j] + rise
        elif stage == 6:
            for j in range(n):
                rise = fma(_A7_5, w[k5 + j], fma(_A7_1, w[k1 + j], _A7_4 * w[k4 + j]))
                rise = fma(_A7_6, w[k6 + j], rise)
                w[out + j] = w[y + j] + rise
        elif stage == 7:
            for j in range(n):
                rise = fma(_A8_5, w[k5 + j], fma(_A8_1, w[k1 + j], _A8_4 * w[k4 + j]))
                rise += fma(_A8_6, w[k6 + j], _A8_7 * w[k7 + j])
                w[out + j] = w[y + j] + rise
        elif stage == 8:
            for j in range(n):
                rise = fma(_A9_5, w[k5 + j], fma(_A9_1, w[k1 + j], _A9_4 * w[k4 + j]))
                rise += fma(_A9_8, w[k8 + j], fma(_A9_6, w[k6 + j], _A9_7 * w[k7 + j]))
                w[out + j] = w[y + j] + rise
        elif stage == 9:
            for j in range(n):
                rise = fma(_A10_5, w[k5 + j], fma(_A10_1, w[k1 + j], _A10_4 * w[k4 + j]))
                rise += fma(_A10_8, w[k8 + j], fma(_A10_6, w[k6 + j], _A10_7 * w[k7 + j]))
                rise = fma(_A10_9, w[k9 + j], rise)
                w[out + j] = w[y + j] + rise
        elif stage == 10:
            for j in range(n):
                rise = fma(_A11_5, w[k5 + j], fma(_A11_1, w[k1 + j], _A11_4 * w[k4 + j]))
                rise += fma(_A11_8, w[k8 + j], fma(_A11_6, w[k6 + j], _A11_7 * w[k7 + j]))
                rise += fma(_A11_9, w[k9 + j], _A11_10 * w[k10 + j])
                w[out + j] = w[y + j] + rise
        elif stage == 11:
            for j in range(n):
                rise = fma(_A12_5, w[k5 + j], fma(_A12_1, w[k1 + j], _A12_4 * w[k4 + j]))
                rise += fma(_A12_8, w[k8 + j], fma(_A12_6, w[k6 + j], _A12_7 * w[k7 + j]))
                rise += fma(_A12_11, w[k11 + j], fma(_A12_9, w[k9 + j], _A12_10 * w[k10 + j]))
                w[out + j] = w[y + j] + rise
        else:
            for j in range(n):
                rise = fma(_B7, w[k7 + j], fma(_B1, w[k1 + j], _B6 * w[k6 + j]))
                rise += fma(_B10, w[k10 + j], fma(_B8, w[k8 + j], _B9 * w[k9 + j]))
                rise += fma(_B11, w[k11 + j], _B12 * w[k12 + j])
                w[out + j] = w[y + j] + rise

    return combine


def estimator(quantities: int, measured: int) -> Callable[[Any, Any, Any], None]:
    """Return the kernel that estimates the error of a step.

    Parameters
    ----------
    quantities : int
        In a state.
    measured : int
        Number of leading quantities whose errors count.

    Returns
    -------
    kernel
        ``estimate(block, share, error)`` sets error[lane] to the root mean square of the errors of
        the measured quantities, each times its entry of share; error has room for (1 + 2 measured)
        LANES numbers.
    """
    _, _, k, _ = layout(quantities, STAGES)
    n = quantities * LANES
    k1 = k
    k6, k7, k8, k9, k10, k11, k12 = (k + i * n for i in range(5, STAGES))

    watched = measured * LANES
    third, fifth = LANES, LANES + watched

    @lean
    def estimate(w, share, error):
        for j in range(watched):
            e = fma(_T8, w[k8 + j], fma(_T7, w[k7 + j], fma(_T1, w[k1 + j], _T6 * w[k6 + j])))
            late = fma(_T9, w[k9 + j], _T10 * w[k10 + j])
            e += fma(_T12, w[k12 + j], fma(_T11, w[k11 + j], late))
            error[third + j] = e * share[j]
        for j in range(watched):
            e = fma(_F8, w[k8 + j], fma(_F7, w[k7 + j], fma(_F1, w[k1 + j], _F6 * w[k6 + j])))
            late = fma(_F9, w[k9 + j], _F10 * w[k10 + j])
            e += fma(_F12, w[k12 + j], fma(_F11, w[k11 + j], late))
            error[fifth + j] = e * share[j]
        for lane in range(LANES):
            total_3 = total_5 = 0.0
            for q in range(measured):
                e = error[third + q * LANES + lane]
                total_3 = fma(e, e, total_3)
                e = error[fifth + q * LANES + lane]
                total_5 = fma(e, e, total_5)
            both = fma(0.01, total_3, total_5) * measured
            error[lane] = total_5 / math.sqrt(both + 1e-300)

    return estimate
