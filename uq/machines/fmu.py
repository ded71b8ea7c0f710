"""An FMU as a machine: each row simulates an instance of its own."""

import hashlib
import keyword
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from uq.contract import Floats, Model, Parameter
from uq.errors import InputError, one_line
from uq.machines.fmu_description import (
    bounds_of,
    said_of,
    stamp_of,
    times_of,
    unit_of_variable,
    variables_of,
)
from uq.machines.fmu_file import FmuFile, FmuOutputTable, FmuParameterTable, FmuTable, read_fmu_file
from uq.machines.machine_file import content_of, refuse
from uq.machines.returned import Censored, NonFiniteError, Returned, censored, checked
from uq.machines.row_by_row import RowByRow, model_from
from uq.machines.row_folders import Folders
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
    file = _file(path)
    fmu = _fmu(path, file)
    said = said_of(fmu)
    reals = variables_of(said)
    settable = variables_of(said, "parameter")
    parameters = file.parameters or _declared(path, settable, FmuParameterTable)
    outputs = file.outputs or _declared(path, variables_of(said, "output"), FmuOutputTable)
    machine = file.machine
    refuse(path, _faults(parameters, outputs, reals))
    try:
        times = times_of(said, machine.stop, machine.step)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    fields = {name: _field(name, one, reals) for name, one in parameters.items()}
    returned = {name: _returned(name, one, reals) for name, one in outputs.items()}
    inputs = {name: one.variable or name for name, one in parameters.items()}
    folders = Folders(path.absolute().parent / f"{machine.name}.rows", _UNPACKED)
    runner = _Fmu(fmu, stamp_of(fmu), inputs, outputs, returned, times, folders)
    batch = RowByRow(runner, tuple(fields), returned, False, folders.leave, folders.keep, False)
    title = machine.title or said.description or said.modelName
    return model_from(machine.name, title, machine.version, fields, returned, batch, False)


def code_of_fmu(path: Path) -> str:
    """Return a hash of an FMU, of the machine file that names it, and of the version of FMPy."""
    import fmpy

    whole = hashlib.sha256(fmpy.__version__.encode())
    if path.suffix == ".toml":
        whole.update(content_of(path))
    whole.update(_fmu(path, _file(path)).read_bytes())
    return whole.hexdigest()[:16]


def _file(path: Path) -> FmuFile:
    if path.suffix == ".toml":
        return read_fmu_file(path)
    said = said_of(path)
    table = FmuTable(name=_as_name(said.modelName), fmu=path.name, version=f"FMI {said.fmiVersion}")
    return FmuFile(machine=table)


def _fmu(path: Path, file: FmuFile) -> Path:
    return path.absolute().parent / file.machine.fmu


def _as_name(variable: str) -> str:
    """Return a variable such as ``spring.k[1]`` as a name: ``spring_k_1``."""
    name = re.sub(r"\W+", "_", variable, flags=re.ASCII).strip("_")
    if keyword.iskeyword(name):
        return f"{name}_"
    return name if name.isidentifier() else f"x{name}"


def _declared(path: Path, variables: Iterable[str], kind: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in variables:
        name = _as_name(one)
        if name in found:
            both = f"'{found[name].variable}' and '{one}'"
            raise InputError(f"{path}: {both} would both be '{name}'; name them in a machine file")
        found[name] = kind(variable=one)
    return found


def _faults(
    parameters: Mapping[str, FmuParameterTable],
    outputs: Mapping[str, FmuOutputTable],
    reals: Mapping[str, Any],
) -> Iterator[InputFault]:
    settable = [name for name, one in reals.items() if one.causality in ("parameter", "input")]
    for table, tables, known in (("parameters", parameters, settable), ("outputs", outputs, reals)):
        if not tables:
            yield InputFault(
                (table,), f"the FMU declares none; name its variables in [{table}.NAME]"
            )
        for name, one in tables.items():
            variable = one.variable or name
            if variable not in known:
                kind = "parameter of the FMU" if table == "parameters" else "variable of the FMU"
                yield InputFault(
                    (table, name, "variable"), unknown(kind, variable, known), variable
                )
    for name, given in parameters.items():
        found = reals.get(given.variable or name)
        if found is not None and given.nominal is None and found.start is None:
            yield InputFault((*("parameters", name), "nominal"), "is missing, and the FMU has none")


def _field(name: str, one: FmuParameterTable, reals: Mapping[str, Any]) -> tuple[Parameter, float]:
    variable = reals[one.variable or name]
    nominal = float(variable.start) if one.nominal is None else one.nominal
    bounds = bounds_of(variable) if one.bounds is None else (one.bounds[0], one.bounds[1])
    meaning = one.meaning or variable.description or name.replace("_", " ")
    source = one.source or "assumed: the start value of the FMU"
    unit = one.unit or unit_of_variable(variable)
    return Parameter(name, unit, " ".join(meaning.split()), bounds, source), nominal


def _returned(name: str, one: FmuOutputTable, reals: Mapping[str, Any]) -> Returned:
    variable = reals[one.variable or name]
    said = " ".join((variable.description or variable.name).split())
    if one.is_life:
        level, sign = one.level
        way = "above" if sign > 0 else "below"
        return Returned("s", one.meaning or f"time until {said} is {way} {level:g}", life=True)
    words = {"end": "", "max": "largest ", "min": "smallest ", "mean": "mean "}[one.over_time]
    return Returned(one.unit or unit_of_variable(variable), one.meaning or f"{words}{said}")


@dataclass(frozen=True)
class _Fmu:
    """What simulates a row.

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
        FmuError, NonFiniteError
        """
        numbers = list(row.values())
        with self.folders.row(numbers) as folder:
            os.chdir(folder)  # where it may write; the caller leaves it
            log = list[str]()
            try:
                history = self._history(folder / _UNPACKED, row, log)
                found = {
                    name: reduced(one, history["time"], history[one.variable or name])
                    for name, one in self.outputs.items()
                }
                list(checked(found, self.returned))  # here: the folder of a failed row is kept
                return found
            except Exception as error:
                (folder / _LOG).write_text("\n".join(log), encoding="utf-8")
                said = f" ({log[-1]})" if log else ""
                text = f"{one_line(error)}{said}; see {self.folders.kept(numbers)}"
                kind = NonFiniteError if isinstance(error, NonFiniteError) else FmuError
                raise kind(text) from None

    def _history(self, unpacked: Path, row: Mapping[str, float], log: list[str]) -> Any:
        """Return the variables that are wanted over time, from an FMU unpacked for this row.

        A library in a file of its own shares no memory with that of another row.
        """
        import fmpy
        from fmpy.simulation import instantiate_fmu, simulate_fmu

        def logger(*said: Any) -> None:
            *_, status, _, text = said
            if status >= _DISCARDED:
                log.append(" ".join(text.decode(errors="replace").split()))

        if stamp_of(self.path) != self.stamp:
            raise FmuError("the file was changed after the run began")
        said, (start, stop, step) = said_of(self.path), self.times
        wanted = "modelDescription.xml", "resources/", f"binaries/{fmpy.platform}/"
        fmpy.extract(str(self.path), str(unpacked), include=lambda name: name.startswith(wanted))
        instance = instantiate_fmu(str(unpacked), said, logger=logger)
        fatal = False
        try:
            history = simulate_fmu(
                str(unpacked),
                start_time=start,
                stop_time=stop,
                output_interval=step,
                start_values={self.inputs[name]: value for name, value in row.items()},
                output=list(dict.fromkeys(one.variable or n for n, one in self.outputs.items())),
                model_description=said,
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
        Of a life the time from the start until the variable reaches its level, interpolated between
        two values; a lower bound where it does not. NaN where a value is not finite.
    """
    if not np.isfinite(values).all():
        return nan
    if not output.is_life:
        mean = np.trapezoid(values, time) / (time[-1] - time[0])
        found = {"end": values[-1], "max": values.max(), "min": values.min(), "mean": mean}
        return float(found[output.over_time])
    level, sign = output.level
    beyond = sign * (values - level)
    if not (beyond >= 0).any():
        return censored(time[-1] - time[0])
    i = int(np.argmax(beyond >= 0))
    if i == 0:
        return 0.0
    share = beyond[i - 1] / (beyond[i - 1] - beyond[i])
    return float(time[i - 1] + share * (time[i] - time[i - 1]) - time[0])
