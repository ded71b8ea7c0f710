"""What takes machines through time, and what each such thing promises.

A `Propagator` takes many machines along at once: `models.beam.lanes`, `models.beam.exact`,
`models.vibrator.lanes`, `models.mole.lanes`. A `Yardstick` follows one machine as closely as asked:
`models.vibrator.exact`, `models.mole.exact`. Any package or module with these functions is one.
`tests/models/test_propagators.py` holds all of them to these promises.
"""

from collections.abc import Iterator
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@runtime_checkable
class Propagator(Protocol):
    """Takes n machines along at once, over whole periods of what drives them.

    What a machine does depends on its parameters, its state and its own arguments alone, to the
    bit: not on the other machines, nor on their number or order, nor on earlier calls. A machine
    that cannot be followed affects no other and raises nothing.

    Arguments of one machine only, such as gaps that grow, follow those named here.
    """

    def groups(self, machines: Any, settings: Any, /) -> Iterator[tuple[NDArray[np.intp], Any]]:
        """Prepare n machines, in groups that can be propagated together.

        Parameters
        ----------
        machines
            Their parameters, each field of shape (n, ...).
        settings
            Those of the model.

        Yields
        ------
        rows : ndarray of int
            Which of the n machines are in the group. Each is in one group at most; one that the
            propagator cannot follow is in none.
        system
            These machines, prepared. It is never changed; ``system.take(rows)`` returns some of
            them.
        """

    def start(self, system: Any, /, *args: Any) -> Array:
        """Return the initial state, shape (n, k), a new array that belongs to the caller.

        Row by row it is all that the future of a machine depends on.
        """

    def advance(self, system: Any, state: Array, /, *args: Any, **kwargs: Any) -> Any:
        """Advance n machines, and return a record of the way.

        Two calls lead where one call over the same periods leads: to the bit for fixed steps and
        for exact propagation, to the tolerance where steps are chosen anew.

        Parameters
        ----------
        system
        state : ndarray, shape (n, k)
            Updated in place.
        """

    def monodromy(self, system: Any, state: Array, /, *args: Any, **kwargs: Any) -> Array:
        """Return the derivative of the state that `advance` reaches, by the state now.

        Parameters
        ----------
        system
        state : ndarray, shape (n, k)
            Not changed.

        Returns
        -------
        ndarray, shape (n, f, f)
            Of each of the first f components after (rows) by each before (columns); zero by a
            component that cannot vary.
        """


@runtime_checkable
class Yardstick(Protocol):
    """Follows one machine over any time; its error shrinks with the tolerance."""

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
            When to stop [s]. A state that does not hold its time stands at 0.
        tolerance : float
            Error allowed in a step, relative to the sizes of the machine's motion.
        times : array_like, shape (k,)
            Ascending, when to sample the state [s].

        Returns
        -------
        motion
            Its `status` is one of `models.numerics.dop853`, its `state` the last one; `samples`,
            shape (k, m), are NaN from where the motion ended. Followed on from its last state, a
            machine moves as if it had never stopped, to the tolerance.
        """
