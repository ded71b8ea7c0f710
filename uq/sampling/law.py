"""The base class of all laws of an uncertain parameter."""

from abc import abstractmethod
from math import inf
from typing import Annotated, Any, ClassVar, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from uq.errors import nearest
from uq.sampling.levels import LEVELS, OWN

Positive = Annotated[float, Field(gt=0)]

LIST = Field(strict=False)
"""Configuration of a tuple field: TOML has only lists, and the items stay strictly typed."""

STRICT = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False, defer_build=True)
"""Pydantic configuration of every table of a study file."""


def _known_level(level: str) -> str:
    if level not in LEVELS:
        raise ValueError(f"no such level{nearest(level, LEVELS)} (allowed: {', '.join(LEVELS)})")
    return level


Level = Annotated[str, AfterValidator(_known_level)]
LEVEL_SCHEMA: dict[str, Any] = {"enum": list(LEVELS)}
LEVEL_MEANING = ", ".join(f"{name}: {meaning}" for name, meaning in LEVELS.items())


class Law(BaseModel):
    """A law of one variable; arguments in the parameter's unit, unless they are `pure`."""

    model_config = STRICT

    _ascending: ClassVar[tuple[str, ...]] = ()
    discrete: ClassVar[bool] = False
    either: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Alternative sets of arguments; exactly one set is given."""
    pure: ClassVar[tuple[str, ...]] = ()
    """Arguments without a unit."""
    unit: ClassVar[str] = ""
    """The only unit of a parameter that the law suits; "" for any."""

    source: str = Field("", description="where the numbers come from; shown in every result")
    truncate: Annotated[tuple[float, float] | None, LIST] = Field(
        None, description="[lower, upper]: the law conditional on a value between them"
    )
    times: str | None = Field(
        None, description="another uncertain parameter; the law applies to its factor"
    )
    level: Level = Field(OWN, description=LEVEL_MEANING, json_schema_extra=LEVEL_SCHEMA)

    @abstractmethod
    def frozen(self) -> Any:
        """Return the law before truncation, with `cdf`, `sf`, `ppf`, `isf` and `logpdf`."""

    @property
    def ends(self) -> tuple[float, float]:
        """Lower and upper limit of the truncation.

        Quantiles of a truncated law are computed from the quantiles of the law before truncation,
        which is faster, and accurate in both tails.
        """
        return self.truncate or (-inf, inf)

    def kinks(self) -> tuple[float, ...]:
        """Return the interior points at which the density is not smooth."""
        return ()

    @model_validator(mode="after")
    def _check_arguments(self) -> Self:
        """Reject arguments in the wrong order, incomplete argument sets, and empty truncations."""
        names = self._ascending
        values = [getattr(self, name) for name in names]
        if values and (values != sorted(values) or values[0] == values[-1]):
            wanted = (" <= " if len(names) > 2 else " < ").join(names)
            given = ", ".join(f"{name} = {getattr(self, name)!r}" for name in names)
            raise ValueError(f"must have {wanted}: {given}")
        alternatives = {name for arguments in self.either for name in arguments}
        if alternatives and alternatives & self.model_fields_set not in map(set, self.either):
            name = vars(self)["distribution"]
            article = "an" if name[0] in "aeiou" else "a"
            choice = ", or ".join(" and ".join(arguments) for arguments in self.either)
            raise ValueError(f"{article} {name} law takes either {choice}")
        if self.truncate and not self.truncate[0] < self.truncate[1]:
            low, high = self.truncate
            raise ValueError(f"truncate must have lower < upper: [{low!r}, {high!r}]")
        return self
