"""Measures of the settled response of n moles."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.mole.lanes.rows import (
    CONTACTS,
    ELECTRIC,
    HIGH,
    IMPACT,
    IMPULSE,
    LOW,
    PROGRESS,
    SQUARED,
)

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
    progress, impact, electric, impulse, contacts, squared : ndarray, shape (n, BATCHES)
        Advance of the mole [m], work of the impacts and of the supply [J], impulse of the contact
        force [N s], number of contacts and integral of the square of the current [A2 s] in each
        batch; all in the first if the motion repeats.
    low, high : ndarray, shape (n, BATCHES)
        Smallest and largest displacement u [m] in each batch; infinite in batches without motion.
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
    squared: Array
    low: Array
    high: Array
    touching: Flags
    growth: Array
    period: Counts

    @staticmethod
    def nothing(n: int) -> "Response":
        """Return n unknown responses."""
        batches = (np.zeros((n, BATCHES)) for _ in range(7))
        progress, impact, electric, impulse, contacts, squared, growth = batches
        return Response(
            np.full(n, np.nan),
            progress,
            impact,
            electric,
            impulse,
            contacts,
            squared,
            np.full((n, BATCHES), np.inf),
            np.full((n, BATCHES), -np.inf),
            np.zeros(n, bool),
            growth,
            np.zeros(n, np.int64),
        )

    def forget(self, rows: Counts) -> None:
        """Reset some responses to unknown."""
        for mine, new in zip(self, Response.nothing(len(rows)), strict=True):
            mine[rows] = new

    def note(self, rows: Counts, batch: int, record: Array) -> None:
        """Add the measurements of a run of several moles."""
        self.progress[rows, batch] += record[:, PROGRESS]
        self.impact[rows, batch] += record[:, IMPACT]
        self.electric[rows, batch] += record[:, ELECTRIC]
        self.impulse[rows, batch] += record[:, IMPULSE]
        self.contacts[rows, batch] += record[:, CONTACTS]
        self.squared[rows, batch] += record[:, SQUARED]
        self.low[rows, batch] = np.minimum(self.low[rows, batch], record[:, LOW])
        self.high[rows, batch] = np.maximum(self.high[rows, batch], record[:, HIGH])
