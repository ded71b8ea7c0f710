"""Rows of a study, loaded into lanes and stored back."""

import math
from typing import Any, NamedTuple

import numpy as np

from models.mole.lanes import block as at
from models.mole.lanes.block import INTEGRALS, LANES, MEASURED, PLAIN
from models.mole.lanes.events import set_supply
from models.mole.lanes.modes import enter, force_on_bar, mole_of, see
from models.mole.parameters import PHYSICAL
from models.mole.theory.friction import decide
from models.mole.theory.system import Mole
from models.numerics.jit import kernel, lean

# The record of a row: its state, on which its future depends, and what a run measured.
(
    U,
    V,
    X,
    CURRENT,
    P,
    BAR_MODE,
    MOLE_MODE,
    TOUCHING,
    HALF,
    PROGRESS,
    IMPACT,
    ELECTRIC,
    IMPULSE,
    CONTACTS,
    LOW,
    HIGH,
    TRIALS,
    OUTCOME,
    PERIOD,
    GROWTH,
    SQUARED,
) = range(21)
RECORD = 21

GOING, REPEATING, REACHED_END, OUT_OF_BUDGET, STUCK = range(5)
"""Outcomes of a run."""

SCALES = (1e-2, 1.0, 0.1)


class Task(NamedTuple):
    """Rows to propagate.

    Attributes
    ----------
    table : ndarray, shape (n, 20)
        `Mole`s.
    record : ndarray, shape (n, RECORD)
        Updated in place; integrals, contacts, extremes and growth are those of this run.
    tangents : ndarray, shape (n, 5 columns)
        Updated in place and rescaled to size 1; zero in sticking velocities.
    limit : ndarray of int, shape (n,)
        Control periods since the start at which to stop.
    common : ndarray of int, shape (n,)
        Control periods after which a repetition ends the run; 0: never.
    tolerance : float
        Of a step, relative to the scales.
    budget : int
        Steps of a row in all its runs.
    """

    table: Any
    record: Any
    tangents: Any
    limit: Any
    common: Any
    tolerance: float
    budget: int


def table_of(moles: Mole, n: int) -> Any:
    """Return n moles as a table, shape (n, 20)."""
    return np.stack([np.broadcast_to(np.asarray(field, float), n) for field in moles], axis=1)


@kernel
def begin(table, displacement, velocity, record):
    """Set the records of moles at rest with moving bars, relays just closed."""
    record[:] = 0.0
    for row in range(len(record)):
        q, r = mole_of(table, row), record[row]
        u, v = displacement[row], velocity[row]
        touching = u > q.stop_gap
        force, _, _ = force_on_bar(q, touching, u, v, 0.0)
        r[U], r[V] = u, v
        r[P] = q.voltage * np.sin(q.supply_phase) if q.formulation == PHYSICAL else 0.0
        r[BAR_MODE], r[MOLE_MODE] = decide(q, v, 0.0, force)
        r[TOUCHING] = touching


@kernel
def move_on(table, record):
    """Let moles go on with other constants: judge again which interfaces stick."""
    for row in range(len(record)):
        q, r = mole_of(table, row), record[row]
        force, _, _ = force_on_bar(q, r[TOUCHING] == 1, r[U], r[V], r[CURRENT])
        r[BAR_MODE], r[MOLE_MODE] = decide(q, r[V], r[X], force)
        r[TRIALS] = 0.0


@lean
def load(lane, row, task, m, y, columns):
    """Load a row into a lane."""
    q, r = mole_of(task.table, row), task.record[row]
    m[at.ROW * LANES + lane] = row
    m[at.BAR_MODE * LANES + lane] = int(r[BAR_MODE])
    m[at.MOLE_MODE * LANES + lane] = int(r[MOLE_MODE])
    m[at.TOUCHING * LANES + lane] = int(r[TOUCHING])
    m[at.HALF * LANES + lane] = int(r[HALF])
    m[at.CONTACTS * LANES + lane] = m[at.ENTRIES * LANES + lane] = 0
    for j in range(MEASURED):
        y[j * LANES + lane] = r[U + j]
    for j in range(columns * MEASURED):
        y[(PLAIN + j) * LANES + lane] = task.tangents[row, j]
    for column in range(columns):
        z = PLAIN + MEASURED * column
        y[(z + at.V) * LANES + lane] *= 1.0 if r[BAR_MODE] != 0 else 0.0
        y[(z + at.X) * LANES + lane] *= 1.0 if r[MOLE_MODE] != 0 else 0.0
    m[at.GROWTH * LANES + lane] = 0.0
    for j in range(INTEGRALS):
        m[(at.SUM + j) * LANES + lane] = 0.0
    m[at.SQUARED * LANES + lane] = 0.0
    m[at.DAMPING * LANES + lane] = q.damping
    m[at.SLOPE * LANES + lane] = -2 * q.sharpness
    m[at.ADDED_MOST * LANES + lane] = q.bar_inductance
    m[at.WIDTH * LANES + lane] = 1 / math.sqrt(2 * q.sharpness)
    m[at.COIL * LANES + lane] = q.coil_inductance
    m[at.RESISTANCE * LANES + lane] = q.resistance
    m[at.ELASTANCE * LANES + lane] = q.elastance
    m[at.SPEED * LANES + lane] = q.supply_speed
    m[at.GAP * LANES + lane] = q.stop_gap
    m[at.SHARE * LANES + lane] = 1 / (task.tolerance * SCALES[0])
    m[(at.SHARE + 1) * LANES + lane] = 1 / (task.tolerance * SCALES[1])
    most = q.coil_inductance + q.bar_inductance
    m[(at.SHARE + 2) * LANES + lane] = 10 * q.resistance / (task.tolerance * q.voltage * most)
    m[(at.SHARE + 3) * LANES + lane] = 1 / (task.tolerance * q.voltage)
    m[at.HALF_PERIOD * LANES + lane] = 0.5 * q.control_period
    m[at.LOW * LANES + lane] = m[at.HIGH * LANES + lane] = r[U]
    m[at.TRIALS * LANES + lane] = r[TRIALS]
    set_supply(q, lane, m, y)
    enter(q, lane, m, y)
    see(q, lane, m, y)
    m[at.WISH * LANES + lane] = m[at.LONGEST * LANES + lane]


@lean
def unload(lane, task, m, y, columns, outcome):
    """Store a lane in the record of its row."""
    row = int(m[at.ROW * LANES + lane])
    r = task.record[row]
    for j in range(MEASURED):
        r[U + j] = y[j * LANES + lane]
    for j in range(columns * MEASURED):
        task.tangents[row, j] = y[(PLAIN + j) * LANES + lane]
    for j in range(INTEGRALS):
        r[PROGRESS + j] = m[(at.SUM + j) * LANES + lane]
    r[BAR_MODE], r[MOLE_MODE] = (
        m[at.BAR_MODE * LANES + lane],
        m[at.MOLE_MODE * LANES + lane],
    )
    r[TOUCHING], r[HALF] = m[at.TOUCHING * LANES + lane], m[at.HALF * LANES + lane]
    r[CONTACTS] = m[at.CONTACTS * LANES + lane]
    r[LOW] = min(m[at.LOW * LANES + lane], y[at.U * LANES + lane])
    r[HIGH] = max(m[at.HIGH * LANES + lane], y[at.U * LANES + lane])
    r[TRIALS] = m[at.TRIALS * LANES + lane]
    r[GROWTH] = m[at.GROWTH * LANES + lane]
    r[SQUARED] = m[at.SQUARED * LANES + lane]
    r[OUTCOME] = outcome


@lean
def idle(lane, m):
    """Stop a lane for which no row is left: its state is no number from now on."""
    m[at.ROW * LANES + lane] = -1
    m[at.LONGEST * LANES + lane] = 0.0
