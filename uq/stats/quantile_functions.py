"""Quantile functions of the normal, Student, binomial and negative binomial laws; roots.

Their results equal those of `scipy.stats` to the bit. They call `scipy.special` directly, since
importing `scipy.stats` takes longer than most summaries.
"""

from collections.abc import Callable
from math import ceil, nan, sqrt
from typing import Any

import numpy as np
from scipy import special

from uq.contract import Floats

_LARGEST_INT = 2**31 - 1  # upper limit of integers in `scipy.special`
_TIE = 64 * np.finfo(float).eps  # probabilities this close, relatively, are equal but for rounding


def normal(probability: Floats | float) -> Any:
    """Return the quantile of the standard normal law."""
    return special.ndtri(probability)


def student(probability: float, freedom: float) -> float:
    """Return the quantile of Student's t law; NaN for zero degrees of freedom."""
    return float(special.stdtrit(freedom, probability)) if freedom > 0 else nan


def binomial(probability: float, trials: int, share: float) -> int:
    """Return the binomial quantile: the least k with P(hits <= k) >= probability."""
    return _least(
        special.bdtrik(probability, trials, share),
        lambda hits: special.bdtr(hits, trials, share) >= probability * (1 - _TIE),
    )


def binomial_exceeded(probability: float, trials: int, share: float) -> int:
    """Return the upper binomial quantile: the least k with P(hits > k) <= probability."""
    return _least(
        special.bdtrik(1 - probability, trials, share),
        lambda hits: special.bdtrc(hits, trials, share) <= probability * (1 + _TIE),
    )


def negative_binomial(probability: float, hits: int, share: float) -> int:
    """Return the quantile of the number of misses before this number of hits."""
    return _least(
        special.nbdtrik(probability, hits, share),
        lambda misses: _at_most(misses, hits, share) >= probability * (1 - _TIE),
    )


def _at_most(misses: int, hits: int, share: float) -> Any:
    """Return P(misses before this number of hits <= misses)."""
    if misses < _LARGEST_INT:
        return special.nbdtr(misses, hits, share)
    return special.betainc(hits, misses + 1.0, share)


def _least(guess: Any, is_enough: Callable[[int], Any]) -> int:
    """Return the least integer that satisfies a condition, searched from a guess.

    The integer is bracketed by doubling steps, then found by bisection, since the guess may be
    inaccurate.
    """
    most = max(ceil(guess), 0)  # satisfies the condition after bracketing
    step = 1
    while not is_enough(most):
        most += step
        step *= 2
    least, step = most - 1, 1  # does not satisfy it after bracketing
    while least >= 0 and is_enough(least):
        most, least = least, least - step
        step *= 2
    least = max(least, -1)
    while most - least > 1:
        middle = (least + most) // 2
        least, most = (least, middle) if is_enough(middle) else (middle, most)
    return most


def root(function: Callable[[float], float], ends: tuple[float, float], tolerance: float) -> float:
    """Return the root of a function within a bracket, by Chandrupatla's method.

    `scipy.optimize.elementwise.find_root` uses the same method, but its import takes longer than
    most summaries.

    Parameters
    ----------
    function : callable
    ends : tuple of float
        The bracket: the function has different signs at its ends, or is zero at one of them.
    tolerance : float
        Largest absolute error of the root.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        The function has the same sign at both ends, or is NaN there.

    References
    ----------
    Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear
    function without using derivatives", Advances in Engineering Software 28 (1997) 145-149.
    """
    a, b = ends
    at_a, at_b = function(a), function(b)
    if at_a == 0 or at_b == 0:
        return a if at_a == 0 else b
    if not at_a * at_b < 0:
        raise ValueError(f"no change of sign: {at_a!r} at {a!r}, {at_b!r} at {b!r}")
    share = 0.5
    while True:
        x = a + share * (b - a)
        at_x = function(x)
        # The root lies between a, the newest point, and b; c is the previous point.
        if (at_x > 0) == (at_a > 0):
            c, at_c = a, at_a
        else:
            c, at_c, b, at_b = b, at_b, a, at_a
        a, at_a = x, at_x
        best, value = (a, at_a) if abs(at_a) < abs(at_b) else (b, at_b)
        least = tolerance / abs(b - a) if a != b else 1.0
        if value == 0 or least > 0.5:
            return best
        xi, phi = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
        if 1 - sqrt(1 - xi) < phi < sqrt(xi):  # inverse quadratic interpolation is safe
            share = at_a / (at_b - at_a) * at_c / (at_b - at_c)
            share += (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
        else:
            share = 0.5
        share = min(1 - least, max(least, share))
