"""A run-up of one vibrator, sampled on the way."""

import math

import numpy as np
from numpy.typing import NDArray

from models.vibrator.exact.measures import excursion, refine
from models.vibrator.start.regimes import BAND, COMPARABLE, wrapped

LAST = 1.0  # [s]


class Track:
    """A run-up sampled at equal intervals of time, up to the present.

    Parameters
    ----------
    state : ndarray
        The first sample.
    interval : float
        [s]
    look : int
        Largest number of intervals requested from `last`, if more than a second.

    Attributes
    ----------
    interval : float
        [s]
    count : int
        Samples after the first.
    excursion : float
        Largest displacement of C so far [m].
    neared : float
        When the displacement was last comparable to that [s].
    """

    def __init__(self, state: NDArray[np.float64], interval: float, look: int) -> None:
        self.interval = interval
        self.count = 0
        self.excursion = self.neared = 0.0
        self._second = math.ceil(LAST / interval)
        self._keep = max(self._second, look) + 1
        self._parts = [state[None].copy()]
        self._kept = 1
        self._angles = [self._angle(self._parts[0])]

    @staticmethod
    def _angle(states: NDArray[np.float64]) -> NDArray[np.float64]:
        rate = states.shape[1] // 2
        return np.stack([states[:, 3] - states[:, 4], states[:, rate + 3] - states[:, rate + 4]])

    def add(self, samples: NDArray[np.float64]) -> None:
        """Append samples."""
        joined = np.concatenate([self._parts[-1][-1:], samples])
        far = excursion(joined, self.interval)
        self.excursion = max(self.excursion, far)
        self.count += len(samples)
        self.neared = self.time if far > COMPARABLE * self.excursion else self.neared
        self._parts.append(samples)
        self._kept += len(samples)
        while self._kept - len(self._parts[0]) >= self._keep:
            self._kept -= len(self._parts.pop(0))
        self._angles.append(self._angle(samples))

    @property
    def time(self) -> float:
        """Time of the last sample [s]."""
        return self.count * self.interval

    def last(self, intervals: int = 0) -> NDArray[np.float64]:
        """Return the states at both ends of the last intervals; 0 for the last second."""
        wanted = (intervals or self._second) + 1
        first, available = len(self._parts), 0
        while first and available < wanted:
            first -= 1
            available += len(self._parts[first])
        return np.concatenate(self._parts[first:])[-wanted:]

    def last_time_off(self, mean: float) -> float:
        """Return when psi_1 - psi_2 was last outside the band about its mean, 0 if never.

        Excursions between two samples count.
        """
        angle, rate = np.concatenate(self._angles, axis=1)
        off = wrapped(angle - mean)
        out = np.abs(off) > BAND
        if out[-1]:
            return self.time
        # Unwrapped: both ends on the branch of the first.
        values = np.stack([off[:-1], off[:-1] + np.diff(angle)])
        rates = np.stack([rate[:-1], rate[1:]])
        returns = out[:-1].copy()
        turning = np.flatnonzero(~returns & (rates[0] * rates[1] < 0))
        gaps = refine(values[:, turning], rates[:, turning], self.interval)
        returns[turning] = np.abs(gaps).max(axis=1) > BAND
        if not returns.any():
            return 0.0
        i = np.flatnonzero(returns)[-1]
        gap = np.abs(wrapped(refine(values[:, i : i + 1], rates[:, i : i + 1], self.interval)[0]))
        k = np.flatnonzero(gap > BAND)[-1]
        part = (k + (gap[k] - BAND) / (gap[k] - gap[k + 1])) / (len(gap) - 1)
        return float(self.interval * (i + part))
