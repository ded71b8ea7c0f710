"""The memory layout of sixteen moles."""

from typing import Any, NamedTuple

import numpy as np

from models.numerics import dop8
from models.numerics.blocks import LANES, aligned, layout

# Quantities of a lane, followed by its tangents, which have the first five each.
U, V, X, CURRENT, P, ADDED, SINE, COSINE = range(8)
PLAIN = 8
MEASURED = 5

# Rows of a block's memory, beginning with the constants of a lane in its present mode.
(
    STEP,
    A,
    B,
    D,
    E,
    STIFFNESS,
    FORCE,
    DAMPING,
    SLOPE,
    COIL,
    RESISTANCE,
    ELASTANCE,
    DRIVE,
    SPEED,
    CONTACT,
    GAP,
) = range(16)

# Integrals over a trial step, and their sums so far: of the velocity, the powers of impacts and
# supply, and the contact force.
PROGRESS, IMPACT, ELECTRIC, IMPULSE = range(4)
INTEGRALS = 4
INTEGRAL, SUM = 16, 20

# Derivatives of F with respect to u and i, and of i' with respect to u, v, i and p.
JACOBIAN = 24

# Guards, positive while the mode lasts: of the stop, of the bar's and of the mole's friction. Their
# coefficients, and their values and rates at both ends of a step.
TOUCH, BAR, MOLE = range(3)
GUARDS = 3
OPEN, BAR_SLIP, MOLE_SLIP, BAR_HOLD, MOLE_HOLD = range(30, 35)
BAR_OFFSET, MOLE_OFFSET, BAR_LIMIT, MOLE_LIMIT = range(35, 39)
START, START_RATE, END, END_RATE = (39 + i * GUARDS for i in range(4))

# Mode, clock, bookkeeping.
ROW, BAR_MODE, MOLE_MODE, TOUCHING, HALF, TARGET, CONTACTS, ENTRIES = range(51, 59)
WISH, LONGEST, TIME, HALF_PERIOD, LOW, HIGH, TRIALS, LOOK = range(59, 67)

# The coil: inductance added by the bar in its middle, its width, and the longest step near it.
ADDED_MOST, WIDTH, COIL_STEP = range(67, 70)

GROWTH = 70  # logarithm of the factor by which tangents were divided
ROWS = 71

LONGEST_PERIOD = 64
"""Number of common periods among which a repetition is sought."""


class Block(NamedTuple):
    """Memory of sixteen lanes; the numbers of one lane are LANES apart.

    Attributes
    ----------
    whole : ndarray
        States, arguments and slopes; see `models.numerics.blocks.Layout`.
    state, new : ndarray
        Views of states and arguments; after the last stage `new` is the new state.
    end : ndarray
        Slopes at the new state.
    memory : ndarray
        Everything else; see the rows above.
    share, error : ndarray
        See `models.numerics.dop8.estimator`.
    ring : ndarray, shape (LANES, LONGEST_PERIOD, MEASURED)
        (u, v, x, |i|, |p|) at the last common periods.
    """

    whole: Any
    state: Any
    new: Any
    end: Any
    memory: Any
    share: Any
    error: Any
    ring: Any

    @staticmethod
    def made(columns: int) -> "Block":
        """Return memory for lanes with this many columns of tangents."""
        size = quantities(columns)
        where = layout(size, dop8.STAGES)
        whole = aligned(where.size)
        n = size * LANES
        return Block(
            whole,
            whole[where.state : where.state + n],
            whole[where.argument : where.argument + n],
            aligned(n),
            aligned(ROWS * LANES),
            aligned(MEASURED * LANES),
            aligned((1 + 2 * MEASURED) * LANES),
            np.empty((LANES, LONGEST_PERIOD, MEASURED)),
        )


def quantities(columns: int) -> int:
    """Return the number of quantities of a lane with this many columns of tangents."""
    return PLAIN + MEASURED * columns
