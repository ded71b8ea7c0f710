"""An FMU as a machine: each row simulates a separate instance."""

import hashlib
import keyword
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from uq.contract import Floats, Model, Parameter, Status
from uq.errors import InputError, one_line
from uq.machines.fmu_description import (
    FmuFile,
    FmuOutputTable,
    FmuParameterTable,
    FmuTable,
    arrays_of,
    bounds_of,
    description_of,
    stamp_of,
    times_of,
    unit_of_variable,
    variables_of,
)
from uq.machines.machine_file import content_of, read_as, refuse
from uq.machines.returned import Censored, Returned, RowError, censored, checked
from uq.machines.row_by_row import RowByRow, model_from
from uq.machines.row_resources import Folders
from uq.machines.study_defaults import StudyDefaults
from uq.sampling.input_faults import InputFault, unknown

_LOG, _UNPACKED = "log.txt", "fmu"
_DISCARDED, _FATAL = 2, 4  # statuses of FMI
_NEAR = 1e-9


class FmuError(Exception):
    """A simulation that failed, in a sentence."""


def fmu_of(path: Path) -> Model:
    """Return the model of an FMU, or of a machine file that names one.

    Raises
    ------
    InputError
        When FMPy is not installed, or one of the files cannot be used.
    """
    file, fmu = _read(path)
    description = description_of(fmu)
    reals = variables_of(description)
    settable = variables_of(description, "parameter")
    parameters = file.parameters or _declared(path, settable, FmuParameterTable)
    outputs = file.outputs or _declared(path, variables_of(description, "output"), FmuOutputTable)
    machine = file.machine
    refuse(path, _faults(parameters, outputs, reals, arrays_of(description)))
    try:
        times = times_of(description, machine.stop, machine.step)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    fields = {name: _field(name, parameter, reals) for name, parameter in parameters.items()}
    returned = {name: _returned(name, output, reals) for name, output in outputs.items()}
    inputs = {name: parameter.variable or name for name, parameter in parameters.items()}
    folders = Folders(path.absolute().parent / f"{machine.name}.rows", _UNPACKED)
    runner = _Fmu(fmu, stamp_of(fmu), inputs, outputs, returned, times, folders)
    batch = RowByRow(runner, tuple(fields), returned, False, folders.leave, folders.keep, False)
    title = machine.title or description.description or description.modelName
    about = machine.name, title, machine.version
    return model_from(*about, fields, returned, batch, False, StudyDefaults.of_file(file))


def code_of_fmu(path: Path) -> str:
    """Return a hash of an FMU, of the machine file that names it, and of the version of FMPy."""
    import fmpy

    whole = hashlib.sha256(fmpy.__version__.encode())
    if path.suffix == ".toml":
        whole.update(content_of(path))
    _, fmu = _read(path)
    whole.update(fmu.read_bytes())
    return whole.hexdigest()[:16]


def _read(path: Path) -> tuple[FmuFile, Path]:
    """Return the machine file (a default one for a bare FMU) and the path of the FMU."""
    if path.suffix == ".toml":
        file = read_as(FmuFile, path)
        return file, path.absolute().parent / file.machine.fmu
    description = description_of(path)
    table = FmuTable(
        name=_as_name(description.modelName), fmu=path.name, version=f"FMI {description.fmiVersion}"
    )
    return FmuFile(machine=table), path.absolute()


def _as_name(variable: str) -> str:
    """Return a variable such as ``spring.k[1]`` as a name: ``spring_k_1``."""
    name = re.sub(r"\W+", "_", variable, flags=re.ASCII).strip("_")
    if keyword.iskeyword(name):
        return f"{name}_"
    return name if name.isidentifier() else f"x{name}"


def _declared(path: Path, variables: Iterable[str], kind: Any) -> dict[str, Any]:
    tables: dict[str, Any] = {}
    for variable in variables:
        name = _as_name(variable)
        if name in tables:
            both = f"'{tables[name].variable}' and '{variable}'"
            raise InputError(f"{path}: {both} would both be '{name}'; name them in a machine file")
        tables[name] = kind(variable=variable)
    return tables


def _faults(
    parameters: Mapping[str, FmuParameterTable],
    outputs: Mapping[str, FmuOutputTable],
    reals: Mapping[str, Any],
    arrays: Collection[str],
) -> Iterator[InputFault]:
    settable = [name for name, real in reals.items() if real.causality in ("parameter", "input")]
    for table, tables, allowed in (
        ("parameters", parameters, settable),
        ("outputs", outputs, reals),
    ):
        if not tables:
            yield InputFault(
                (table,), f"the FMU declares none; name its variables in [{table}.NAME]"
            )
        for name, entry in tables.items():
            variable = entry.variable or name
            if variable not in allowed:
                kind = "parameter of the FMU" if table == "parameters" else "variable of the FMU"
                problem = unknown(kind, variable, allowed)
                if variable in arrays:
                    problem = "is an array; let the FMU declare its elements as scalars"
                yield InputFault((table, name, "variable"), problem, variable)
    for name, given in parameters.items():
        real = reals.get(given.variable or name)
        if real is not None and given.nominal is None and real.start is None:
            yield InputFault((*("parameters", name), "nominal"), "is missing, and the FMU has none")


def _field(
    name: str, parameter: FmuParameterTable, reals: Mapping[str, Any]
) -> tuple[Parameter, float]:
    variable = reals[parameter.variable or name]
    nominal = float(variable.start) if parameter.nominal is None else parameter.nominal
    bounds = (
        bounds_of(variable)
        if parameter.bounds is None
        else (parameter.bounds[0], parameter.bounds[1])
    )
    meaning = parameter.meaning or variable.description or name.replace("_", " ")
    source = parameter.source or "assumed: the start value of the FMU"
    unit = parameter.unit or unit_of_variable(variable)
    return Parameter(name, unit, " ".join(meaning.split()), bounds, source), nominal


def _returned(name: str, output: FmuOutputTable, reals: Mapping[str, Any]) -> Returned:
    variable = reals[output.variable or name]
    description = " ".join((variable.description or variable.name).split())
    if output.is_life:
        level, sign = output.level
        way = "above" if sign > 0 else "below"
        return Returned(
            "s", output.meaning or f"time until {description} is {way} {level:g}", life=True
        )
    words = {"end": "", "max": "largest ", "min": "smallest ", "mean": "mean "}[output.over_time]
    return Returned(
        output.unit or unit_of_variable(variable), output.meaning or f"{words}{description}"
    )


@dataclass(frozen=True)
class _Fmu:
    """Simulator of a row.

    Attributes
    ----------
    path : Path
    stamp : tuple of int
        `stamp_of` the file that was read.
    inputs : dict of str to str
        Parameter -> variable.
    outputs : dict of str to FmuOutputTable
    returned : dict of str to Returned
    times : tuple of float
        Start, end and step [s].
    folders : Folders
    """

    path: Path
    stamp: tuple[int, int]
    inputs: Mapping[str, str]
    outputs: Mapping[str, FmuOutputTable]
    returned: Mapping[str, Returned]
    times: tuple[float, float, float]
    folders: Folders

    def __call__(self, **row: float) -> dict[str, float | Censored]:
        """Simulate a row; return its outputs.

        Raises
        ------
        FmuError, RowError
        """
        with self.folders.row(list(row.values())) as folder:
            os.chdir(folder)  # where it may write; the caller leaves it
            log = list[str]()
            try:
                history = self._history(folder / _UNPACKED, row, log)
                outputs = {
                    name: reduced(output, history["time"], history[output.variable or name])
                    for name, output in self.outputs.items()
                }
                list(checked(outputs, self.returned))  # here: the folder of a failed row is kept
                return outputs
            except Exception as error:
                (folder / _LOG).write_text("\n".join(log), encoding="utf-8")
                text = one_line(error) + (f" ({log[-1]})" if log else "")
                if isinstance(error, RowError) and error.status == Status.NON_FINITE:
                    raise RowError(text, error.status) from None
                raise FmuError(text) from None

    def _history(self, unpacked: Path, row: Mapping[str, float], log: list[str]) -> Any:
        """Return the time history of the requested variables, from an FMU unpacked for this row.

        A library in a file of its own shares no memory with that of another row.
        """
        import fmpy
        from fmpy.simulation import instantiate_fmu, simulate_fmu

        def logger(*arguments: Any) -> None:
            *_, status, _, text = arguments
            if status >= _DISCARDED:
                log.append(" ".join(text.decode(errors="replace").split()))

        if stamp_of(self.path) != self.stamp:
            raise FmuError("the file was changed after the run began")
        description, (start, stop, step) = description_of(self.path), self.times
        places = [f"binaries/{name}/" for name in (fmpy.platform, fmpy.platform_tuple)]
        wanted = "modelDescription.xml", "resources/", *places
        fmpy.extract(str(self.path), str(unpacked), include=lambda name: name.startswith(wanted))
        instance = instantiate_fmu(str(unpacked), description, logger=logger)
        fatal = False
        try:
            history = simulate_fmu(
                str(unpacked),
                start_time=start,
                stop_time=stop,
                output_interval=step,
                start_values={self.inputs[name]: value for name, value in row.items()},
                output=list(
                    dict.fromkeys(output.variable or n for n, output in self.outputs.items())
                ),
                model_description=description,
                fmu_instance=instance,
            )
        except Exception as error:
            fatal = getattr(error, "status", None) == _FATAL
            raise
        finally:
            if not fatal:  # after which nothing of the FMU may be called
                instance.freeInstance()
        ended = history["time"][-1]
        if ended < stop - _NEAR * (stop - start):
            raise FmuError(f"the FMU ended the simulation at {ended:g} s, before {stop:g} s")
        return history


def reduced(output: FmuOutputTable, time: Floats, values: Floats) -> float | Censored:
    """Return an output from the history of its variable.

    Parameters
    ----------
    output : FmuOutputTable
    time : ndarray, shape (k,)
        [s]; the same twice at an event.
    values : ndarray, shape (k,)

    Returns
    -------
    float or Censored
        For a life, the time from the start until the variable reaches its level, interpolated
        between two values; a lower bound if it does not. NaN if a value is not finite.
    """
    values = np.asarray(values, float)
    if not np.isfinite(values).all():
        return nan
    if not output.is_life:
        mean = np.trapezoid(values, time) / (time[-1] - time[0])
        reductions = {"end": values[-1], "max": values.max(), "min": values.min(), "mean": mean}
        return float(reductions[output.over_time])
    level, sign = output.level
    beyond = sign * (values - level)
    if not (beyond >= 0).any():
        return censored(time[-1] - time[0])
    i = int(np.argmax(beyond >= 0))
    if i == 0:
        return 0.0
    share = beyond[i - 1] / (beyond[i - 1] - beyond[i])
    return float(time[i - 1] + share * (time[i] - time[i - 1]) - time[0])
