"""Roots of a function of one variable."""

from collections.abc import Callable
from math import sqrt


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
