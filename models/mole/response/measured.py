"""Measures of the settled response of n moles."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.mole.lanes.rows import CONTACTS, ELECTRIC, HIGH, IMPACT, IMPULSE, LOW, PROGRESS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Counts = NDArray[np.int64]

BATCHES = 20
"""Parts of a time mean, whose scatter gives its error."""


class Response(NamedTuple):
    """The settled response of n moles; NaN where a run was not completed.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Time averaged over [s].
    progress, impact, electric : ndarray, shape (n, BATCHES)
        Advance of the mole [m], work of the impacts and of the supply [J] in each batch; all in the
        first if the motion repeats.
    impulse : ndarray, shape (n,)
        Of the contact force [N s].
    contacts : ndarray, shape (n,)
    low, high : ndarray, shape (n,)
        Smallest and largest displacement u [m].
    touching : ndarray of bool, shape (n,)
        Whether the bar touched the stop at the beginning.
    growth : ndarray, shape (n, BATCHES)
        Growth of the logarithm of a tangent in each batch; if the motion repeats, the logarithm of
        the largest multiplier, in the first.
    period : ndarray of int, shape (n,)
        Period of a response that repeats, in common periods; else 0.
    """

    time: Array
    progress: Array
    impact: Array
    electric: Array
    impulse: Array
    contacts: Array
    low: Array
    high: Array
    touching: Flags
    growth: Array
    period: Counts

    @staticmethod
    def nothing(n: int) -> "Response":
        """Return n unknown responses."""
        batches = (np.zeros((n, BATCHES)) for _ in range(4))
        progress, impact, electric, growth = batches
        return Response(
            np.full(n, np.nan),
            progress,
            impact,
            electric,
            np.zeros(n),
            np.zeros(n),
            np.full(n, np.inf),
            np.full(n, -np.inf),
            np.zeros(n, bool),
            growth,
            np.zeros(n, np.int64),
        )

    def forget(self, rows: Counts) -> None:
        """Reset some responses to unknown."""
        for mine, new in zip(self, Response.nothing(len(rows)), strict=True):
            mine[rows] = new

    def note(self, rows: Counts, batch: int, record: Array) -> None:
        """Add what a run of some moles measured."""
        self.progress[rows, batch] += record[:, PROGRESS]
        self.impact[rows, batch] += record[:, IMPACT]
        self.electric[rows, batch] += record[:, ELECTRIC]
        self.impulse[rows] += record[:, IMPULSE]
        self.contacts[rows] += record[:, CONTACTS]
        self.low[rows] = np.minimum(self.low[rows], record[:, LOW])
        self.high[rows] = np.maximum(self.high[rows], record[:, HIGH])
