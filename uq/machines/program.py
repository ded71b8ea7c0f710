"""Program as a machine: each row is computed in a separate folder."""

import errno
import hashlib
import os
import shutil
import signal
import subprocess
import time
from codecs import BOM_UTF8
from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import inf
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from uq.contract import Model, Parameter, Status
from uq.machines.fmu import code_of_fmu, fmu_of
from uq.machines.fmu_description import FmuFile
from uq.machines.machine_file import (
    FOLDER,
    MachineFile,
    MachineTable,
    code_files,
    content_of,
    data_of,
    filled,
    read_machine,
    template_of,
)
from uq.machines.program_outputs import STDERR_FILE, STDOUT_FILE, value_in
from uq.machines.returned import Returned, RowError, checked, from_plain
from uq.machines.row_by_row import SEED, RowByRow, model_from
from uq.machines.row_resources import Folders, bound_files, end_descendants, ended_within, size_of
from uq.machines.study_defaults import StudyDefaults

_LAST = 300  # characters of the last line of a failed program
_LOOK_SECONDS = 1.0  # between looks at the size of a folder
_TRIES = 3  # of a killed program, before the row is marked as failed
_SEEDS = 2**31 - 1  # many programs take more for the largest of 32 bits, and 0 for the clock
_KILLED = (-signal.SIGKILL, 128 + signal.SIGKILL)  # the program, or the last command of a shell
_REMEDIES = {
    errno.EACCES: "; make it executable: chmod +x",
    errno.ENOEXEC: "; a script begins with a line such as #!/bin/sh",
}


class ProgramError(Exception):
    """A program that failed, in a sentence; `is_killed` if it was killed, perhaps from outside."""

    def __init__(self, message: str, is_killed: bool = False) -> None:
        super().__init__(message)
        self.is_killed = is_killed


def program_of(path: Path) -> Model:
    """Return the model of a machine file.

    Raises
    ------
    InputError
        When the file cannot be used.
    """
    read = read_machine(path)
    declared = {field.name for field in fields(Returned)}
    tables = {name: table.model_dump(include=declared) for name, table in read.outputs.items()}
    returned = from_plain(tables)
    folder = path.absolute().parent
    folders = Folders(folder / f"{read.machine.name}.rows")
    runner = _Program(read, returned, folder, folders, template_of(read.machine, folder))
    inputs = {
        name: (
            Parameter(
                name, parameter.unit, parameter.meaning or name, parameter.span, parameter.source
            ),
            parameter.nominal,
        )
        for name, parameter in read.parameters.items()
    }
    machine = read.machine
    random = _takes_seed(machine, folder)
    batch = RowByRow(
        runner, tuple(inputs), returned, True, folders.leave, folders.keep, queue=read.queue
    )
    title = machine.title or machine.name
    about = machine.name, title, machine.version
    return model_from(*about, inputs, returned, batch, random, StudyDefaults.of_file(read))


def code_of_program(path: Path) -> str:
    """Return a hash of a machine file, its template, its program and the files named in it."""
    read, folder = read_machine(path), path.absolute().parent
    whole = hashlib.sha256(content_of(path))
    if _takes_seed(read.machine, folder):
        whole.update(b"%d seeds\n" % _SEEDS)
    files = code_files(read.machine, folder)
    if program := _program_path(read.machine.command[0], folder):
        files.append(Path(program))
    for file in files:
        for code_file in sorted(file.rglob("*")) if file.is_dir() else [file]:
            if code_file.is_file():
                content = code_file.read_bytes().removeprefix(BOM_UTF8)
                whole.update(b"%s %d\n" % (code_file.name.encode(), len(content)))
                whole.update(content)
    return whole.hexdigest()[:16]


def _takes_seed(machine: MachineTable, folder: Path) -> bool:
    texts = [*machine.command, template_of(machine, folder)]
    return any(f"{{{SEED}" in text for text in texts)


def _program_path(program: str, folder: Path) -> str | None:
    """Return the path of a program: beside the machine file if it has a slash, else searched."""
    if "/" in program:
        return str((folder / program).absolute())
    return shutil.which(program)


@dataclass(frozen=True)
class _Program:
    """Runner of a row."""

    read: MachineFile
    returned: Mapping[str, Returned]
    folder: Path
    folders: Folders
    template: str
    row_limit: float = inf  # time for a row [s]

    def __call__(self, **row: float | int) -> Mapping[str, Any]:
        """Run the program on a row; return its outputs.

        Raises
        ------
        ProgramError, RowError
        """
        with self.folders.row(list(row.values())) as folder:
            for left in reversed(range(_TRIES)):
                try:
                    self._run(folder, row)
                    break
                except ProgramError as error:
                    if not (error.is_killed and left):
                        raise
            outputs = {
                name: value_in(folder, name, output) for name, output in self.read.outputs.items()
            }
            list(checked(outputs, self.returned))  # here: the folder of a failed row is kept
            return outputs

    def _run(self, folder: Path, row: Mapping[str, float | int]) -> None:
        machine = self.read.machine
        places = {**row, FOLDER: str(self.folder)}
        if SEED in row:
            places[SEED] = 1 + int(row[SEED]) % _SEEDS
        if machine.template:
            (folder / machine.input).write_bytes(filled(self.template, places).encode())
        program, *arguments = (filled(part, places) for part in machine.command)
        added = machine.environment
        path = _program_path(program, self.folder) or program
        largest = bound_files(folder)
        with (
            (folder / STDOUT_FILE).open("wb") as out,
            (folder / STDERR_FILE).open("wb") as err,
        ):
            try:
                process = subprocess.Popen(
                    [path, *arguments],
                    cwd=folder,
                    env=dict(os.environ) | added if added else None,
                    stdin=subprocess.DEVNULL,
                    stdout=out,
                    stderr=err,
                )
            except OSError as error:
                remedy = _REMEDIES.get(error.errno or 0, "")
                message = f"'{program}' cannot be started: {error.strerror}{remedy}"
                raise ProgramError(message) from None
            code = self._ended(process, folder, largest)
        if code == -signal.SIGXFSZ:
            raise ProgramError(f"was ended, as it wrote a file larger than {largest:.2g} bytes")
        if code:
            message = _how_it_ended(code, machine.exit_codes, folder / STDERR_FILE)
            raise ProgramError(message, is_killed=code in _KILLED)

    def _ended(self, process: subprocess.Popen[bytes], folder: Path, largest: int) -> int:
        """Return the exit code of a program, once it and all its descendants have ended."""
        fault: Exception | None = None
        until = time.monotonic() + self.row_limit
        try:
            while not ended_within(process, min(until - time.monotonic(), _LOOK_SECONDS)):
                if time.monotonic() >= until:
                    message = f"did not end within {self.row_limit:g} s"
                    fault = RowError(message, Status.TIMED_OUT)
                elif size_of(folder) > largest:
                    message = f"was ended, as it wrote files of more than {largest:.2g} bytes"
                    fault = ProgramError(message)
                if fault:
                    process.kill()
                    break
            code = process.wait()
        finally:
            end_descendants()
        if fault:
            raise fault
        return code


def _how_it_ended(code: int, meanings: Mapping[str, str], stderr_file: Path) -> str:
    if code < 0:
        text = f"was ended by signal {-code} ({signal.strsignal(-code)})"
    else:
        meaning = meanings.get(str(code))
        text = f"ended with exit code {code}" + (f": {meaning}" if meaning else "")
    with stderr_file.open("rb") as file:
        file.seek(max(stderr_file.stat().st_size - 10 * _LAST, 0))
        lines = file.read().decode(errors="replace").split("\n")
    last = next((line.strip() for line in reversed(lines) if line.strip()), "")
    return f"{text} ({last[:_LAST]})" if last else text


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
