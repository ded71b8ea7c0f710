"""What carries machines through time, and what every such thing promises.

A machine offers one `Propagator` or two, which many rows of a study share, and may offer a
`Yardstick`, which follows one row as closely as asked. A package or module that has these functions
is one: nothing is registered or derived. `tests/models/test_propagators.py` holds all of them to
what is written here.
"""

from collections.abc import Iterator
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@runtime_checkable
class Propagator(Protocol):
    """Carries n machines side by side, over whole periods of what drives them.

    What happens to a machine depends on its parameters, its state and its own arguments alone, to
    the bit: not on the others, on their order or number, or on what was computed before. Nothing is
    kept between calls: all that a machine's future depends on stands in its row of the state. A
    machine that cannot be followed harms no other, and raises nothing.

    What else a machine needs (gaps that grow, where to stop) comes after the arguments named here.
    """

    def groups(self, machines: Any, settings: Any, /) -> Iterator[tuple[NDArray[np.intp], Any]]:
        """Prepare n machines, in groups that can be propagated together.

        Parameters
        ----------
        machines
            Their parameters, in a form that the machine chooses; each field of shape (n, ...).
        settings
            Numerical choices, those of the model.

        Yields
        ------
        rows : ndarray of int
            Which of the n machines are in the group: each in one at most, one that the propagator
            cannot follow in none.
        system
            These machines, prepared, and never changed; ``system.take(rows)`` returns some of them.
        """

    def start(self, system: Any, /, *args: Any) -> Array:
        """Return the state in which machines begin, shape (n, k); it belongs to the caller."""

    def advance(self, system: Any, state: Array, /, *args: Any, **kwargs: Any) -> Any:
        """Advance n machines, and return what was seen on the way.

        Advanced in parts, a machine comes where it comes in one go, to rounding or to the tolerance
        of its steps.

        Parameters
        ----------
        system
        state : ndarray, shape (n, k)
            Updated in place.
        """

    def monodromy(self, system: Any, state: Array, /, *args: Any, **kwargs: Any) -> Array:
        """Return how the state that `advance` reaches depends on the state now.

        Parameters
        ----------
        system
        state : ndarray, shape (n, k)
            Not changed.

        Returns
        -------
        ndarray, shape (n, f, f)
            Derivative of each of the first f components after (rows) with respect to each before
            (columns); zero by what has no freedom.
        """


@runtime_checkable
class Yardstick(Protocol):
    """Follows one machine over any time, with an error that shrinks with the tolerance."""

    def start(self, params: Any, system: Any, /) -> Any:
        """Return the state in which a machine begins.

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
            When to stop [s], on the clock of the state.
        tolerance : float
            Error allowed in a step, relative to the sizes of the machine's motion.
        times : array_like, shape (k,)
            Ascending, when to sample the state [s].

        Returns
        -------
        motion
            With `status`, of `models.numerics.dop853`; `state`, the last; `samples`, shape (k, m),
            NaN from where the motion ended. From its last state the machine goes on as if it had
            never stopped, to the tolerance.
        """
