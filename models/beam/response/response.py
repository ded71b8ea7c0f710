"""The settled response, and the indices of its regimes."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import REGIMES
from models.beam.structure.modal import Array

NO_IMPACT, SYMMETRIC, ASYMMETRIC, PERIODIC, APERIODIC = range(len(REGIMES))


class Response(NamedTuple):
    """The settled response of n beams at constant gaps.

    Attributes
    ----------
    work : ndarray, shape (n, 2)
        Mean dimensionless work per forcing period at the right and the left site.
    error : ndarray, shape (n, 2)
        Half-width of the 90 % interval, 0 if periodic.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    regime : ndarray of int8, shape (n,)
        Index into `models.beam.parameters.REGIMES`.
    period : ndarray, shape (n,)
        In forcing periods, 0 if aperiodic.
    multiplier : ndarray, shape (n,)
        Largest modulus of the orbit's Floquet multipliers, over its period; NaN if aperiodic or
        without impacts.
    """

    work: Array
    error: Array
    peak: Array
    regime: NDArray[np.int8]
    period: Array
    multiplier: Array

    @staticmethod
    def settling(n: int) -> "Response":
        """Return a response of n beams to fill in: aperiodic, at rest."""
        regime = np.full(n, APERIODIC, np.int8)
        return Response._make([*np.zeros((3, n, 2)), regime, np.zeros(n), np.full(n, np.nan)])

    @staticmethod
    def nothing(n: int) -> "Response":
        """Return the response of n beams before they are run: unknown."""
        regime = np.full(n, APERIODIC, np.int8)
        unknown = np.full((2, n), np.nan)
        return Response._make([*np.full((3, n, 2), np.nan), regime, *unknown])

    def take(self, rows: NDArray[np.intp]) -> "Response":
        """Return the responses of some beams."""
        return Response._make(field[rows] for field in self)

    def put(self, rows: NDArray[np.intp], other: "Response") -> None:
        """Set the responses of some beams."""
        fields: tuple[Any, ...] = self
        for mine, theirs in zip(fields, other, strict=True):
            mine[rows] = theirs

    def forget(self, rows: NDArray[np.intp]) -> None:
        """Reset some beams to unknown."""
        self.put(rows, Response.nothing(len(rows)))
