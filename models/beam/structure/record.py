"""What a propagator reports about some forcing periods."""

from typing import NamedTuple

import numpy as np

from models.beam.structure.modal import Array

LONGEST = 16_384
"""Forcing periods in a time mean, at most; a propagator may take fewer."""


class Record(NamedTuple):
    """What a propagator reports about some forcing periods of n beams.

    Attributes
    ----------
    work : ndarray, shape (n, periods, 2)
        Nondimensional impact work at the right and the left site in each period.
    strobe : ndarray, shape (n, periods, 2)
        Tip x and dx/d(Omega t) at the end of each period, in initial gaps.
    peak : ndarray, shape (n, 2)
        Largest penetration at each site, in initial gaps.
    trace : ndarray, shape (n, periods * steps)
        Tip displacement at every step, in initial gaps; empty unless asked for.
    """

    work: Array
    strobe: Array
    peak: Array
    trace: Array

    @staticmethod
    def empty(n: int, periods: int, steps: int = 0) -> "Record":
        """Return a record to be filled in."""
        return Record(
            np.zeros((n, periods, 2)),
            np.zeros((n, periods, 2)),
            np.zeros((n, 2)),
            np.zeros((n, periods * steps)),
        )
