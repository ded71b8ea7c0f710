"""Quantile functions of the laws behind intervals.

They have the bits of those of `scipy.stats`, whose import takes longer than most summaries:
`scipy.special` holds the functions below them.
"""

from collections.abc import Callable
from math import ceil, nan
from typing import Any

import numpy as np
from scipy import special

from uq.contract import Floats

_LARGEST_INT = 2**31 - 1  # that `scipy.special` counts to
_TIE = 64 * np.finfo(float).eps  # probabilities this close, relatively, are equal but for rounding


def normal(probability: Floats | float) -> Any:
    """Return the quantile of the standard normal law."""
    return special.ndtri(probability)


def student(probability: float, freedom: float) -> float:
    """Return the quantile of Student's t; NaN without a degree of freedom."""
    return float(special.stdtrit(freedom, probability)) if freedom > 0 else nan


def binomial(probability: float, trials: int, share: float) -> int:
    """Return the least number of hits that at least this share of samples do not exceed."""
    return _least(
        special.bdtrik(probability, trials, share),
        lambda hits: special.bdtr(hits, trials, share) >= probability * (1 - _TIE),
    )


def binomial_exceeded(probability: float, trials: int, share: float) -> int:
    """Return the least number of hits that at most this share of samples exceed."""
    return _least(
        special.bdtrik(1 - probability, trials, share),
        lambda hits: special.bdtrc(hits, trials, share) <= probability * (1 + _TIE),
    )


def negative_binomial(probability: float, hits: int, share: float) -> int:
    """Return the least number of misses before so many hits, as `binomial` does."""
    return _least(
        special.nbdtrik(probability, hits, share),
        lambda misses: _at_most(misses, hits, share) >= probability * (1 - _TIE),
    )


def _at_most(misses: int, hits: int, share: float) -> Any:
    """Return the probability of at most so many misses before so many hits."""
    if misses < _LARGEST_INT:
        return special.nbdtr(misses, hits, share)
    return special.betainc(hits, misses + 1.0, share)


def _least(guess: Any, is_enough: Callable[[int], Any]) -> int:
    """Return the least integer that is enough, near where the inverse function puts it.

    It is enclosed in steps that double, then bisected: the inverse may be far off.
    """
    most = max(ceil(guess), 0)  # enough, in the end
    step = 1
    while not is_enough(most):
        most += step
        step *= 2
    least, step = most - 1, 1  # not enough, in the end
    while least >= 0 and is_enough(least):
        most, least = least, least - step
        step *= 2
    least = max(least, -1)
    while most - least > 1:
        middle = (least + most) // 2
        least, most = (least, middle) if is_enough(middle) else (middle, most)
    return most
