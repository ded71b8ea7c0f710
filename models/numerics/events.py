"""Event location: where a guard falls through zero in a step, from values and slopes at both ends.

The root of the Hermite cubic is only a first guess: a propagator cuts its step there and evaluates
the guard exactly. Lengths are in units of the step.
"""

import math

from models.numerics.jit import lean

_ITERATIONS = 40
_CLOSE = 1e-9


@lean
def crossing(g_0, d_0, g_1, d_1):
    """Return where in (0, 1) the cubic falls through zero, for g_0 > 0 > g_1.

    Parameters
    ----------
    g_0, g_1 : float
        Values at the ends.
    d_0, d_1 : float
        Slopes there.
    """
    low, high = 0.0, 1.0
    at = g_0 / (g_0 - g_1)
    for _ in range(_ITERATIONS):
        rest = 1 - at
        value = rest * rest * ((1 + 2 * at) * g_0 + at * d_0)
        value += at * at * ((1 + 2 * rest) * g_1 - rest * d_1)
        slope = 6 * at * rest * (g_1 - g_0) + rest * (1 - 3 * at) * d_0
        slope += at * (3 * at - 2) * d_1
        if value > 0:
            low = at
        else:
            high = at
        new = at - value / slope if slope < 0 else 0.5 * (low + high)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - at) < _CLOSE:
            break
        at = new
    return at


@lean
def dip(g_0, d_0, g_1, d_1):
    """Return where in [0, 1] the cubic is lowest, and its value there, for d_0 < 0 < d_1.

    Parameters
    ----------
    g_0, g_1 : float
        Values at the ends.
    d_0, d_1 : float
        Slopes there.
    """
    # The slope is d_0 + 2 b at + 3 a at^2.
    b = 3 * (g_1 - g_0) - 2 * d_0 - d_1
    a = d_0 + d_1 - 2 * (g_1 - g_0)
    root = math.sqrt(max(b * b - 3 * a * d_0, 0.0))
    at = -d_0 / (b + root) if b > 0 else (root - b) / (3 * a)
    at = min(max(at, 0.0), 1.0)
    return at, g_0 + at * (d_0 + at * (b + at * a))
