"""Continuous laws of an uncertain parameter; scipy.stats is imported only if a law needs it.

Each law is a small frozen table, as in a study file. Its distribution functions come from
`scipy.stats`, or for the most common laws from a subclass of `Elementary`, with the same bits.
`uq.sampling.listed_values` has the laws of listed values, `uq.sampling.laws` all laws.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import exp, log, log1p, pi, sqrt
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import scipy  # which imports scipy.special when it is first used
from pydantic import AfterValidator, ConfigDict, Field

from uq.errors import nearest
from uq.sampling.law import Law, Positive

_LOG_ROOT_2_PI = np.log(np.sqrt(2 * pi))


class Elementary(ABC):
    """Law of a function of a standard normal or standard uniform variable."""

    uniform: ClassVar[bool] = False

    @abstractmethod
    def score(self, x: Any) -> Any:
        """Return the standard score of each value."""

    @abstractmethod
    def value(self, z: Any) -> Any:
        """Return the value of each standard score."""

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
    """Normal law, by mean and standard deviation."""

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
    """Lognormal law, by median and standard deviation of the logarithm."""

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
    """Uniform law, by lower end and width."""

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
    """Log-uniform law between two ends."""

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


class Uniform(Law):
    """Uniform between two ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["uniform"]
    lower: float
    upper: float

    def frozen(self) -> Any:
        return UniformLaw(self.lower, self.upper - self.lower)


class LogUniform(Law):
    """Uniform in the logarithm between two positive ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["loguniform"]
    lower: Positive
    upper: Positive

    def frozen(self) -> Any:
        return LogUniformLaw(self.lower, self.upper)


class Normal(Law):
    """Normal law of a mean and a standard deviation."""

    distribution: Literal["normal"]
    mean: float
    sd: Positive

    def frozen(self) -> Any:
        return NormalLaw(self.mean, self.sd)


class TruncatedNormal(Law):
    """Normal law truncated to two ends; mean and sd are those before truncation."""

    _ascending = ("lower", "upper")

    distribution: Literal["truncated-normal"]
    mean: float
    sd: Positive
    lower: float
    upper: float

    def frozen(self) -> Any:
        return NormalLaw(self.mean, self.sd)

    @property
    def ends(self) -> tuple[float, float]:
        """Limits of the intersection of both truncations."""
        lower, upper = super().ends
        return max(lower, self.lower), min(upper, self.upper)


class LogNormal(Law):
    """Law whose logarithm is normal, by mean and cv or by median and sigma."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["mean", "cv"]}, {"required": ["median", "sigma"]}]
        }
    )

    either = (("mean", "cv"), ("median", "sigma"))
    pure = ("cv", "sigma")

    distribution: Literal["lognormal"]
    mean: Positive | None = None
    cv: Positive | None = Field(None, description="standard deviation over mean")
    median: Positive | None = None
    sigma: Positive | None = Field(None, description="standard deviation of the logarithm")

    def frozen(self) -> Any:
        if self.mean is not None and self.cv is not None:
            variance = log1p(self.cv * self.cv)
            return LogNormalLaw(exp(log(self.mean) - variance / 2), sqrt(variance))
        assert self.median is not None and self.sigma is not None
        return LogNormalLaw(self.median, self.sigma)


class Triangular(Law):
    """Triangular law between two ends."""

    _ascending = ("lower", "mode", "upper")

    distribution: Literal["triangular"]
    lower: float
    mode: float
    upper: float

    def frozen(self) -> Any:
        width = self.upper - self.lower
        return scipy.stats.triang(c=(self.mode - self.lower) / width, loc=self.lower, scale=width)

    def kinks(self) -> tuple[float, ...]:
        """Return the mode."""
        return (self.mode,)


class Pert(Law):
    """PERT law between two ends: a beta law of mean (lower + 4 mode + upper) / 6."""

    _ascending = ("lower", "mode", "upper")

    distribution: Literal["pert"]
    lower: float
    mode: float
    upper: float

    def frozen(self) -> Any:
        width = self.upper - self.lower
        return scipy.stats.beta(
            a=1 + 4 * (self.mode - self.lower) / width,
            b=1 + 4 * (self.upper - self.mode) / width,
            loc=self.lower,
            scale=width,
        )


class Beta(Law):
    """Beta law of two shapes, scaled to two ends."""

    _ascending = ("lower", "upper")
    pure = ("alpha", "beta")

    distribution: Literal["beta"]
    alpha: Positive
    beta: Positive
    lower: float
    upper: float

    def frozen(self) -> Any:
        return scipy.stats.beta(
            a=self.alpha, b=self.beta, loc=self.lower, scale=self.upper - self.lower
        )


class Weibull(Law):
    """Weibull law: P(X > x) = exp(-(x/scale)^shape)."""

    pure = ("shape",)

    distribution: Literal["weibull"]
    shape: Positive
    scale: Positive

    def frozen(self) -> Any:
        return scipy.stats.weibull_min(c=self.shape, scale=self.scale)


class Gamma(Law):
    """Gamma law of mean shape * scale and variance shape * scale^2."""

    pure = ("shape",)

    distribution: Literal["gamma"]
    shape: Positive
    scale: Positive

    def frozen(self) -> Any:
        return scipy.stats.gamma(a=self.shape, scale=self.scale)


class Gumbel(Law):
    """Gumbel law of maxima: P(X <= x) = exp(-exp(-(x - mode)/scale))."""

    distribution: Literal["gumbel"]
    mode: float
    scale: Positive

    def frozen(self) -> Any:
        return scipy.stats.gumbel_r(loc=self.mode, scale=self.scale)


class Exponential(Law):
    """Exponential law: P(X > x) = exp(-x/mean)."""

    distribution: Literal["exponential"]
    mean: Positive

    def frozen(self) -> Any:
        return scipy.stats.expon(scale=self.mean)


PAIRS = {
    "inconel-600/inconel-600": 1.2e-13,
    "inconel-600tt/inconel-600tt": 1.4e-15,
    "inconel-600/steel-405": 6.2e-14,
    "inconel-690/steel-405": 4.1e-16,
    "inconel-600/z10c13": 9.9e-14,
    "inconel-690/z6c13": 7.7e-15,
    "steel-304l/steel-304l-guide": 1e-14,
    "steel-304l-guide/steel-304l": 1.5e-14,
    "steel-316l/steel-304l": 1e-14,
    "steel-304l/steel-316l": 5e-15,
    "chromed/steel": 1e-16,
    "steel/chromed": 5e-14,
    "inconel-600/steel-304-cold-water": 9.3e-15,
    "inconel-690/steel-304-cold-water": 1.62e-14,
}
"""Worn body/counter-body -> wear coefficient [m2 N-1], as the data bank of Code_Aster states it."""


def _known_pair(pair: str) -> str:
    if pair not in PAIRS:
        problem = f"no such pair of materials{nearest(pair, PAIRS)}"
        raise ValueError(f"{problem} (worn body/counter-body: {', '.join(PAIRS)})")
    return pair


class WearCoefficient(Law):
    """Lognormal about the published wear coefficient of a pair of materials, never pooled."""

    unit: ClassVar[str] = "m2 N-1"
    pure = ("sigma", "share")

    distribution: Literal["wear-coefficient"]
    pair: Annotated[str, AfterValidator(_known_pair)] = Field(
        description="worn body/counter-body", json_schema_extra={"enum": list(PAIRS)}
    )
    sigma: Positive = Field(1.0, description="standard deviation of the logarithm; 1 is assumed")
    share: Positive = Field(
        1.0, description="wear per joule of impacts over that of sliding; 0.05 to 0.5 are plausible"
    )
    source: str = Field(
        "assumed: lognormal about the value of Code_Aster's data bank, of sliding work-rate",
        description="where the numbers come from; shown in every result",
    )

    def frozen(self) -> Any:
        """Return the law before truncation, of a coefficient in m2 N-1."""
        return LogNormalLaw(self.share * PAIRS[self.pair], self.sigma)
