"""The interface of everything that advances machines in time.

A `Propagator` advances many machines at once: `models.beam.lanes`, `models.beam.exact`,
`models.vibrator.lanes`, `models.mole.lanes`. A `ReferencePropagator` follows one machine to any
tolerance: `models.vibrator.exact`, `models.mole.exact`. Any package or module with these functions
is one. `tests/models/test_propagators.py` checks what is stated here for all of them.
"""

from collections.abc import Iterator
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@runtime_checkable
class Propagator(Protocol):
    """Advances n machines at once, over whole periods of their drive.

    The motion of a machine depends only on its parameters, its state and its own arguments, to the
    bit: not on the other machines, their number or order, nor on earlier calls. A machine that
    cannot be followed affects no other and raises no exception.

    Arguments particular to a machine, such as growing gaps, follow those named here.
    """

    def groups(self, machines: Any, settings: Any, /) -> Iterator[tuple[NDArray[np.intp], Any]]:
        """Prepare n machines in groups that can be propagated together.

        Parameters
        ----------
        machines
            Their parameters, each field of shape (n, ...).
        settings
            The model's settings.

        Yields
        ------
        rows : ndarray of int
            Indices of the machines in the group. Each is in at most one group; one that the
            propagator cannot follow is in none.
        system
            These machines, prepared. Never modified; ``system.take(rows)`` selects some of them.
        """

    def start(self, system: Any, /, *args: Any) -> Array:
        """Return the initial state, shape (n, k), a new array owned by the caller.

        A row holds everything on which the future of its machine depends.
        """

    def advance(self, system: Any, state: Array, /, *args: Any, **kwargs: Any) -> Any:
        """Advance n machines, and return a record of their motion.

        Two calls reach the same state as one call over the same periods: to the bit for fixed steps
        and for exact propagation, to the tolerance for adaptive steps.

        Parameters
        ----------
        system
        state : ndarray, shape (n, k)
            Updated in place.
        """

    def monodromy(self, system: Any, state: Array, /, *args: Any, **kwargs: Any) -> Array:
        """Return the derivative of the state reached by `advance` with respect to this one.

        Parameters
        ----------
        system
        state : ndarray, shape (n, k)
            Not changed.

        Returns
        -------
        ndarray, shape (n, f, f)
            Derivatives of the first f components after (rows) with respect to those before
            (columns); zero for a component that cannot vary.
        """


@runtime_checkable
class ReferencePropagator(Protocol):
    """Follows one machine over any time, with an error that shrinks with the tolerance."""

    def start(self, params: Any, system: Any, /) -> Any:
        """Return the initial state of a machine.

        Parameters
        ----------
        params
            Each field a float.
        system
            The same machine, prepared.
        """

    def propagate(
        self, system: Any, state: Any, end: float, tolerance: float, /, *, times: ArrayLike = ()
    ) -> Any:
        """Follow one machine.

        Parameters
        ----------
        system
        state
            Not changed.
        end : float
            When to stop [s]. A state that does not contain its time is at time 0.
        tolerance : float
            Allowed error of a step, relative to the scales of the machine's motion.
        times : array_like, shape (k,)
            When to sample the state [s], ascending.

        Returns
        -------
        motion
            Its `status` is one of `models.numerics.dop853`, its `state` the last one; `samples`,
            shape (k, m), are NaN after the end of the motion. Continued from its last state, a
            machine moves as if it had never stopped, to the tolerance.
        """
