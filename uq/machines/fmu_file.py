"""A machine file that names an FMU: its varied parameters, and outputs from its variables."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from uq.machines.machine_file import MachineName, Name, TomlTable

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class FmuTable(TomlTable):
    """``[machine]``: the FMU, and how long it is simulated."""

    name: MachineName
    fmu: Annotated[str, Field(min_length=1, description="file, beside this one")]
    title: str = ""
    version: str = "1"
    stop: Annotated[Positive | None, Field(description="end of the simulation [s]")] = None
    step: Annotated[Positive | None, Field(description="time between values [s]")] = None


class FmuParameterTable(TomlTable):
    """``[parameters.NAME]``: a parameter; what is left out is as the FMU says."""

    variable: Annotated[str, Field(description="by default NAME")] = ""
    nominal: float | None = None
    unit: str = ""
    bounds: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    meaning: str = ""
    source: str = ""


class FmuOutputTable(TomlTable):
    """``[outputs.NAME]``: a variable at the end, reduced over time, or when it reaches a level."""

    variable: Annotated[str, Field(description="by default NAME")] = ""
    unit: str = ""
    meaning: str = ""
    over_time: Literal["end", "max", "min", "mean"] = "end"
    above: Annotated[float | None, Field(description="a life: it ends at this level")] = None
    below: Annotated[float | None, Field(description="a life: it ends at this level")] = None

    @property
    def is_life(self) -> bool:
        """Whether it is the time at which the variable first reaches a level."""
        return self.above is not None or self.below is not None

    @property
    def level(self) -> tuple[float, float]:
        """The level that ends the life, and 1 where it is reached from below, else -1."""
        return (self.below or 0.0, -1.0) if self.above is None else (self.above, 1.0)

    @model_validator(mode="after")
    def _one_way(self) -> "FmuOutputTable":
        given = {"over_time", "above", "below"} & self.model_fields_set
        if len(given) > 1:
            raise ValueError("give one of over_time, above and below")
        if self.is_life and self.unit not in ("", "s"):
            raise ValueError("the time at which a level is reached is in s")
        return self


class FmuFile(TomlTable):
    """A machine file of an FMU; without parameters or outputs those that the FMU declares."""

    machine: FmuTable
    parameters: dict[Name, FmuParameterTable] = {}
    outputs: dict[Name, FmuOutputTable] = {}
