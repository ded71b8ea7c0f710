"""A machine file: a program, its input and its results, described in TOML."""

import os
import re
import shutil
from codecs import BOM_UTF8
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from uq.contract import ROW_NAME
from uq.errors import InputError, nearest, one_line
from uq.files.whole_files import file_there, node
from uq.machines.queue_table import QueueTable
from uq.machines.row_by_row import SEED
from uq.sampling.input_faults import InputFault, fault_of
from uq.text.literals import read_toml

_LONGEST = 1_000_000  # bytes of a machine file

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=100)]
"""Of a parameter or output."""

MachineName = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$", max_length=100)]


RowName = Annotated[list[str], Field(description="singular and plural of a row")]
Headline = Annotated[list[str], Field(description="outputs that a new study reports")]
Uncertain = dict[Name, dict[str, Any]]
"""Input -> its law in a new study, as in a study file."""


class TomlTable(BaseModel):
    """A table, or a file as a whole."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


T = TypeVar("T", bound=TomlTable)


def data_of(path: Path) -> dict[str, Any]:
    """Return the parsed content of a machine file, unchecked.

    Raises
    ------
    InputError
    """
    file_there(path)
    if path.stat().st_size > _LONGEST:
        raise InputError(f"{path}: larger than a machine file can be")
    try:
        data = read_toml(path.read_text(encoding="utf-8-sig"))
    except (ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"{path}: not valid TOML: {one_line(error)}") from None
    if "study" in data and "machine" not in data:
        raise InputError(f"{path}: is a study, not a machine file; it needs a table [machine]")
    return data


_QUEUE = re.compile(rb"(?ms)^\n?\[queue\].*?\n(?=\n*^\[|\n*\Z)")


def content_of(path: Path) -> bytes:
    """Return the content of a machine file that determines its rows.

    Without byte-order mark and table [queue], which says where they are computed; with LF line
    ends.
    """
    text = path.read_bytes().removeprefix(BOM_UTF8).replace(b"\r\n", b"\n")
    return _QUEUE.sub(b"", text)


def read_as(kind: type[T], path: Path) -> T:
    """Return a machine file as tables of a kind.

    Raises
    ------
    InputError
        One line for each mistake.
    """
    data = data_of(path)
    try:
        return kind.model_validate(data)
    except ValidationError as invalid:
        errors = map(dict, invalid.errors(include_url=False))
        refuse(path, (fault_of(error, partial(_keys, kind)) for error in errors))
        raise


def _keys(file: type[BaseModel], place: Sequence[Any]) -> tuple[str, list[str]]:
    """Return the allowed keys at the position of an unknown key: kind and names."""
    table: Any = file
    if len(place) > 1:
        table = file.model_fields[place[0]].annotation
        table = table if isinstance(table, type) else table.__args__[-1]  # of dict, or None |
    names = [field.alias or name for name, field in table.model_fields.items()]
    return "key" if len(place) > 1 else "table", names


def refuse(path: Path, faults: Iterable[InputFault]) -> None:
    """Refuse a machine file for its faults.

    Raises
    ------
    InputError
    """
    if lines := [f"{path}: {fault.line}" for fault in faults]:
        raise InputError(*lines)


_PLACE = r"\{(%s)(:[^{}]*)?\}"

_LONGEST_TEMPLATE = 10_000_000  # bytes

STDOUT = "stdout"

FOLDER = "machine_folder"
"""The place of the folder of the machine file, in a command or template."""


class MachineTable(TomlTable):
    """``[machine]``: the program, and how it is called."""

    name: MachineName
    command: Annotated[list[str], Field(min_length=1, description="program and arguments")]
    title: str = ""
    version: str = "1"
    row_name: RowName = [*ROW_NAME]
    headline: Headline = []
    template: Annotated[str, Field(description="file whose {places} are filled")] = ""
    input: Annotated[str, Field(description="name of the filled template")] = "input.txt"
    files: Annotated[list[str], Field(description="what else counts as its code")] = []
    environment: dict[str, str] = {}
    exit_codes: Annotated[dict[str, str], Field(description="what exit codes mean")] = {}


class ParameterTable(TomlTable):
    """``[parameters.NAME]``: an input with its nominal value."""

    nominal: float
    unit: str = "1"
    bounds: Annotated[list[float], Field(min_length=2, max_length=2)] = [-inf, inf]
    meaning: str = ""
    source: str = "assumed: of the machine file"

    @property
    def span(self) -> tuple[float, float]:
        """The bounds."""
        return self.bounds[0], self.bounds[1]


class OutputTable(TomlTable):
    """``[outputs.NAME]``: a result and its location: by json, csv, netcdf or pattern."""

    unit: str = "1"
    meaning: str = ""
    life: bool = False
    shape: list[Annotated[int, Field(ge=1)]] = []
    may_be_undefined: bool = False
    scales: Annotated[dict[str, float], Field(description="exponents of what scales a life")] = {}
    file: Annotated[str, Field(description="file that the program writes")] = STDOUT
    json_path: Annotated[str, Field(alias="json", description="keys and numbers: a.b.0")] = ""
    csv: Annotated[str, Field(description="column; its last row counts")] = ""
    netcdf: Annotated[str, Field(description="variable")] = ""
    pattern: Annotated[str, Field(description="regular expression with one group")] = ""

    @model_validator(mode="after")
    def _one_way(self) -> "OutputTable":
        ways = [self.json_path, self.csv, self.netcdf, self.pattern]
        if sum(map(bool, ways)) != 1:
            raise ValueError("give one of json, csv, netcdf and pattern")
        if self.netcdf and self.file == STDOUT:
            raise ValueError("netcdf needs a file")
        if self.pattern:
            try:
                groups = re.compile(self.pattern).groups
            except re.error as error:
                raise ValueError(f"pattern: {error}") from None
            if groups != 1:
                raise ValueError(f"pattern must have one group in parentheses, not {groups}")
        return self


class MachineFile(TomlTable):
    """A machine file."""

    machine: MachineTable
    parameters: Annotated[dict[Name, ParameterTable], Field(min_length=1)]
    outputs: Annotated[dict[Name, OutputTable], Field(min_length=1)]
    uncertain: Uncertain = {}
    queue: None | QueueTable = None


def read_machine(path: Path) -> MachineFile:
    """Read a machine file.

    Raises
    ------
    InputError
        One line for each mistake.
    """
    machine_file = read_as(MachineFile, path)
    refuse(path, _faults(machine_file, path.parent))
    return machine_file


def template_of(machine: MachineTable, folder: Path) -> str:
    """Return the text of a template, its line ends as they are; "" without one.

    Raises
    ------
    OSError, UnicodeDecodeError
        Also where it is a pipe or a device, or longer than any input.
    """
    if not machine.template:
        return ""
    path = folder / machine.template
    if kind := node(path):
        raise OSError(f"is {kind}, not a file")
    with path.open("rb") as file:
        content = file.read(_LONGEST_TEMPLATE + 1)
    if len(content) > _LONGEST_TEMPLATE:
        raise OSError(f"is longer than {_LONGEST_TEMPLATE // 1_000_000} MB")
    return content.decode("utf-8-sig")


def code_files(machine: MachineTable, folder: Path) -> list[Path]:
    """Return the files that determine the rows of a machine, besides its file and its program.

    They are its template, the files that it names, and those among the arguments.
    """
    named = [folder / name for name in (machine.template, *machine.files) if name]
    for argument in machine.command[1:]:
        path = folder / (argument.partition(f"{{{FOLDER}}}/")[2] or argument)
        named += [path] * path.is_file()
    return named


def _faults(machine_file: MachineFile, folder: Path) -> Iterator[InputFault]:
    machine = machine_file.machine
    try:
        texts = [*machine.command, template_of(machine, folder)]
    except UnicodeDecodeError:
        problem = "is not a text in UTF-8; let the program read it from {machine_folder}"
        yield InputFault(("machine", "template"), problem, machine.template)
        return
    except OSError as error:
        problem = "no such file" if isinstance(error, FileNotFoundError) else one_line(error)
        yield InputFault(("machine", "template"), problem, machine.template)
        return
    if problem := _program_problem(machine.command[0], folder):
        yield InputFault(("machine", "command"), problem)
    for argument in machine.command[1:]:
        if (folder / argument).is_file() and not Path(argument).is_absolute():
            problem = (
                f"'{argument}' is beside this file, but the program runs in the folder of its row;"
                f" write {{{FOLDER}}}/{argument}"
            )
            yield InputFault(("machine", "command"), problem)
    for name in machine.environment:
        if not name or "=" in name:
            yield InputFault(("machine", "environment", name), "must be a name without '='")
    if not _is_name(machine.input):
        yield InputFault(("machine", "input"), _IN_ROW, machine.input)
    for name, output in machine_file.outputs.items():
        if not _is_within(output.file):
            yield InputFault(("outputs", name, "file"), _IN_ROW, output.file)
    try:
        nominal = {name: parameter.nominal for name, parameter in machine_file.parameters.items()}
        filled(" ".join(texts), {**nominal, SEED: 0, FOLDER: ""})
    except ValueError as error:
        yield InputFault(("machine", "command"), f"a place in it or in the template: {error}")
    for name in machine_file.parameters:
        if name in (SEED, FOLDER):
            yield InputFault(("parameters", name), "is the name of another place; choose another")
        if not any(re.search(_PLACE % name, text) for text in texts):
            problem = f"has no place {{{name}}} in command{' or template' * bool(machine.template)}"
            yield InputFault(("parameters", name), problem)
    for name, parameter in machine_file.parameters.items():
        low, high = parameter.bounds
        if not (isfinite(parameter.nominal) and low <= parameter.nominal <= high):
            yield InputFault(
                ("parameters", name, "nominal"), "must be within the bounds", parameter.nominal
            )
    for file in machine.files:
        if not (folder / file).exists():
            yield InputFault(("machine", "files"), "no such file", file)
    for code in machine.exit_codes:
        if not re.fullmatch(r"\d{1,3}", code):
            yield InputFault(("machine", "exit_codes", code), "must be a number between 1 and 255")


def _program_problem(program: str, folder: Path) -> str:
    """Return why a program cannot be started, judged by its file; "" if it can."""
    program = program.replace(f"{{{FOLDER}}}", str(folder.absolute()))
    path = folder / program
    if re.search(_PLACE % r"\w+", program) or ("/" not in program and shutil.which(program)):
        return ""
    if "/" not in program:
        remedy = f"; the one beside this file is './{program}'" if path.is_file() else ""
        return f"'{program}' is not on the PATH{remedy}"
    if not path.is_file():
        programs = [f"./{file.name}" for file in folder.iterdir() if os.access(file, os.X_OK)]
        return f"'{program}' is no file{nearest(program, programs)}"
    return "" if os.access(path, os.X_OK) else f"'{program}' is not executable: chmod +x {program}"


_IN_ROW = "must be the name of a file in the folder of the row"


def _is_name(file: str) -> bool:
    return Path(file).name == file and file not in ("", "..")


def _is_within(file: str) -> bool:
    """Whether a file is in the folder of a row, not in one that other rows share."""
    return bool(file) and not Path(file).is_absolute() and ".." not in Path(file).parts


def filled(text: str, values: Mapping[str, float | int | str]) -> str:
    """Return a text with values in its places: ``{load}``, or ``{load:.6e}`` in a format.

    Other braces stay as they are. Without a format a number has all its digits.

    Raises
    ------
    ValueError
        When a format does not suit a number.
    """

    def value(match: re.Match[str]) -> str:
        substitute = values[match[1]]
        how = match[2][1:] if match[2] else ""
        if re.search(r"\d{4}", how):
            raise ValueError(f"format '{how[:20]}' is wider than 999 characters")
        return format(substitute, how)

    return re.sub(_PLACE % "|".join(map(re.escape, values)), value, text)
