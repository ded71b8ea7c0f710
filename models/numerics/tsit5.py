"""Fixed Runge-Kutta steps of sixteen systems at a time: Tsitouras' method of order 5.

Ch. Tsitouras, Comput. Math. Appl. 62 (2011) 770. A block of lanes is one flat array with offsets
known to the compiler: otherwise a sum over seven arrays is not vectorised.
"""

from collections.abc import Callable
from typing import Any

from models.numerics.blocks import LANES, layout
from models.numerics.fma import fma
from models.numerics.jit import kernel
from models.numerics.tableaux import TSITOURAS_5

STAGES = 6

_, (_A21,), (_A31, _A32), (_A41, _A42, _A43), (_A51, _A52, _A53, _A54), _LAST = TSITOURAS_5.a
_A61, _A62, _A63, _A64, _A65 = _LAST
_B1, _B2, _B3, _B4, _B5, _B6 = TSITOURAS_5.b


def combiner(quantities: int) -> Callable[[int, Any], None]:
    """Return the kernel that prepares the next stage.

    Parameters
    ----------
    quantities : int
        In a state.

    Returns
    -------
    kernel
        ``combine(stage, block)``, given the slopes of the first `stage` stages.
    """
    y, out, k_1, _ = layout(quantities, STAGES)
    whole = quantities * LANES
    k_2, k_3, k_4, k_5, k_6 = (k_1 + i * whole for i in range(1, STAGES))

    @kernel
    def combine(stage, w):
        if stage == 1:
            for j in range(whole):
                slope = _A21 * w[k_1 + j]
                w[out + j] = w[y + j] + slope
        elif stage == 2:
            for j in range(whole):
                slope = fma(_A31, w[k_1 + j], _A32 * w[k_2 + j])
                w[out + j] = w[y + j] + slope
        elif stage == 3:
            for j in range(whole):
                slope = fma(_A43, w[k_3 + j], fma(_A41, w[k_1 + j], _A42 * w[k_2 + j]))
                w[out + j] = w[y + j] + slope
        elif stage == 4:
            for j in range(whole):
                slope = fma(_A53, w[k_3 + j], fma(_A51, w[k_1 + j], _A52 * w[k_2 + j]))
                slope = fma(_A54, w[k_4 + j], slope)
                w[out + j] = w[y + j] + slope
        elif stage == 5:
            for j in range(whole):
                slope = fma(_A63, w[k_3 + j], fma(_A61, w[k_1 + j], _A62 * w[k_2 + j]))
                slope += fma(_A64, w[k_4 + j], _A65 * w[k_5 + j])
                w[out + j] = w[y + j] + slope
        else:
            for j in range(whole):
                slope = fma(_B3, w[k_3 + j], fma(_B1, w[k_1 + j], _B2 * w[k_2 + j]))
                slope += fma(_B6, w[k_6 + j], fma(_B4, w[k_4 + j], _B5 * w[k_5 + j]))
                w[out + j] = w[y + j] + slope

    return combine
