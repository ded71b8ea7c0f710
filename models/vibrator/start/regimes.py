"""The outcome of switching on n machines, whichever propagator computes it."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.parameters import REGIMES

LOCKED_0, LOCKED_PI, ASYNCHRONOUS, CAPTURED, STALLED = range(len(REGIMES))

STALLED_BELOW = 0.05  # of the synchronous speed
CAPTURED_BELOW = 0.8
BAND = 0.05  # of the disphasing angle about its mean, when synchronised [rad]
COMPARABLE = 0.75  # fraction of the largest displacement that may, at another phase, exceed it


class Outcome(NamedTuple):
    """The steady state that n machines reach, and the way to it.

    Attributes
    ----------
    disphasing, multiplier : ndarray, shape (n,)
        Mean of psi_1 - psi_2 [rad] and largest Floquet multiplier; NaN unless locked.
    angular_amplitude, stroke_left, stroke_right : ndarray, shape (n,)
        [rad, m, m]
    speed, power_1, power_2 : ndarray, shape (n,)
        [rad s-1, W, W]
    synchronisation_time : ndarray, shape (n,)
        [s]; infinite where they do not lock, the time simulated where this is unknown.
    censored : ndarray of bool, shape (n,)
        Where it is unknown.
    max_excursion : ndarray, shape (n,)
        [m]
    regime : ndarray of int8, shape (n,)
        Index into `REGIMES`, -1 if unknown.
    on_the_way : ndarray, shape (n, T, 3)
        psi_1 - psi_2 [rad] and the speeds of both vibrators [rad s-1] at the instants.
    """

    disphasing: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    angular_amplitude: NDArray[np.float64]
    stroke_left: NDArray[np.float64]
    stroke_right: NDArray[np.float64]
    speed: NDArray[np.float64]
    power_1: NDArray[np.float64]
    power_2: NDArray[np.float64]
    synchronisation_time: NDArray[np.float64]
    censored: NDArray[np.bool_]
    max_excursion: NDArray[np.float64]
    regime: NDArray[np.int8]
    on_the_way: NDArray[np.float64]

    @staticmethod
    def nothing(n: int, instants: int = 0) -> "Outcome":
        """Return the outcome of n machines before they are run: unknown."""
        defaults = {
            "censored": np.zeros(n, bool),
            "regime": np.full(n, -1, np.int8),
            "on_the_way": np.full((n, instants, 3), np.nan),
        }
        return Outcome(**{name: defaults.get(name, np.full(n, np.nan)) for name in Outcome._fields})


def wrapped(angle: Any) -> Any:
    """Return an angle in (-pi, pi]."""
    return np.pi - np.mod(np.pi - angle, 2 * np.pi)


def locked_regime(disphasing: NDArray[np.float64]) -> NDArray[np.int8]:
    """Return the regime of locked machines."""
    return np.where(np.abs(disphasing) < np.pi / 2, LOCKED_0, LOCKED_PI).astype(np.int8)


def unlocked_regime(
    speed_1: NDArray[np.float64],
    speed_2: NDArray[np.float64],
    synchronous_1: NDArray[np.float64],
    synchronous_2: NDArray[np.float64],
) -> NDArray[np.int8]:
    """Return the regime of unlocked machines from their mean speeds."""
    slower = np.minimum(speed_1 / synchronous_1, speed_2 / synchronous_2)
    regime = np.where(slower < CAPTURED_BELOW, CAPTURED, ASYNCHRONOUS)
    return np.where(slower < STALLED_BELOW, STALLED, regime).astype(np.int8)
