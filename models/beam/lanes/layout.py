"""Layout of a state in lanes: y and r of each of m modes, then the variables common to all.

From column 2 m on these are the penetration P in initial gaps, the tip's displacement X1, the
displacement X2 one step before, and the clock. A tangent has no clock.
"""

from typing import Any

from models.numerics.jit import inlined

P, X1, X2 = range(3)
SHARED = 4
CLOCK = -1
UNROLL = 2
"""Modes in the straight-line body of an inner loop."""


@inlined
def modes_of(state):
    """Return m."""
    return (state.shape[1] - SHARED) // 2


def padded(modes: Any) -> Any:
    """Return numbers of modes, rounded up to fill the bodies of an inner loop."""
    return -(-modes // UNROLL) * UNROLL
