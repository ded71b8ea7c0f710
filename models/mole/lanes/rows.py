"""Rows of a study, loaded into lanes and stored back."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from models.mole.lanes import block as at
from models.mole.lanes.block import INTEGRALS, LANES, MEASURED
from models.mole.lanes.events import set_supply
from models.mole.lanes.modes import enter, enter_soil, force_on_bar, mole_of, see
from models.mole.parameters import PHYSICAL
from models.mole.theory.soil import (
    APART,
    SLIDING,
    decide_in_soil,
    soil_force,
    started,
    touched,
)
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
    DENT,
    FRONT,
    SOIL_MODE,
) = range(24)
RECORD = 24

GOING, REPEATING, REACHED_END, OUT_OF_BUDGET, STUCK = range(5)
"""Outcomes of a run."""

SCALES = (1e-2, 1.0, 0.1)
AWAY = 0.1
"""Distance of the mole from the soil behind which it no longer counts [m]."""


class Loading(NamedTuple):
    """Kernels that load rows into lanes, and store them.

    Attributes
    ----------
    load : kernel
        ``load(lane, row, task, m, y, columns)``
    unload : kernel
        ``unload(lane, task, m, y, columns, outcome)``
    """

    load: Callable[..., None]
    unload: Callable[..., None]


class Task(NamedTuple):
    """Rows to propagate.

    Attributes
    ----------
    table : ndarray, shape (n, 24)
        `Mole`s.
    record : ndarray, shape (n, RECORD)
        Updated in place; integrals, contacts, extremes and growth are those of this run.
    tangents : ndarray, shape (n, 5 columns), or (n, 7 columns) with soil ahead
        Updated in place and rescaled to size 1; zero in sticking velocities.
    limit : ndarray of int, shape (n,)
        Control periods since the start at which to stop.
    common : ndarray of int, shape (n,)
        Control periods after which a repetition ends the run; 0: never.
    tolerance : float
        Of a step, relative to the scales.
    budget : int
        Steps of a row in all its runs.
    warms : bool
        Whether the square of the current is integrated.
    """

    table: Any
    record: Any
    tangents: Any
    limit: Any
    common: Any
    tolerance: float
    budget: int
    warms: bool


def table_of(moles: Mole, n: int) -> Any:
    """Return n moles as a table, shape (n, 24)."""
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
        r[BAR_MODE], r[MOLE_MODE] = decide_in_soil(q, v, 0.0, force, 0.0)
        r[TOUCHING] = touching
        if q.soil_limit > 0:
            r[SOIL_MODE] = started(q, APART, 0.0, 0.0, q.soil_limit, int(r[MOLE_MODE]))


@kernel
def move_on(table, record):
    """Let moles go on with other constants: judge again which interfaces stick."""
    for row in range(len(record)):
        q, r = mole_of(table, row), record[row]
        force, _, _ = force_on_bar(q, r[TOUCHING] == 1, r[U], r[V], r[CURRENT])
        soil, pushed = APART, 0.0
        if q.soil_limit > 0:
            most = q.soil_limit / q.soil_stiffness
            soil, dent = int(r[SOIL_MODE]), min(r[DENT], most)
            r[FRONT] = min(r[FRONT], most) if soil == APART else dent
            r[DENT] = dent
            if soil != APART or dent >= r[FRONT]:
                soil = touched(q, dent, q.soil_limit, r[X])
            pushed = soil_force(q, soil, dent, q.soil_limit, r[X])
        r[BAR_MODE], r[MOLE_MODE] = decide_in_soil(q, r[V], r[X], force, pushed)
        if q.soil_limit > 0 and r[X] == 0:
            mole = int(r[MOLE_MODE])
            soil = started(q, soil, r[FRONT], r[DENT], q.soil_limit, mole)
        r[SOIL_MODE] = soil
        r[TRIALS] = 0.0


def loading(has_soil: bool) -> Loading:
    """Return the kernels that load and store rows with or without soil ahead."""
    plain, measured = at.lengths_of(has_soil)[:2]

    @lean
    def load(lane, row, task, m, y, columns):
        q, r = mole_of(task.table, row), task.record[row]
        m[at.ROW * LANES + lane] = row
        m[at.BAR_MODE * LANES + lane] = int(r[BAR_MODE])
        m[at.MOLE_MODE * LANES + lane] = int(r[MOLE_MODE])
        m[at.TOUCHING * LANES + lane] = int(r[TOUCHING])
        m[at.HALF * LANES + lane] = int(r[HALF])
        m[at.CONTACTS * LANES + lane] = m[at.ENTRIES * LANES + lane] = 0
        for j in range(MEASURED):
            y[j * LANES + lane] = r[U + j]
        for j in range(columns * measured):
            y[(plain + j) * LANES + lane] = task.tangents[row, j]
        for column in range(columns):
            z = plain + measured * column
            y[(z + at.V) * LANES + lane] *= 1.0 if r[BAR_MODE] != 0 else 0.0
            y[(z + at.X) * LANES + lane] *= 1.0 if r[MOLE_MODE] != 0 else 0.0
            if has_soil:
                damped = q.soil_damping > 0
                dented = (r[SOIL_MODE] != SLIDING or damped) and r[DENT] > -AWAY
                y[(z + at.DENT_COLUMN) * LANES + lane] *= 1.0 if dented else 0.0
                fronted = r[SOIL_MODE] == APART and damped
                y[(z + at.FRONT_COLUMN) * LANES + lane] *= 1.0 if fronted else 0.0
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
        if has_soil:
            y[at.DENT * LANES + lane], y[at.FRONT * LANES + lane] = r[DENT], r[FRONT]
            m[at.SOIL_MODE * LANES + lane] = r[SOIL_MODE]
            m[at.SHARE_X * LANES + lane] = 1 / (task.tolerance * SCALES[2])
            m[at.SHARE_DENT * LANES + lane] = 1 / (task.tolerance * SCALES[0])
        enter(q, lane, m, y)
        if has_soil:
            enter_soil(q, lane, m, y)
        see(q, lane, m, y)
        m[at.WISH * LANES + lane] = m[at.LONGEST * LANES + lane]

    @lean
    def unload(lane, task, m, y, columns, outcome):
        row = int(m[at.ROW * LANES + lane])
        r = task.record[row]
        for j in range(MEASURED):
            r[U + j] = y[j * LANES + lane]
        for j in range(columns * measured):
            task.tangents[row, j] = y[(plain + j) * LANES + lane]
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
        if has_soil:
            r[DENT], r[FRONT] = y[at.DENT * LANES + lane], y[at.FRONT * LANES + lane]
            r[SOIL_MODE] = m[at.SOIL_MODE * LANES + lane]

    return Loading(load, unload)


@lean
def idle(lane, m):
    """Stop a lane for which no row is left: its state is no number from now on."""
    m[at.ROW * LANES + lane] = -1
    m[at.LONGEST * LANES + lane] = 0.0
