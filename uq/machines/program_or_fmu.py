"""Choice between the two kinds of machine files: of a program, and of an FMU."""

from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from uq.contract import Model
from uq.machines.fmu import code_of_fmu, fmu_of
from uq.machines.fmu_description import FmuFile
from uq.machines.machine_file import (
    MachineFile,
    data_of,
)
from uq.machines.program import code_of_program, program_of


def machine_of(path: Path) -> Model:
    """Return the model of a machine file or FMU.

    Raises
    ------
    InputError
        When the file cannot be used.
    """
    return fmu_of(path) if _is_fmu(path) else program_of(path)


def code_of_machine(path: Path) -> str:
    """Return a hash of all files that make up a machine.

    Raises
    ------
    InputError
        When one cannot be used.
    """
    return code_of_fmu(path) if _is_fmu(path) else code_of_program(path)


def _is_fmu(path: Path) -> bool:
    if path.suffix != ".toml":
        return True
    machine = data_of(path).get("machine")
    return isinstance(machine, dict) and "fmu" in machine


def machine_schema() -> dict[str, Any]:
    """Return the JSON Schema of machine files (draft 7)."""
    both: TypeAdapter[MachineFile | FmuFile] = TypeAdapter(MachineFile | FmuFile)
    schema = both.json_schema(ref_template="#/definitions/{model}")
    schema["definitions"] = schema.pop("$defs")
    head = {"$schema": "http://json-schema.org/draft-07/schema#"}
    return head | schema | {"title": "Machine of vibrolife"}
