"""n moles over whole control periods: a `models.numerics.propagator.Propagator`."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.mole.lanes.block import lengths_of
from models.mole.lanes.loop import run
from models.mole.lanes.rows import (
    GROWTH,
    OUTCOME,
    REACHED_END,
    RECORD,
    REPEATING,
    Task,
    begin,
    move_on,
    table_of,
)
from models.mole.parameters import Rows, Settings
from models.mole.theory.periods import common_periods
from models.mole.theory.system import Mole, mole
from models.numerics import elementary

Array = NDArray[np.float64]
Counts = NDArray[np.int64]

BUDGET = 2_000_000  # trial steps of a mole; more for long averages


class System(NamedTuple):
    """n moles, prepared.

    Attributes
    ----------
    table : ndarray, shape (n, 24)
        See `models.mole.lanes.rows.table_of`.
    control_frequency : ndarray, shape (n,)
        [Hz]
    common : ndarray of int, shape (n,)
        Common period of control and mains [control periods], 0 if there is none.
    tolerance : float
        Relative tolerance of a step.
    budget : int
        Trial steps of each mole.
    warms : bool
        Whether the heat in the coil is wanted.
    """

    table: Array
    control_frequency: Array
    common: Counts
    tolerance: float
    budget: int
    warms: bool

    @property
    def soil(self) -> NDArray[np.bool_]:
        """Moles with soil ahead."""
        return np.asarray(self.table[:, Mole._fields.index("soil_limit")] > 0)

    @property
    def measured(self) -> int:
        """Quantities in a tangent: 5, or 7 if there is soil ahead of all moles."""
        return lengths_of(bool(self.soil.all())).measured

    def take(self, rows: NDArray[np.intp]) -> "System":
        """Return some of the moles."""
        return System(
            self.table[rows],
            self.control_frequency[rows],
            self.common[rows],
            self.tolerance,
            self.budget,
            self.warms,
        )


def groups(p: Rows, settings: Settings) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Prepare n moles with the formulation and tolerance of the settings, all in one group."""
    n = len(p.control_frequency)
    yield (
        np.arange(n),
        System(
            table_of(mole(p, settings.formulation), n),
            p.control_frequency,
            common_periods(p.control_frequency, p.supply_frequency),
            settings.tolerance,
            BUDGET,
            bool(settings.distance or settings.temperature),
        ),
    )


def start(system: System, displacement: Array, velocity: Array) -> Array:
    """Return the records of moles at rest whose relays have just closed, shape (n, RECORD).

    The bars are at u [m] and move at v [m s-1]. A record holds the state and what the last run
    measured; see `models.mole.lanes.rows`.
    """
    record = np.empty((len(system.table), RECORD))
    begin(system.table, displacement, velocity, record)
    return record


def resume(system: System, record: Array) -> Array:
    """Return the records of moles that go on from earlier ones with the constants of a system."""
    record = record.copy()
    move_on(system.table, record)
    return record


def advance(
    system: System,
    record: Array,
    limit: Counts,
    tangents: Array | None = None,
    repeat: bool = False,
) -> Counts:
    """Advance n moles.

    Parameters
    ----------
    system, record
    limit : ndarray of int, shape (n,)
        Control periods since the start at which to stop.
    tangents : ndarray, shape (n, 5 columns), optional
        0, 1 or 5 columns, updated in place; see `models.mole.lanes.rows.Task`. Where there is soil
        ahead, 7 instead of 5; then it must be ahead of all moles.
    repeat : bool
        Whether to stop once the motion repeats.

    Returns
    -------
    ndarray of int
        Moles that reached their limit, or a repetition.
    """
    n = len(record)
    soil = system.soil
    if tangents is None:
        tangents = np.empty((n, 0))
    elif soil.any() and not soil.all():
        raise ValueError("tangents of moles with and without soil ahead differ in length")
    common = system.common if repeat else np.zeros(n, np.int64)
    task = Task(
        system.table,
        record,
        tangents,
        limit,
        common,
        system.tolerance,
        system.budget,
        system.warms,
    )
    columns = tangents.shape[1] // system.measured
    if soil.any() and not soil.all():
        for rows in np.flatnonzero(~soil), np.flatnonzero(soil):
            some = record[rows]
            part = task._replace(
                table=task.table[rows],
                record=some,
                tangents=tangents[rows],
                limit=limit[rows],
                common=common[rows],
            )
            run(part, 0, bool(soil[rows[0]]))
            record[rows] = some
    else:
        run(task, columns, bool(soil.any()))
    outcome = record[:, OUTCOME]
    return np.flatnonzero((outcome == REACHED_END) | (outcome == REPEATING))


def monodromy(system: System, record: Array, limit: Counts) -> Array:
    """Return the derivative of (u, v, x, i, p); zero with respect to a sticking velocity.

    With soil ahead of all moles, of the dent and of the front, too.
    """
    after = record.copy()
    size = system.measured
    tangents = np.tile(np.eye(size).ravel(), (len(record), 1))
    advance(system, after, limit, tangents)
    columns = tangents.reshape(-1, size, size)
    return elementary.exp(after[:, GROWTH])[:, None, None] * columns.transpose(0, 2, 1)
