"""What the rows of paths show: parts of the variance, and inputs that change the output."""

import numpy as np

from uq.contract import Floats, Mask
from uq.intervals import ROUNDING
from uq.methods.sample import Sample

MIN_SEEN = 10
"""With fewer paths it is not known whether an input has an effect of its own."""


def parts_of(sample: Sample, y: Floats) -> Floats:
    """Return what the steps of each input add to half the square of the change along each path.

    Parameters
    ----------
    sample : Sample
    y : ndarray, shape (n, k) or (n, k, e)
        Any function of the rows of whole paths; its elements add up.

    Returns
    -------
    ndarray, shape (n, d)
        Unbiased for the Shapley values of its variance.
    """
    before, after = y[:, :-1], y[:, 1:]
    steps = (y[:, :1] - (before + after) / 2) * (before - after)
    steps = steps.reshape(*steps.shape[:2], -1).sum(axis=2)
    return np.asarray(np.einsum("ns,nsp->np", steps, sample.direction[sample.whole] != 0))


def changes_alone(sample: Sample) -> Mask:
    """Return along which whole path each input changes the output by itself, shape (n, d).

    It can do so where it is the first to change: all others then keep their values.
    """
    y = sample.grouped[sample.whole]
    moved = np.abs(y[:, 1] - y[:, 0]) > ROUNDING * np.abs(y).max()
    moved = moved.reshape(len(y), -1).any(axis=1)  # some element of a whole output
    return np.asarray((sample.direction[sample.whole][:, 0] != 0) & moved[:, None])


def paths_without_effect(sample: Sample, name: str) -> int:
    """Return how many paths show that a correlated input has no effect of its own; else 0.

    Only paths along which the output changes say something.
    """
    if not sample.correlated.get(name):
        return 0
    whole, place = sample.whole, list(sample.inputs).index(name)
    if changes_alone(sample)[:, place].any():
        return 0
    y, x = sample.grouped[whole], sample.inputs[name][sample.groups[whole]]
    first = sample.direction[whole][:, 0, place] != 0
    moves = (y[:, -1] != y[:, 0]).reshape(len(y), -1).any(axis=1)
    seen = int((first & (x[:, 1] != x[:, 0]) & moves).sum())
    return seen if seen >= MIN_SEEN else 0
