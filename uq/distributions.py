"""The laws an uncertain parameter can follow: names and arguments; scipy.stats does the rest.

Each law is a small frozen table as it stands in a study file, and names its `scipy.stats`
counterpart. To add one: write the class, add it to `Law`, state its moments in the tests.
"""

from math import exp, inf, log, log1p, sqrt
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Positive = Annotated[float, Field(gt=0)]
Scipy = tuple[str, dict[str, float]]


class _Law(BaseModel):
    """A continuous law of one variable; arguments in the parameter's unit."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    _ascending: ClassVar[tuple[str, ...]] = ()

    source: str = Field("", description="where the numbers come from; shown in every result")

    def frozen(self) -> Any:
        """Return the law as a frozen `scipy.stats` distribution."""
        from scipy import stats

        name, arguments = self._scipy()
        return getattr(stats, name)(**arguments)

    def parent(self) -> tuple[Any, float, float]:
        """Return the frozen law before any truncation, and the ends of the truncation.

        Quantiles of a truncated law are best computed from its parent's: faster, and accurate in
        both tails.
        """
        return self.frozen(), -inf, inf

    def _scipy(self) -> Scipy:
        raise NotImplementedError

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        names = self._ascending
        values = [getattr(self, name) for name in names]
        if values and (values != sorted(values) or values[0] == values[-1]):
            wanted = " <= ".join(names) if len(names) > 2 else " < ".join(names)
            given = ", ".join(
                f"{name} = {value!r}" for name, value in zip(names, values, strict=True)
            )
            raise ValueError(f"must have {wanted}: {given}")
        return self


class Uniform(_Law):
    """Equally likely everywhere between two ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["uniform"]
    lower: float
    upper: float

    def _scipy(self) -> Scipy:
        return "uniform", {"loc": self.lower, "scale": self.upper - self.lower}


class LogUniform(_Law):
    """Equally likely in every octave between two positive ends."""

    _ascending = ("lower", "upper")

    distribution: Literal["loguniform"]
    lower: Positive
    upper: Positive

    def _scipy(self) -> Scipy:
        return "loguniform", {"a": self.lower, "b": self.upper}


class Normal(_Law):
    """Gaussian law of a mean and a standard deviation."""

    distribution: Literal["normal"]
    mean: float
    sd: Positive

    def _scipy(self) -> Scipy:
        return "norm", {"loc": self.mean, "scale": self.sd}


class TruncatedNormal(_Law):
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

        return stats.norm(self.mean, self.sd), self.lower, self.upper


class LogNormal(_Law):
    """Law whose logarithm is Gaussian, by mean and cv or by median and sigma."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["mean", "cv"]}, {"required": ["median", "sigma"]}]
        }
    )

    distribution: Literal["lognormal"]
    mean: Positive | None = None
    cv: Positive | None = Field(None, description="standard deviation over mean")
    median: Positive | None = None
    sigma: Positive | None = Field(None, description="standard deviation of the logarithm")

    @model_validator(mode="after")
    def _check_pair(self) -> Self:
        given = {"mean", "cv", "median", "sigma"} & self.model_fields_set
        if given not in ({"mean", "cv"}, {"median", "sigma"}):
            raise ValueError("a lognormal law takes either mean and cv, or median and sigma")
        return self

    def _scipy(self) -> Scipy:
        if self.mean is not None and self.cv is not None:
            variance = log1p(self.cv * self.cv)
            return "lognorm", {"s": sqrt(variance), "scale": exp(log(self.mean) - variance / 2)}
        assert self.median is not None and self.sigma is not None
        return "lognorm", {"s": self.sigma, "scale": self.median}


class Triangular(_Law):
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


class Beta(_Law):
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


class Weibull(_Law):
    """Weibull law: P(X > x) = exp(-(x/scale)^shape)."""

    distribution: Literal["weibull"]
    shape: Positive
    scale: Positive

    def _scipy(self) -> Scipy:
        return "weibull_min", {"c": self.shape, "scale": self.scale}


class Gamma(_Law):
    """Gamma law of mean shape * scale and variance shape * scale^2."""

    distribution: Literal["gamma"]
    shape: Positive
    scale: Positive

    def _scipy(self) -> Scipy:
        return "gamma", {"a": self.shape, "scale": self.scale}


Law = Annotated[
    Uniform
    | LogUniform
    | Normal
    | TruncatedNormal
    | LogNormal
    | Triangular
    | Beta
    | Weibull
    | Gamma,
    Field(discriminator="distribution"),
]
