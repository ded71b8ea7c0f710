"""Description of an FMU [1]_ [2]_, read by FMPy, and of the machine file that names it.

References
----------
.. [1] T. Blochwitz et al., "Functional Mockup Interface 2.0: The standard for tool independent
   exchange of simulation models", Proc. 9th Int. Modelica Conf., 173-184 (2012).
.. [2] A. Junghanns et al., "The Functional Mock-up Interface 3.0 - new features enabling new
   applications", Proc. 14th Int. Modelica Conf., 17-26 (2021).
"""

import re
from functools import cache
from math import inf
from pathlib import Path
from typing import Annotated, Any, Literal
from xml.etree.ElementTree import iterparse
from zipfile import ZipFile

from pydantic import Field, model_validator

from uq.contract import ROW_NAME
from uq.errors import InputError, described
from uq.files.whole_files import file_there
from uq.machines.machine_file import Headline, MachineName, Name, RowName, TomlTable, Uncertain

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class FmuTable(TomlTable):
    """``[machine]``: the FMU, and how long it is simulated."""

    name: MachineName
    fmu: Annotated[str, Field(min_length=1, description="file, beside this one")]
    title: str = ""
    version: str = "1"
    row_name: RowName = [*ROW_NAME]
    headline: Headline = []
    stop: Annotated[Positive | None, Field(description="end of the simulation [s]")] = None
    step: Annotated[Positive | None, Field(description="time between values [s]")] = None


class FmuParameterTable(TomlTable):
    """``[parameters.NAME]``: a parameter; omitted entries are taken from the FMU."""

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
    """A machine file of an FMU; the parameters and outputs of the FMU are the defaults."""

    machine: FmuTable
    parameters: dict[Name, FmuParameterTable] = {}
    outputs: dict[Name, FmuOutputTable] = {}
    uncertain: Uncertain = {}


_VERSIONS = re.compile(r"2\.0|3\.0(\.\d+)?")
_FLOATS = ("Real", "Float64", "Float32")  # of FMI 2, and of FMI 3
_UNBOUNDED = 1e300  # tools write such values for an infinite bound


def description_of(path: Path) -> Any:
    """Return the model description of an FMU, an `fmpy.model_description.ModelDescription`.

    Raises
    ------
    InputError
        When FMPy is not installed, or the file is no FMU that can be simulated here.
    """
    file_there(path)
    return _read(path, stamp_of(path))


def stamp_of(path: Path) -> tuple[int, int]:
    """Return modification time and size of a file, which change when it is written again."""
    status = path.stat()
    return status.st_mtime_ns, status.st_size


@cache
def _read(path: Path, stamp: tuple[int, int]) -> Any:
    try:
        import fmpy
    except ImportError:
        raise InputError(f"{path}: an FMU needs FMPy: pip install 'vibrolife[fmu]'") from None
    try:
        version = _version_of(path)  # FMPy also reads others, and complains about them
        if not _VERSIONS.fullmatch(version):
            raise InputError(f"{path}: is of FMI {version}, not 2.0 or 3.0; export it as such")
        description = fmpy.read_model_description(str(path), validate=False)
        platforms = fmpy.supported_platforms(str(path))
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path}: not an FMU: {described(error)}") from None
    if description.coSimulation is None and description.modelExchange is None:
        raise InputError(f"{path}: is neither for co-simulation nor for model exchange")
    if fmpy.platform not in platforms:
        available = ", ".join(sorted(platforms)) or "none"
        raise InputError(f"{path}: has no binary for {fmpy.platform} (there: {available})")
    return description


def _version_of(path: Path) -> str:
    """Return the version of FMI that an FMU is written for."""
    with ZipFile(path) as archive, archive.open("modelDescription.xml") as file:
        _, root = next(iterparse(file, ["start"]))
    return root.attrib["fmiVersion"]


def variables_of(description: Any, causality: str = "") -> dict[str, Any]:
    """Return the real scalars of an FMU by name, optionally of one causality only."""
    return {
        variable.name: variable
        for variable in description.modelVariables
        if variable.type in _FLOATS
        and not variable.dimensions
        and causality in ("", variable.causality)
    }


def arrays_of(description: Any) -> set[str]:
    """Return the names of the arrays of an FMU, which cannot be inputs or outputs."""
    return {variable.name for variable in description.modelVariables if variable.dimensions}


def times_of(
    description: Any, stop: float | None, step: float | None
) -> tuple[float, float, float]:
    """Return start, end and step of a simulation [s]: as requested, else defaults of the FMU.

    Raises
    ------
    ValueError
        When the FMU has no default end time, or does not support the step.
    """
    experiment = description.defaultExperiment

    def default(name: str) -> float | None:
        value = getattr(experiment, name, None)
        return None if value is None else float(value)

    start = default("startTime") or 0.0
    end = stop or default("stopTime")
    if end is None:
        raise ValueError("states no stop time; give stop in a machine file")
    if not end > start:
        raise ValueError(f"ends at {end:g} s, but starts at {start:g} s")
    how = description.coSimulation
    step = step or getattr(how, "fixedInternalStepSize", None) or default("stepSize")
    step = float(step or (end - start) / 1000)
    steps = (end - start) / step
    if how and not how.canHandleVariableCommunicationStepSize:
        if abs(steps - round(steps)) > 1e-6 * steps:
            raise ValueError(f"does whole steps of {step:g} s only; they do not end at {end:g} s")
    return start, end, min(step, end - start)


def bounds_of(variable: Any) -> tuple[float, float]:
    """Return the bounds of a variable."""
    ends = [_attribute(variable, name) for name in ("min", "max")]
    low, high = (
        inf if bound is None or abs(float(bound)) > _UNBOUNDED else float(bound) for bound in ends
    )
    return (-inf if low == inf else low), high


def unit_of_variable(variable: Any) -> str:
    """Return the unit of a variable as a CF string."""
    return cf_unit(_attribute(variable, "unit") or "1")


def _attribute(variable: Any, name: str) -> Any:
    """Return an attribute of a variable, by default that of its declared type."""
    value = getattr(variable, name)
    return getattr(variable.declaredType, name, None) if value is None else value


def cf_unit(unit: str) -> str:
    """Convert a Modelica unit to a CF string; other forms are returned unchanged.

    Examples
    --------
    >>> cf_unit("N.m/rad"), cf_unit("kg/(m.s2)"), cf_unit("1/s"), cf_unit("-")
    ('N m rad-1', 'kg m-1 s-2', 's-1', '1')
    """
    factors = []
    for place, part in enumerate(unit.strip().split("/")):
        for text in re.split(r"[.*]", part.strip().removeprefix("(").removesuffix(")")):
            match = re.fullmatch(r"([A-Za-z\u00b5\u03a9%]+)\^?(-?\d*)", text)
            if match:
                power = int(match[2] or 1) * (-1 if place else 1)
                factors.append(match[1] if power == 1 else f"{match[1]}{power}")
            elif text not in ("1", "-", ""):
                return unit
    return " ".join(factors) or "1"
