"""Normal and uniform laws of a quantity or of its logarithm.

They have the methods of `scipy.stats` that are used here, and their bits, but not the import of
`scipy.stats`, which takes longer than most commands.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any, ClassVar

import numpy as np
import scipy  # which imports scipy.special when it is first used

_LOG_ROOT_2_PI = np.log(np.sqrt(2 * pi))


class Elementary(ABC):
    """A law whose values are a function of a standard normal or standard uniform variable."""

    uniform: ClassVar[bool] = False

    @abstractmethod
    def score(self, x: Any) -> Any:
        """Return the standard variable of values."""

    @abstractmethod
    def value(self, z: Any) -> Any:
        """Return the values of the standard variable."""

    @abstractmethod
    def logpdf(self, x: Any) -> Any:
        """Return the logarithm of the density."""

    def cdf(self, x: Any) -> Any:
        """Return P(X <= x)."""
        z = self.score(x)
        return np.clip(z, 0.0, 1.0) if self.uniform else scipy.special.ndtr(z)

    def sf(self, x: Any) -> Any:
        """Return P(X > x)."""
        return 1.0 - self.cdf(x) if self.uniform else scipy.special.ndtr(-self.score(x))

    def ppf(self, p: Any) -> Any:
        """Return the value with P(X <= value) = p, for p in (0, 1)."""
        return self.value(p if self.uniform else scipy.special.ndtri(p))

    def isf(self, q: Any) -> Any:
        """Return the value with P(X > value) = q, for q in (0, 1)."""
        return self.value(1.0 - q if self.uniform else -scipy.special.ndtri(q))


@dataclass(frozen=True)
class NormalLaw(Elementary):
    """Normal law of a mean and a standard deviation."""

    mean: float
    sd: float

    def score(self, x: Any) -> Any:
        return (x - self.mean) / self.sd

    def value(self, z: Any) -> Any:
        return z * self.sd + self.mean

    def logpdf(self, x: Any) -> Any:
        return -(self.score(x) ** 2) / 2.0 - _LOG_ROOT_2_PI - np.log(self.sd)


@dataclass(frozen=True)
class LogNormalLaw(Elementary):
    """Law whose logarithm is normal, of a median and the logarithm's standard deviation."""

    median: float
    sigma: float

    def score(self, x: Any) -> Any:
        with np.errstate(divide="ignore"):
            return np.log(np.maximum(np.divide(x, self.median), 0.0)) / self.sigma

    def value(self, z: Any) -> Any:
        return np.exp(self.sigma * z) * self.median

    def logpdf(self, x: Any) -> Any:
        y = np.divide(x, self.median)
        with np.errstate(divide="ignore", invalid="ignore"):
            density = -(np.log(y) ** 2) / (2 * self.sigma**2)
            density = density - np.log(self.sigma * y * sqrt(2 * pi)) - np.log(self.median)
        return np.where(y > 0, density, -np.inf)[()]


@dataclass(frozen=True)
class UniformLaw(Elementary):
    """Uniform law of a lower end and a width."""

    uniform = True

    lower: float
    width: float

    def score(self, x: Any) -> Any:
        return (x - self.lower) / self.width

    def value(self, z: Any) -> Any:
        return z * self.width + self.lower

    def logpdf(self, x: Any) -> Any:
        z = self.score(x)
        return np.where((z >= 0) & (z <= 1), -np.log(self.width), -np.inf)[()]


@dataclass(frozen=True)
class LogUniformLaw(Elementary):
    """Law whose logarithm is uniform, between two ends."""

    uniform = True

    lower: float
    upper: float

    def score(self, x: Any) -> Any:
        inside = np.clip(x, self.lower, self.upper)
        return (np.log(inside) - np.log(self.lower)) / self._range

    def value(self, z: Any) -> Any:
        return np.exp(np.log(self.lower) + z * self._range)

    def logpdf(self, x: Any) -> Any:
        inside = np.clip(x, self.lower, self.upper)
        return np.where(inside == x, -np.log(inside) - np.log(self._range), -np.inf)[()]

    @property
    def _range(self) -> Any:
        return np.log(self.upper) - np.log(self.lower)
