"""The common period of control and mains.

Only the square of the current acts on the bar, so the phase of the mains matters modulo half a
cycle.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

LONGEST = 40  # control periods
_CLOSE = 1e-9


def common_periods(control_frequency: Any, supply_frequency: Any) -> NDArray[np.int64]:
    """Return the common period of control and half a mains cycle.

    Parameters
    ----------
    control_frequency, supply_frequency : ndarray, shape (n,)
        [Hz]

    Returns
    -------
    ndarray of int, shape (n,)
        The smallest number of control periods, at most 40, that is a multiple of half a mains cycle
        to 1e-9; 0 if there is none.
    """
    cycles = 2 * np.asarray(supply_frequency, float) / np.asarray(control_frequency, float)
    periods = np.arange(1, LONGEST + 1)
    turns = np.multiply.outer(cycles, periods)
    whole = (np.abs(turns - np.round(turns)) <= _CLOSE * turns) & (np.round(turns) > 0)
    return np.where(whole.any(axis=-1), whole.argmax(axis=-1) + 1, 0)
