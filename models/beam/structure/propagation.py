"""What a propagator of the beam promises, and what it reports."""

from collections.abc import Iterator
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Settings
from models.beam.structure.modal import Array, Beams
from models.numerics import propagator

LONGEST = 16_384
"""Forcing periods in a time mean, at most."""


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


class System(Protocol):
    """n beams, prepared by a propagator for itself."""

    @property
    def beams(self) -> Beams:
        """The same beams."""

    @property
    def reach(self) -> Array:
        """Bound of the tip's displacement without contact, in initial gaps, shape (n,)."""

    @property
    def steps(self) -> int:
        """Steps in a forcing period."""

    @property
    def longest(self) -> int:
        """Forcing periods in a time mean, at most: no more than `LONGEST`."""

    def take(self, rows: NDArray[np.intp], /) -> "System":
        """Return the systems of some rows."""


class Propagator(propagator.Propagator, Protocol):
    """Takes n beams through forcing periods: `models.beam.lanes` and `models.beam.exact` do.

    It keeps all promises of `models.numerics.propagator.Propagator`. A beam that cannot be followed
    any further gets NaN.
    """

    CLOCK: int
    """Column of the state that counts forcing periods."""

    def groups(
        self, beams: Beams, settings: Settings, /
    ) -> Iterator[tuple[NDArray[np.intp], System]]:
        """Prepare n beams, in groups that are propagated together.

        Yields
        ------
        rows : ndarray of int
            Which of the n beams are in the group; one that cannot be followed is in none.
        system : System
        """

    def finer(
        self, system: Any, state: Array, /
    ) -> Iterator[tuple[NDArray[np.intp], System, Array]]:
        """Prepare the same beams for steps of half the size, in groups.

        Yields
        ------
        rows : ndarray of int
            Which of the system's beams are in the group.
        system : System
        state : ndarray, shape (n, k')
            Nearly the same as the one given.
        """

    def start(self, system: Any, displacement: Array, velocity: Array, /) -> Array:
        """Return the state at phase 0 of the force, tip displaced in the shape of the first mode.

        Parameters
        ----------
        system : System
        displacement, velocity : ndarray, shape (n,)
            Of the tip, in initial gaps and initial gaps per second.

        Returns
        -------
        ndarray, shape (n, k)
            As the propagator wishes, but for its clock.
        """

    def advance(
        self,
        system: Any,
        state: Array,
        gaps: Array,
        growth: Array,
        periods: int,
        /,
        trace: bool = False,
    ) -> Record:
        """Advance n beams by whole periods of the force, their gaps growing with the work done.

        Parameters
        ----------
        system : System
        state : ndarray, shape (n, k)
            Updated in place.
        gaps : ndarray, shape (n, 2)
            Right and left, in initial gaps; updated in place.
        growth : ndarray, shape (n, 2)
            Gap growth per unit of dimensionless work; zero for no wear.
        periods : int
        trace : bool
            Whether to keep the tip's displacement at every step.

        Returns
        -------
        Record
        """

    def monodromy(self, system: Any, state: Array, gaps: Array, periods: int, /) -> Array:
        """Return how the states after whole periods of the force depend on the states now.

        Parameters
        ----------
        system : System
        state : ndarray, shape (n, k)
            At phase 0 of the force; not changed.
        gaps : ndarray, shape (n, 2)
            Constant, in initial gaps.
        periods : int

        Returns
        -------
        ndarray, shape (n, k, k)
            Derivative of each component after (rows) with respect to each before (columns).
        """
