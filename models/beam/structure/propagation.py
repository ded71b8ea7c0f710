"""The interface of the beam's propagators, and their record."""

from collections.abc import Iterator
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Settings
from models.beam.structure.modal import Array, Beams
from models.numerics import propagator

LONGEST = 16_384
"""Forcing periods in a time mean, at most."""
FIRST_MODE = 0
"""Column of a state that displaces the tip in the first mode, in initial gaps."""


class Record(NamedTuple):
    """What a propagator records of some forcing periods of n beams.

    Attributes
    ----------
    work : ndarray, shape (n, periods, 2)
        Nondimensional impact work at the right and the left site in each period.
    strobe : ndarray, shape (n, periods, 2)
        Tip x and dx/d(Omega t) at the end of each period, in initial gaps.
    peak : ndarray, shape (n, 2)
        Largest penetration at each site, in initial gaps.
    trace : ndarray, shape (n, periods * steps)
        Tip displacement at every step, in initial gaps; empty unless requested.
    """

    work: Array
    strobe: Array
    peak: Array
    trace: Array

    @staticmethod
    def empty(n: int, periods: int, steps: int = 0) -> "Record":
        """Return a record to fill in."""
        return Record(
            np.zeros((n, periods, 2)),
            np.zeros((n, periods, 2)),
            np.zeros((n, 2)),
            np.zeros((n, periods * steps)),
        )


class System(Protocol):
    """n beams, prepared by a propagator."""

    @property
    def beams(self) -> Beams:
        """The same beams."""

    @property
    def free_reach(self) -> Array:
        """Bound of the tip's displacement without contact, in initial gaps, shape (n,)."""

    @property
    def steps(self) -> int:
        """Steps per forcing period."""

    @property
    def longest(self) -> int:
        """Forcing periods in a time mean, at most; not above `LONGEST`."""

    def take(self, rows: NDArray[np.intp], /) -> "System":
        """Return some of the beams."""


class Propagator(propagator.Propagator, Protocol):
    """The part of `models.numerics.propagator.Propagator` that is particular to the beam.

    `models.beam.lanes` and `models.beam.exact` implement it. Whole periods are those of the force.
    Results of a beam that cannot be followed any further are NaN.
    """

    CLOCK: int
    """Column of the state that counts forcing periods."""

    def groups(
        self, beams: Beams, settings: Settings, /
    ) -> Iterator[tuple[NDArray[np.intp], System]]:
        """Prepare n beams in groups."""

    def finer(
        self, system: Any, state: Array, /
    ) -> Iterator[tuple[NDArray[np.intp], System, Array]]:
        """Prepare the same beams for steps of half the size, in groups.

        Yields
        ------
        rows : ndarray of int
            Indices of the group's beams in the system.
        system : System
        state : ndarray, shape (n, k')
            Nearly the same as the given one.
        """

    def start(self, system: Any, displacement: Array, velocity: Array, /) -> Array:
        """Return the state at phase 0 of the force, with the tip displaced in the first mode.

        Parameters
        ----------
        system : System
        displacement, velocity : ndarray, shape (n,)
            Of the tip, in initial gaps and initial gaps per second.

        Returns
        -------
        ndarray, shape (n, k)
            In a form of the propagator's own, except for its first mode and its clock.
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
        """Advance n beams, whose gaps grow with the work done.

        Parameters
        ----------
        system, state
        gaps : ndarray, shape (n, 2)
            Right and left, in initial gaps; updated in place.
        growth : ndarray, shape (n, 2)
            Gap growth per unit of dimensionless work; zero for no wear.
        periods : int
        trace : bool
            Whether to record the tip's displacement at every step.

        Returns
        -------
        Record
        """

    def speeds(self, system: Any, state: Array, gaps: Array, trace: Array, /) -> Array:
        """Return the tip's dx/d(Omega t) at each sample of traces, shape (n, samples).

        Parameters
        ----------
        system : System
        state : ndarray, shape (n, k)
            At the start of the traces, at phase 0 of the force; not changed.
        gaps : ndarray, shape (n, 2)
            Constant.
        trace : ndarray, shape (n, samples)
            As recorded by `advance`.
        """

    def monodromy(self, system: Any, state: Array, gaps: Array, periods: int, /) -> Array:
        """Return the derivative of the state, shape (n, k, k), from phase 0 at constant gaps."""
