"""The laws of an uncertain parameter: names and arguments; scipy.stats does the rest.

Each law is a small frozen table, as in a study file, with its `scipy.stats` counterpart, or for the
most common ones with one of `uq.sampling.elementary_laws`.
`uq.sampling.listed_values` has the laws of listed values, `uq.sampling.laws` all laws.
"""

from math import exp, log, log1p, sqrt
from typing import Any, Literal

import scipy  # which imports scipy.stats when it is first used
from pydantic import ConfigDict, Field

from uq.sampling.elementary_laws import LogNormalLaw, LogUniformLaw, NormalLaw, UniformLaw
from uq.sampling.law import Law, Positive


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
        """The ends of both truncations."""
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
