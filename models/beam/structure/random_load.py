"""The random load of n beams: white noise through a band-pass filter, and the filter's length.

The force at the tip is stationary and Gaussian, of one-sided level S_F between two frequencies. Its
level falls at each end of the band as a logistic function of width e; its variance is S_F times the
bandwidth.

The noise has `rate` samples per forcing period. It is filtered in stretches by fast convolution
(overlap-save), which is exact up to the response to noise more than 10 decay times old: each
stretch takes account of the noise for some periods before it (`lead`) and after it (`lag`). So the
process has no beginnings and no joints, and any part of it can be computed by itself.
"""

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Rows
from models.beam.structure.interpolation import BEFORE, HIGHEST

Array = NDArray[np.float64]
LOAD = np.dtype(
    [
        ("power", "f8"),
        ("low", "f8"),
        ("high", "f8"),
        ("edge", "f8"),
        ("rate", "i8"),
        ("size", "i8"),
        ("lead", "i8"),
        ("stretch", "i8"),
        ("seed", "u8"),
    ],
    align=True,
)
"""A beam's random load.

power
    Variance of the force, over X0, per unit of the noise's bandwidth [N2 m-2]; 0 for no random
    load.
low, high, edge
    Ends of the band and width of its edges, in turns per forcing period.
rate
    Samples of the noise per forcing period; the response has twice as many.
size
    Samples of the noise of which a stretch takes account.
lead, stretch
    Forcing periods before a stretch of which it takes account, and of the stretch itself.
seed
    Of the realisation.
"""
FINER = 2  # samples of the response per sample of the noise
_RATES = np.array([base << k for k in range(15) for base in (2, 3)]) // 2
_BAND_PASS = 16.0  # half-length of the band-pass, in decay times of the slowest mode
_PER_BAND = 20.0  # and at least this over the bandwidth
_EDGE = 0.5  # edge times half-length: the band-pass has then decayed to 1e-4
_TAIL = 10.0  # decay times after which the beam has forgotten the force
_MARGIN = 2 + BEFORE  # periods, for the interpolation
_SPARE = 1.5  # least size over that of which a stretch only takes account
_SHORTEST, _LONGEST = 2**10, 2**19  # sizes


def random_load(p: Rows, slowest: Array, seed: NDArray[np.uint64]) -> NDArray[np.void]:
    """Return the random load of n beams.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    slowest : ndarray, shape (n,)
        Rate of the slowest decay of free motion [s-1].
    seed : ndarray of uint64, shape (n,)

    Returns
    -------
    ndarray of LOAD, shape (n,)
    """
    load = np.zeros(len(seed), LOAD)
    load["stretch"] = load["rate"] = 1
    rows = np.flatnonzero((p.random_force_level > 0) & (p.random_force_high > p.random_force_low))
    if not len(rows):
        return load
    forcing, low, high = (
        a[rows] for a in (p.forcing_frequency, p.random_force_low, p.random_force_high)
    )
    rate = _RATES[np.searchsorted(FINER * HIGHEST * _RATES, high / forcing)]
    half = np.maximum(_BAND_PASS / slowest[rows], _PER_BAND / (high - low))
    tail = _TAIL / slowest[rows]
    samples = _SPARE * forcing * rate * (2 * half + tail)
    # Beams of longer memory are beyond any budget; here their force is still defined.
    shorter = np.minimum(1.0, _LONGEST / samples)
    half, tail = half * shorter, tail * shorter
    needed = np.maximum(_SPARE * rate * (forcing * (2 * half + tail) + 2 * _MARGIN), _SHORTEST)
    size = 2 ** np.ceil(np.log2(needed)).astype(np.int64)
    lead = np.ceil(forcing * (half + tail)).astype(np.int64) + _MARGIN
    lag = np.ceil(forcing * half).astype(np.int64) + _MARGIN
    drawn = np.zeros(len(rows), LOAD)
    drawn["power"] = 0.5 * p.random_force_level[rows] * forcing * rate / p.initial_gap[rows] ** 2
    drawn["low"], drawn["high"], drawn["edge"] = (
        low / forcing,
        high / forcing,
        _EDGE / half / forcing,
    )
    drawn["rate"], drawn["size"], drawn["lead"] = rate, size, lead
    drawn["stretch"] = size // rate - lead - lag
    drawn["seed"] = seed[rows]
    load[rows] = drawn
    return load
