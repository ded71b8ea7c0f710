"""Runge-Kutta steps of fixed length of sixteen rigid machines at a time.

Loops over lanes are straight-line code, so lanes never diverge and a row's bits do not depend on
its neighbours. See `models.numerics.nystrom`.
"""

from models.numerics.blocks import LANES
from models.numerics.jit import kernel
from models.numerics.nystrom import STAGES, combiner, layout, stepper
from models.numerics.tableaux import DORMAND_PRINCE_8, TSITOURAS_5
from models.vibrator.lanes import dynamics
from models.vibrator.lanes.packed import machine

AT = layout(dynamics.DEGREES)
SIZE = dynamics.END + STAGES * dynamics.DEGREES * LANES
"""Of a block of lanes."""

STABLE = 0.8
"""Step times the fastest rate of a machine; the methods are stable with a margin."""

combine_5 = combiner(dynamics.DEGREES, dynamics.END, TSITOURAS_5)
step_5 = stepper(dynamics.DEGREES, dynamics.END, TSITOURAS_5, dynamics.accelerate)
step_8 = stepper(dynamics.DEGREES, dynamics.END, DORMAND_PRINCE_8, dynamics.accelerate)


@kernel
def prepare(c, h, w):
    """Set the constants of all lanes for steps of these lengths.

    Parameters
    ----------
    c : ndarray
        Constants of the machines, in lanes.
    h : ndarray, shape (LANES,)
        [s]
    w : ndarray
        Block of lanes.
    """
    for lane in range(LANES):
        dynamics.prepare(machine(c, lane), h[lane], w, lane)
        for i in range(dynamics.DEGREES):
            w[AT.step + i * LANES + lane] = h[lane]
