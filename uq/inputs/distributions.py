"""The laws an uncertain parameter can follow: names and arguments; scipy.stats does the rest.

Each law is a small frozen table as it stands in a study file, and names its `scipy.stats`
counterpart. `uq.inputs.observed` has those of listed values, `uq.inputs.registry` all of them.
"""

from math import exp, log, log1p, sqrt
from typing import Any, Literal

from pydantic import ConfigDict, Field

from uq.inputs.law import Law, Positive, Scipy


class Uniform(Law):
    """Equally likely everywhere between two ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["uniform"]
    lower: float
    upper: float

    def _scipy(self) -> Scipy:
        return "uniform", {"loc": self.lower, "scale": self.upper - self.lower}


class LogUniform(Law):
    """Equally likely in every octave between two positive ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["loguniform"]
    lower: Positive
    upper: Positive

    def _scipy(self) -> Scipy:
        return "loguniform", {"a": self.lower, "b": self.upper}


class Normal(Law):
    """Gaussian law of a mean and a standard deviation."""

    distribution: Literal["normal"]
    mean: float
    sd: Positive

    def _scipy(self) -> Scipy:
        return "norm", {"loc": self.mean, "scale": self.sd}


class TruncatedNormal(Law):
    """Gaussian law, with mean and sd before the cut, given that it falls between two ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["truncated-normal"]
    mean: float
    sd: Positive
    lower: float
    upper: float

    def _scipy(self) -> Scipy:
        return "truncnorm", {
            "a": (self.lower - self.mean) / self.sd,
            "b": (self.upper - self.mean) / self.sd,
            "loc": self.mean,
            "scale": self.sd,
        }

    def parent(self) -> tuple[Any, float, float]:
        """Return the normal law before the cut, and the ends of the cut."""
        from scipy import stats

        lower, upper = self.truncate or (self.lower, self.upper)
        return stats.norm(self.mean, self.sd), max(lower, self.lower), min(upper, self.upper)


class LogNormal(Law):
    """Law whose logarithm is Gaussian, by mean and cv or by median and sigma."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["mean", "cv"]}, {"required": ["median", "sigma"]}]
        }
    )

    either = (("mean", "cv"), ("median", "sigma"))

    distribution: Literal["lognormal"]
    mean: Positive | None = None
    cv: Positive | None = Field(None, description="standard deviation over mean")
    median: Positive | None = None
    sigma: Positive | None = Field(None, description="standard deviation of the logarithm")

    def _scipy(self) -> Scipy:
        if self.mean is not None and self.cv is not None:
            variance = log1p(self.cv * self.cv)
            return "lognorm", {"s": sqrt(variance), "scale": exp(log(self.mean) - variance / 2)}
        assert self.median is not None and self.sigma is not None
        return "lognorm", {"s": self.sigma, "scale": self.median}


class Triangular(Law):
    """Linear rise from one end to the mode, linear fall to the other."""

    _ascending = ("lower", "mode", "upper")

    distribution: Literal["triangular"]
    lower: float
    mode: float
    upper: float

    def _scipy(self) -> Scipy:
        width = self.upper - self.lower
        return "triang", {
            "c": (self.mode - self.lower) / width,
            "loc": self.lower,
            "scale": width,
        }


class Pert(Law):
    """Smooth bell between two ends: a beta law of mean (lower + 4 mode + upper) / 6."""

    _ascending = ("lower", "mode", "upper")

    distribution: Literal["pert"]
    lower: float
    mode: float
    upper: float

    def _scipy(self) -> Scipy:
        width = self.upper - self.lower
        return "beta", {
            "a": 1 + 4 * (self.mode - self.lower) / width,
            "b": 1 + 4 * (self.upper - self.mode) / width,
            "loc": self.lower,
            "scale": width,
        }


class Beta(Law):
    """Beta law of two shapes, stretched between two ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["beta"]
    alpha: Positive
    beta: Positive
    lower: float
    upper: float

    def _scipy(self) -> Scipy:
        return "beta", {
            "a": self.alpha,
            "b": self.beta,
            "loc": self.lower,
            "scale": self.upper - self.lower,
        }


class Weibull(Law):
    """Weibull law: P(X > x) = exp(-(x/scale)^shape)."""

    distribution: Literal["weibull"]
    shape: Positive
    scale: Positive

    def _scipy(self) -> Scipy:
        return "weibull_min", {"c": self.shape, "scale": self.scale}


class Gamma(Law):
    """Gamma law of mean shape * scale and variance shape * scale^2."""

    distribution: Literal["gamma"]
    shape: Positive
    scale: Positive

    def _scipy(self) -> Scipy:
        return "gamma", {"a": self.shape, "scale": self.scale}


class Gumbel(Law):
    """Law of largest values: P(X <= x) = exp(-exp(-(x - mode)/scale))."""

    distribution: Literal["gumbel"]
    mode: float
    scale: Positive

    def _scipy(self) -> Scipy:
        return "gumbel_r", {"loc": self.mode, "scale": self.scale}


class Exponential(Law):
    """Law without memory: P(X > x) = exp(-x/mean)."""

    distribution: Literal["exponential"]
    mean: Positive

    def _scipy(self) -> Scipy:
        return "expon", {"scale": self.mean}
