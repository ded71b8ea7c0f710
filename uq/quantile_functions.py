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
        lambda misses: special.nbdtr(misses, hits, share) >= probability * (1 - _TIE),
    )


def _least(guess: Any, is_enough: Callable[[int], Any]) -> int:
    """Return the least integer that is enough, next to where the inverse function puts it."""
    count = max(ceil(guess), 0)
    while not is_enough(count):
        count += 1
    while count > 0 and is_enough(count - 1):
        count -= 1
    return count
