"""Checks once per control period: whether the motion repeats, and how tangents grow."""

import math
from collections.abc import Callable

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES, MEASURED
from models.mole.lanes.modes import mole_of
from models.mole.lanes.rows import AWAY, GOING, PERIOD, REACHED_END, REPEATING, SCALES
from models.mole.theory.soil import APART
from models.numerics.jit import lean

REPEAT = 1e-8  # of the scales of u, v, x, and of i and p by resistance and supply
_ALIKE = 1e-6
"""How closely a whole period must repeat, and a divisor of the period to be the period. Motion that
drifts past a cycle returns to within 1e-8 where it hardly depends on its past, 1e-5 elsewhere."""


def strobing(has_soil: bool) -> Callable[..., int]:
    """Return the kernel that checks a lane at the start of half a control period.

    Parameters
    ----------
    has_soil : bool
        Whether lanes have soil ahead.

    Returns
    -------
    kernel
        ``strobe(lane, task, m, y, ring, columns)`` returns the outcome of the lane.
    """
    plain, measured = at.lengths_of(has_soil)[:2]

    @lean
    def distance_of(q, old, new):
        distance = max(
            abs(new[0] - old[0]) / SCALES[0],
            abs(new[1] - old[1]) / SCALES[1],
            abs(new[2] - old[2]) / SCALES[2],
            abs(new[3] - old[3]) * q.resistance / q.voltage,
            abs(new[4] - old[4]) / q.voltage,
        )
        if has_soil:
            for j in range(MEASURED, measured):
                distance = max(distance, abs(new[j] - old[j]) / SCALES[0])
        return distance

    @lean
    def whole_period(q, ring, last, back):
        """Return whether the states since the one `back` before the last have repeated, too."""
        length, largest = len(ring), 0.0
        for i in range(last - back + 1, last):
            largest = max(largest, distance_of(q, ring[(i - back) % length], ring[i % length]))
        return largest < _ALIKE

    @lean
    def repetition(lane, q, m, y, ring):
        """Return the number of common periods after which the motion repeats, 0 if it does not.

        Current and voltage may return with opposite sign: only their squares act on the bar.
        """
        last, length = int(m[at.ENTRIES * LANES + lane]), len(ring)
        here = ring[last % length]
        here[0] = y[at.U * LANES + lane]
        here[1] = y[at.V * LANES + lane]
        here[2] = y[at.X * LANES + lane]
        here[3] = abs(y[at.CURRENT * LANES + lane])
        here[4] = abs(y[at.P * LANES + lane])
        if has_soil:
            # A mole far from the soil repeats although it backs away.
            dent, front = y[at.DENT * LANES + lane], y[at.FRONT * LANES + lane]
            apart = m[at.SOIL_MODE * LANES + lane] == APART
            here[at.DENT_COLUMN], here[at.FRONT_COLUMN] = max(dent, -AWAY), front if apart else 0.0
        m[at.ENTRIES * LANES + lane] = last + 1
        period = 0
        for back in range(1, min(last + 1, length) // 2 + 1):
            close = period == 0 and distance_of(q, ring[(last - back) % length], here) < REPEAT
            if close and whole_period(q, ring, last, back):
                period = back
        for back in range(1, period):
            # Approached from alternating sides, an orbit appears to have twice its period.
            if period % back == 0 and distance_of(q, ring[(last - back) % length], here) < _ALIKE:
                period = back
                break
        return period

    @lean
    def bring_back(lane, m, y, columns):
        """Rescale tangents to size 1, all by one factor."""
        size = 0.0
        for j in range(columns * measured):
            size = max(size, abs(y[(plain + j) * LANES + lane]))
        if size > 0:
            m[at.GROWTH * LANES + lane] += math.log(size)
            for j in range(columns * measured):
                y[(plain + j) * LANES + lane] /= size

    @lean
    def strobe(lane, task, m, y, ring, columns):
        row, half = int(m[at.ROW * LANES + lane]), int(m[at.HALF * LANES + lane])
        if half % 2 == 1:
            return GOING
        if columns > 0:
            bring_back(lane, m, y, columns)
        periods, common = half // 2, task.common[row]
        if common > 0 and periods % common == 0:
            period = repetition(lane, mole_of(task.table, row), m, y, ring[lane])
            if period > 0:
                task.record[row, PERIOD] = period
                return REPEATING
        return REACHED_END if periods >= task.limit[row] else GOING

    return strobe
