"""Machine files in TOML: read, and checked against the tables that they may have."""

from codecs import BOM_UTF8
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from uq.errors import InputError, nearest, one_line
from uq.inputs.faults import Fault, fault_of
from uq.literals import read_toml
from uq.places import node

_LONGEST = 1_000_000  # bytes of a machine file

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=100)]
"""Of a parameter or output."""

MachineName = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]+$", max_length=100)]


class Table(BaseModel):
    """A table, or a file as a whole."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


T = TypeVar("T", bound=Table)


def file_there(path: Path) -> None:
    """Refuse a path without a file.

    Raises
    ------
    InputError
    """
    if what := node(path):
        raise InputError(f"{path}: is {what}, not a file")
    if not path.is_file():
        others = path.parent.glob(f"*{path.suffix}") if path.parent.is_dir() else []
        raise InputError(f"{path}: no such file{nearest(path.name, [one.name for one in others])}")


def data_of(path: Path) -> dict[str, Any]:
    """Return what a machine file says, unchecked.

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


def content_of(path: Path) -> bytes:
    """Return a machine file as it is identified: without a byte-order mark, lines ended by LF."""
    return path.read_bytes().removeprefix(BOM_UTF8).replace(b"\r\n", b"\n")


def read_as(kind: type[T], path: Path) -> T:
    """Return a machine file as tables of a kind.

    Raises
    ------
    InputError
        One line for each mistake.
    """

    def known(place: Sequence[Any]) -> list[str]:
        """Return what may stand in the place of an unknown key."""
        if len(place) == 1:
            return list(kind.model_fields)
        return _keys(kind.model_fields[place[0]].annotation)

    try:
        return kind.model_validate(data_of(path))
    except ValidationError as invalid:
        refuse(path, (fault_of(dict(one), known) for one in invalid.errors(include_url=False)))
        raise


def _keys(annotation: Any) -> list[str]:
    """Return the keys of a table, or of those in a dict of tables."""
    table: Any = annotation if isinstance(annotation, type) else annotation.__args__[-1]
    return [field.alias or name for name, field in table.model_fields.items()]


def refuse(path: Path, faults: Iterable[Fault]) -> None:
    """Refuse a machine file for its faults.

    Raises
    ------
    InputError
    """
    if lines := [f"{path}: {fault.line}" for fault in faults]:
        raise InputError(*lines)
