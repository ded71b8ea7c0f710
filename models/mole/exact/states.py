"""What the exact propagator starts from, and what it returns."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class State(NamedTuple):
    """All that a mole's future depends on.

    Attributes
    ----------
    time : float
        Since the relay first closed [s].
    y : ndarray, shape (12,)
        See `models.mole.theory.equations`.
    contact : bool
        Whether the bar touches the stop.
    bar, mole : int
        How they slip: 1, -1, or 0 if they stick. At zero velocity a slip may just have begun.
    switched : int
        How often the relay has switched: it is closed if that is odd. It switches at multiples of
        half the control period, and a state at that instant is the one before.
    """

    time: float
    y: NDArray[np.float64]
    contact: bool
    bar: int
    mole: int
    switched: int


class Motion(NamedTuple):
    """How one mole moved.

    Attributes
    ----------
    status : int
        `REACHED_END`, `OUT_OF_BUDGET` or `STUCK`, of `models.numerics.dop853`.
    state : State
        The last.
    contacts : int
        Begun on the way.
    events : int
        All of them, switching included.
    lowest, highest : float
        Displacement u [m].
    steps : int
        Tried.
    samples : ndarray, shape (k, 12)
        At the times asked for, NaN from where the motion ended.
    """

    status: int
    state: State
    contacts: int
    events: int
    lowest: float
    highest: float
    steps: int
    samples: NDArray[np.float64]
