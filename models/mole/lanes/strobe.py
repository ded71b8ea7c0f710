"""Checks once per control period: whether the motion repeats, and how tangents grow."""

import math

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES, MEASURED, PLAIN
from models.mole.lanes.modes import mole_of
from models.mole.lanes.rows import GOING, PERIOD, REACHED_END, REPEATING, SCALES
from models.numerics.jit import lean

REPEAT = 1e-8
"""Of the scales of u, v, x, and of i and p by resistance and supply. Weak chaos may stay within
3e-5 of a cycle and, for hundreds of periods, return to within 1e-7."""
_ALIKE = 1e-6  # a divisor of the period at which the motion repeats this closely is the period


@lean
def _repetition(lane, q, m, y, ring):
    """Return after how many common periods the motion repeats, 0 if it does not.

    Current and voltage may return with opposite sign: only their squares act on the bar.
    """
    here = (
        y[at.U * LANES + lane],
        y[at.V * LANES + lane],
        y[at.X * LANES + lane],
        abs(y[at.CURRENT * LANES + lane]),
        abs(y[at.P * LANES + lane]),
    )
    entries = int(m[at.ENTRIES * LANES + lane])
    length = len(ring)
    found = 0
    for back in range(1, min(entries, length) + 1):
        if found == 0 and _distance(q, ring[(entries - back) % length], here) < REPEAT:
            found = back
    for back in range(1, found):
        # Approached from alternating sides, an orbit appears to have twice its period.
        if found % back == 0 and _distance(q, ring[(entries - back) % length], here) < _ALIKE:
            found = back
            break
    for j in range(MEASURED):
        ring[entries % length, j] = here[j]
    m[at.ENTRIES * LANES + lane] = entries + 1
    return found


@lean
def _distance(q, old, new):
    return max(
        abs(new[0] - old[0]) / SCALES[0],
        abs(new[1] - old[1]) / SCALES[1],
        abs(new[2] - old[2]) / SCALES[2],
        abs(new[3] - old[3]) * q.resistance / q.voltage,
        abs(new[4] - old[4]) / q.voltage,
    )


@lean
def _bring_back(lane, m, y, columns):
    """Rescale tangents to size 1, all by one factor."""
    size = 0.0
    for j in range(columns * MEASURED):
        size = max(size, abs(y[(PLAIN + j) * LANES + lane]))
    if size > 0:
        m[at.GROWTH * LANES + lane] += math.log(size)
        for j in range(columns * MEASURED):
            y[(PLAIN + j) * LANES + lane] /= size


@lean
def strobe(lane, task, m, y, ring, columns):
    """Check a lane at the start of half a control period; return its outcome."""
    row, half = int(m[at.ROW * LANES + lane]), int(m[at.HALF * LANES + lane])
    if half % 2 == 1:
        return GOING
    if columns > 0:
        _bring_back(lane, m, y, columns)
    periods, common = half // 2, task.common[row]
    if common > 0 and periods % common == 0:
        found = _repetition(lane, mole_of(task.table, row), m, y, ring[lane])
        if found > 0:
            task.record[row, PERIOD] = found
            return REPEATING
    return REACHED_END if periods >= task.limit[row] else GOING
