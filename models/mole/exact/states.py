"""States and motions of the exact propagator."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class State(NamedTuple):
    """Everything on which a mole's future depends.

    Attributes
    ----------
    time : float
        Since the relay first closed [s].
    y : ndarray, shape (12,) or (15,)
        See `models.mole.theory.equations`; the longer one of a mole with soil ahead.
    contact : bool
        Whether the bar touches the stop.
    bar, mole : int
        Direction of slip: 1, -1, or 0 if they stick. At zero velocity a slip may just have begun.
    switched : int
        How often the relay has switched; it is closed if this is odd. It switches at multiples of
        half the control period, and a state at such an instant is the one before.
    soil : int
        Mode of the soil; see `models.mole.theory.soil`.
    """

    time: float
    y: NDArray[np.float64]
    contact: bool
    bar: int
    mole: int
    switched: int
    soil: int = 0


class Motion(NamedTuple):
    """The motion of one mole.

    Attributes
    ----------
    status : int
        `REACHED_END`, `OUT_OF_BUDGET` or `STUCK`, of `models.numerics.dop853`.
    state : State
        The last one.
    contacts : int
        Contacts begun.
    events : int
        All events, including switching.
    lowest, highest : float
        Displacement u [m].
    steps : int
        Steps tried.
    samples : ndarray, shape (k, 12) or (k, 15)
        At `times`; NaN after the end of the motion.
    """

    status: int
    state: State
    contacts: int
    events: int
    lowest: float
    highest: float
    steps: int
    samples: NDArray[np.float64]
