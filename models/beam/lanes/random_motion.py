"""The random load of the fast propagator: the tip's response without contact, at each step.

The modes carry the effect of contact alone, so the response is all that is needed of the load. It
is computed in stretches of many periods, and interpolated within each of them, in all lanes alike.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.lanes.layout import CLOCK
from models.beam.structure.interpolation import REACH, weights
from models.beam.structure.modal import Array, Beams
from models.beam.structure.random_load import FINER
from models.beam.structure.random_response import (
    Workspace,
    samples_per_stretch,
    set_gain,
    set_stretches,
)
from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel


class RandomMotion(NamedTuple):
    """The random load of n beams, and room for the motion of a block of lanes.

    Attributes
    ----------
    load, forcing, oscillators
        As in `models.beam.structure.random_response.opening`.
    taps : ndarray, shape (steps, REACH)
        Weights of the samples at each step of a period.
    gain : ndarray, shape (LANES, 2, samples of the gain)
        Of each lane's filter.
    samples : ndarray, shape (LANES, 2, samples of a stretch)
        A pair of stretches of each lane.
    pair : ndarray of int, shape (LANES,)
        Its number, -1 for none.
    window : ndarray, shape (samples around a period * LANES,)
        Of all lanes.
    work : Workspace
    """

    load: NDArray[np.void]
    forcing: Array
    oscillators: Array
    taps: Array
    gain: Array
    samples: Array
    pair: NDArray[np.int64]
    window: Array
    work: Workspace


def random_motion(beams: Beams, taps: Array) -> RandomMotion:
    """Return the random load of n beams, which share its rate, and room for it."""
    load = beams.load
    rate, half = int(load["rate"].max()), int(load["size"].max()) // 2
    return RandomMotion(
        load,
        beams.forcing,
        beams.oscillators,
        taps,
        np.empty((LANES, 2, half)),
        np.empty((LANES, 2, int(samples_per_stretch(load).max()))),
        np.empty(LANES, np.int64),
        aligned((FINER * rate + REACH - 1) * LANES),
        Workspace.of(load),
    )


def taps_of(rate: int, steps: int) -> Array:
    """Return the weights of the samples at each step of a period, shape (steps, REACH)."""
    per_period = FINER * rate
    step = np.arange(1, steps + 1)
    interval = np.minimum(step * per_period // steps, per_period - 1)
    return weights(step * per_period / steps - interval)


@kernel
def begin_motion(motion, state, first):
    """Prepare the lanes of up to LANES rows from `first` on; return whether any has a load.

    Spare lanes repeat the last row.
    """
    last = state.shape[0] - 1
    is_random = False
    motion.window[:] = 0.0
    for lane in range(LANES):
        n = min(first + lane, last)
        motion.pair[lane] = -1
        if motion.load[n]["power"] > 0:
            is_random = True
            set_gain(motion.load[n], motion.forcing[n], motion.oscillators[n], motion.gain[lane])
    return is_random


@kernel
def _look_up(motion, state, first, period):
    """Set the window to the samples around a period of the call."""
    last = state.shape[0] - 1
    for lane in range(LANES):
        n = min(first + lane, last)
        load = motion.load[n]
        if load["power"] == 0 or first + lane > last:
            continue
        stretch, since = divmod(int(state[n, CLOCK]) + period, load["stretch"])
        if stretch // 2 != motion.pair[lane]:
            motion.pair[lane] = stretch // 2
            set_stretches(load, motion.gain[lane], stretch // 2, motion.work, motion.samples[lane])
        per_period = FINER * load["rate"]
        samples = motion.samples[lane, stretch % 2]
        for i in range(per_period + REACH - 1):
            motion.window[i * LANES + lane] = samples[since * per_period + i]


@inlined
def _weighted(taps, s, m, window, k, total):
    """Add half of the weighted samples around a step, from sample m on, to a number."""
    total = fma(taps[s, m], window[k + m * LANES], total)
    total = fma(taps[s, m + 1], window[k + (m + 1) * LANES], total)
    total = fma(taps[s, m + 2], window[k + (m + 2) * LANES], total)
    total = fma(taps[s, m + 3], window[k + (m + 3) * LANES], total)
    total = fma(taps[s, m + 4], window[k + (m + 4) * LANES], total)
    total = fma(taps[s, m + 5], window[k + (m + 5) * LANES], total)
    return fma(taps[s, m + 6], window[k + (m + 6) * LANES], total)


@kernel
def add_motion(motion, state, first, period, drive):
    """Add the response to the tip's motion without contact, at each step of a period."""
    _look_up(motion, state, first, period)
    taps, window = motion.taps, motion.window
    steps = taps.shape[0]
    per_period = window.size // LANES - REACH + 1
    for s in range(steps):
        begin = min((s + 1) * per_period // steps, per_period - 1) * LANES
        for lane in range(LANES):
            k = begin + lane
            total = _weighted(taps, s, 0, window, k, drive[s * LANES + lane])
            total += _weighted(taps, s, REACH // 2, window, k, 0.0)
            drive[s * LANES + lane] = total
