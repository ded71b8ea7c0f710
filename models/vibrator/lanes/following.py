"""The motion of n rigid machines at equal steps."""

import numpy as np

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel
from models.vibrator.lanes.packed import CONSTANTS, STATE, Array, load, store
from models.vibrator.lanes.steps import AT, SIZE, prepare, step_5


@kernel
def _follow(constants, start, h, every, trace, work):
    """Set `trace`, shape (n, samples, 10), to the states after so many steps each."""
    c, w, step_size = work
    y = w[AT.position : AT.position + STATE * LANES]
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        load(start, first, y)
        prepare(c, step_size, w)
        for sample in range(trace.shape[1]):
            for _ in range(every):
                step_5(w)
            store(y, first, trace[:, sample])


def follow(constants: Array, state: Array, time: Array, steps: int, every: int = 1) -> Array:
    """Return the states of n machines after every so many of some equal steps.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    state : ndarray, shape (n, 10)
    time : ndarray, shape (n,)
        Of all steps [s].
    steps, every : int

    Returns
    -------
    ndarray, shape (n, steps // every, 10)
    """
    trace = np.empty((len(state), steps // every, STATE))
    work = aligned(CONSTANTS * LANES), aligned(SIZE), aligned(LANES)
    _follow(constants, state, (time / steps)[:, None], every, trace, work)
    return trace
