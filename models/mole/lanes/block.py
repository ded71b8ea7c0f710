"""The memory layout of a block of moles."""

from typing import Any, NamedTuple

import numpy as np

from models.mole.parameters import LONGEST_PERIOD
from models.numerics.blocks import aligned

LANES = 32
"""Moles at a time: enough for sums to be limited by loads instead of by latency."""

# Quantities of a lane, followed by its tangents, which have the first five each.
U, V, X, CURRENT, P, ADDED, SINE, COSINE = range(8)
PLAIN = 8
MEASURED = 5
# With soil ahead two more follow, measured from the base of the soil: the mole's front and the
# soil's. Tangents have them after the first five.
DENT, FRONT = 8, 9
OF_SOIL = 2
DENT_COLUMN, FRONT_COLUMN = 5, 6

ORDER = 12
"""Order of the series."""
TERMS = ORDER + 2

# Series of a lane, beginning with those whose errors count. The mole's velocity, which is linear in
# v and time, has none. PATH and AREA are the first and the second integral of u, WORK that of i p;
# RISE is L', SQUARE i^2; the factors of the tangents' equations, the guard that ends a step, and
# values for the moment follow, and five series of each tangent.
U_S, V_S, FLUX_S, P_S, CURRENT_S, ADDED_S, SINE_S, COSINE_S = range(8)
PATH_S, AREA_S, WORK_S, RISE_S, SQUARE_S, FORCE_S = range(8, 14)
BEND_S, PULL_S, TURN_S, GUARD_S, HERE_S = range(14, 19)
SHARED = 19
WATCHED = 4
# With soil ahead follow the mole's velocity and its integral, the dent, the front, what holds the
# bar, the integral of u x, and values for the moment; and in each tangent velocity, dent and front.
X_S, WAY_S, DENT_S, FRONT_S, HELD_S, RUB_S, MORE_S = range(19, 26)
SHARED_OF_SOIL = 7
COLUMN_OF_SOIL = 3

# Rows of a block's memory, beginning with the constants of a lane in its present mode.
(
    STEP,
    A,
    B,
    RATIO,
    DRIFT,
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

# Sums so far: of the velocity, the powers of impacts and supply, and the contact force.
PROGRESS, IMPACT, ELECTRIC, IMPULSE = range(4)
INTEGRALS = 4
SUM = 16

# Guards, positive while the mode lasts: of the stop, of the bar's and of the mole's friction. Their
# coefficients; their values and slopes at the beginning, in the middle and at the end of a step.
# With soil ahead two more: that it is touched or not, and that its base slides or not.
TOUCH, BAR, MOLE, SOIL, YIELD = range(5)
GUARDS = 5
WITHOUT_SOIL = 3
OPEN, BAR_SLIP, MOLE_SLIP, BAR_HOLD, MOLE_HOLD = range(20, 25)
BAR_OFFSET, MOLE_OFFSET, BAR_LIMIT, MOLE_LIMIT = range(25, 29)
LOOKS = 3
VALUE, RATE = 29, 44
PRESSED = 59  # the force on the bar there

# The guard that ends a step: its coefficients of u, v, F, 1 and t; where it lies between two
# places; where it is zero or the step ends, and the latest place for that, in steps.
MET, OF_U, OF_V, OF_F, OF_1, OF_T, LEFT, RIGHT, REACH, MOST = range(62, 72)

# Mode, clock, bookkeeping.
ROW, BAR_MODE, MOLE_MODE, TOUCHING, HALF, CONTACTS, ENTRIES = range(72, 79)
WISH, LONGEST, TIME, HALF_PERIOD, LOW, HIGH, TRIALS, LOOK = range(79, 87)

# The coil: inductance added by the bar in its middle, its width, and the inverse of the inductance.
ADDED_MOST, WIDTH, INVERSE = range(87, 90)

GROWTH = 90  # logarithm of the factor by which tangents were divided
SHARE = 91  # of the series whose errors count: the inverse of the error allowed
SQUARED = SHARE + WATCHED  # sum so far of the square of the current

# Soil: its mode; accelerations by its force, and of the mole by F and without; its force as a sum
# over 1, dent and velocity; rates of dent and front; its share in what holds the bar.
SOIL_MODE, ON_BAR, ON_MOLE, D, E, SOIL_1, SOIL_DENT, SOIL_X = range(96, 104)
DENT_X, DENT_1, DENT_DENT, RELAX, HELD_SOIL = range(104, 109)
# Coefficients of both guards of x, dent, front and 1, and of the guard that ends a step.
SOIL_OF, YIELD_OF = 109, 113
OF_X, OF_DENT, OF_FRONT = range(117, 120)
SHARE_X, SHARE_DENT = 120, 121
ROWS_OF_SOIL = 122
ROWS = SQUARED + 1

TO_REPEAT = 2 * LONGEST_PERIOD
"""Number of common periods in which a motion with the longest period is seen to repeat."""


class Lengths(NamedTuple):
    """Numbers of quantities of a lane.

    Attributes
    ----------
    plain, measured : int
        In a state without tangents, and in each tangent.
    shared, column : int
        Series without tangents, and of each tangent.
    rows : int
        Of memory.
    """

    plain: int
    measured: int
    shared: int
    column: int
    rows: int


def lengths_of(has_soil: bool) -> Lengths:
    """Return the `Lengths` of lanes with or without soil ahead."""
    if not has_soil:
        return Lengths(PLAIN, MEASURED, SHARED, MEASURED, ROWS)
    return Lengths(
        PLAIN + OF_SOIL,
        MEASURED + OF_SOIL,
        SHARED + SHARED_OF_SOIL,
        MEASURED + COLUMN_OF_SOIL,
        ROWS_OF_SOIL,
    )


class Block(NamedTuple):
    """Memory of a block of lanes; the numbers of one lane are LANES apart.

    Attributes
    ----------
    state : ndarray
        States, including tangents.
    series : ndarray
        TERMS coefficients of each series, of powers of the time in units of the step.
    memory : ndarray
        Everything else; see the rows above.
    ring : ndarray, shape (LANES, TO_REPEAT, MEASURED)
        (u, v, x, |i|, |p|) at the last common periods, with soil ahead dent and front, too.
    """

    state: Any
    series: Any
    memory: Any
    ring: Any

    @staticmethod
    def made(columns: int, has_soil: bool) -> "Block":
        """Return memory for lanes with this many columns of tangents."""
        lengths = lengths_of(has_soil)
        series = lengths.shared + lengths.column * columns
        return Block(
            aligned((lengths.plain + lengths.measured * columns) * LANES),
            aligned(series * TERMS * LANES),
            aligned(lengths.rows * LANES),
            np.empty((LANES, TO_REPEAT, lengths.measured)),
        )
