"""n moles and their present states, from which the settled response is computed."""

from typing import NamedTuple

import numpy as np

from models.mole.lanes import System, advance, groups, resume, start
from models.mole.lanes.rows import HALF
from models.mole.parameters import Rows, Settings
from models.mole.response.measured import Array, Counts

APERIODIC = 200
"""Control periods averaged at first where the motion does not repeat."""


class Machines(NamedTuple):
    """n moles.

    Attributes
    ----------
    system : System
    record : ndarray, shape (n, RECORD)
        Their states, and what their last run measured; see `models.mole.lanes.rows`.
    """

    system: System
    record: Array

    @staticmethod
    def started(p: Rows, settings: Settings, periods: int = 0) -> "Machines":
        """Return moles just switched on, with a budget for at least this many control periods."""
        ((_, system),) = groups(p, settings)
        system = system._replace(budget=system.budget * max(1, -(-periods // APERIODIC)))
        return Machines(system, start(system, p.initial_displacement, p.initial_velocity))

    def with_inputs(self, rows: Counts, p: Rows, settings: Settings) -> "Machines":
        """Return some of the moles in their present states, with other inputs and a new budget."""
        ((_, system),) = groups(p, settings)
        system = system._replace(budget=self.system.budget)
        return Machines(system, resume(system, self.record[rows]))

    def run(
        self, rows: Counts, limit: Counts, tangents: Array | None = None, repeat: bool = False
    ) -> Counts:
        """Propagate some of the moles; return which of them reached their limits.

        Parameters
        ----------
        rows : ndarray of int, shape (k,)
        limit, tangents, repeat
            For these rows; see `models.mole.lanes.propagator.advance`.

        Returns
        -------
        ndarray of int
            Indices into `rows`.
        """
        record = self.record[rows]
        reached = advance(self.system.take(rows), record, limit, tangents, repeat)
        self.record[rows] = record
        return reached

    def periods(self, rows: Counts) -> Counts:
        """Return the number of control periods completed."""
        return (self.record[rows, HALF] / 2).astype(np.int64)
