"""RBD-FAST: first-order indices from the spectrum of the rows sorted by an input."""

import numpy as np
from scipy.fft import rfft

from uq.methods.sample import Floats

_HARMONICS = 10


def rbd_fast(x: Floats, y: Floats) -> Floats:
    """Return the share of the first harmonics in the power of y along each input, unbiased."""
    from SALib.analyze.rbd_fast import permute_outputs, unskew_S1

    spectra = (rfft(permute_outputs(column, y)) for column in x.T)
    first = [np.sum(np.abs(one[1 : _HARMONICS + 1]) ** 2) for one in spectra]
    share = np.array(first) * 2 / (len(y) ** 2 * y.var())
    return unskew_S1(share, _HARMONICS, len(y))
