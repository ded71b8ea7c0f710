"""Columns of numbers named by a study file: read from CSV or netCDF, stored in the study's text.

A result contains the text of its study. The numbers are appended to this text, so that it
reproduces the same rows after the files have changed or been deleted.
"""

import csv
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from math import isfinite
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from uq.contract import Floats
from uq.errors import InputError, nearest, nearest_file
from uq.files.netcdf_files import refuse_tricks
from uq.files.whole_files import node
from uq.sampling.designs import IMPORTED
from uq.sampling.input_faults import InputFault
from uq.text.literals import key
from uq.text.numbers import counted

MAX_NUMBERS = 1_000_000
"""Largest number of values in a column: they are stored in every result."""

Columns = dict[str, dict[str, str]]
"""File -> column -> numbers, as text."""


def columns_of_files(
    tables: Mapping[str, Mapping[str, Any]], folder: Path | None
) -> tuple[Columns, list[InputFault]]:
    """Return all data columns named in a study file, and the faults found.

    Parameters
    ----------
    tables : dict
        Valid entries of a study file; files whose contents are in its [data] are not read.
    folder : Path or None
        Base folder of relative file names; None if all data are in [data].

    Returns
    -------
    columns : dict
    faults : list of InputFault
    """
    columns: Columns = {}
    faults = []
    for path, file, column in _named(tables):
        try:
            if file in tables["data"]:
                text = _kept(tables["data"][file], column)
            else:
                text = " ".join(map(repr, _read(folder, file, column).tolist()))
        except ValueError as error:
            fault = InputFault(path, str(error), file)
            if fault not in faults:  # one fault for all columns of an unreadable file
                faults.append(fault)
        else:
            columns.setdefault(file, {})[column] = text
    return columns, faults


def with_rows_of_files(settings: Mapping[str, Any], columns: Columns) -> dict[str, Any]:
    """Return settings in which rows of numbers take the place of tables that name a file.

    Parameters
    ----------
    settings : dict
        Setting -> its value; a table ``{file = ..., columns = [...]}`` stands for the rows of these
        columns.
    columns : dict
        As `columns_of_files` returns them; a setting whose file could not be read is left out.
    """
    read = {}
    for name, value in settings.items():
        texts = [columns.get(file, {}).get(column) for file, column in _columns_named(value)]
        if None not in texts:
            rows = [numbers(text) for text in texts if text is not None]
            read[name] = np.stack(rows, axis=1).tolist() if rows else value
    return read


def _columns_named(value: Any) -> list[tuple[str, str]]:
    """Return the file and the columns that the value of a setting names."""
    match value:
        case {"file": str(file), "columns": [*columns], **others} if not others:
            return [(file, str(column)) for column in columns]
    return []


def with_columns(text: str, columns: Columns, kept: Mapping[str, Any]) -> str:
    """Return the text of a study file with the columns that it names appended.

    Parameters
    ----------
    text : str
    columns : dict
    kept : dict
        The [data] table of the study.

    Returns
    -------
    str
        TOML; unchanged if there is nothing to add.
    """
    lines = [] if text.endswith("\n") else [""]
    for file, table in columns.items():
        if file not in kept:
            lines += ["# Kept by uq, so that this text is complete.", f"[data.{key(file)}]"]
            lines += [f"{key(column)} = '{numbers}'" for column, numbers in table.items()]
    return "\n".join([text, *lines, ""]) if any(lines) else text


@lru_cache(maxsize=128)
def numbers(text: str) -> Floats:
    """Return the numbers of a column as a read-only array."""
    values = np.array(text.split(), dtype=float)
    values.setflags(write=False)
    return values


def read_column(path: Path, column: str) -> Floats:
    """Return a column of a CSV or netCDF file.

    Raises
    ------
    InputError
        When the file cannot be read, or the column is not one of finite numbers.
    """
    try:
        return _read(path.parent, path.name, column)
    except ValueError as fault:
        raise InputError(f"{path}: {fault}") from None


def _named(tables: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Yield the path of each entry that names a file, the file name, and each required column."""
    uncertain, design = tables["uncertain"], tables["design"]
    for name, value in tables["settings"].items():
        for file, column in _columns_named(value):
            yield ("settings", name), file, column
    for name, entry in uncertain.items():
        if "file" in entry:
            yield ("uncertain", name, "file"), entry["file"], entry["column"]
    if design.get("method") in IMPORTED and "file" in design:
        for name, entry in uncertain.items():
            if "equals" not in entry:
                yield ("design", "file"), design["file"], name


def _kept(columns: Mapping[str, str], column: str) -> str:
    if column not in columns:
        raise ValueError(f"[data] has no column '{column}' of this file")
    try:
        _checked(numbers(columns[column]))
    except ValueError:
        raise ValueError(f"[data] is damaged: column '{column}' must be numbers") from None
    return columns[column]


def _read(folder: Path | None, file: str, column: str) -> Floats:
    """Read a column; raise a `ValueError` that explains the fault."""
    if folder is None:
        raise ValueError("the text of this study does not contain the file's numbers")
    path = folder / file
    if kind := node(path):
        raise ValueError(f"is {kind}, not a file")
    if not path.is_file():
        names = [entry.name for entry in path.parent.glob("*")] if path.parent.is_dir() else []
        raise ValueError(f"no such file in {folder.absolute()}{nearest_file(path.name, names)}")
    read = _read_netcdf if path.suffix == ".nc" else _read_csv
    try:
        return _checked(read(path, column))
    except OSError as error:
        raise ValueError(f"cannot be read: {error.strerror or error}") from None


def _checked(values: Floats) -> Floats:
    if not 1 <= len(values) <= MAX_NUMBERS:
        raise ValueError(f"has {len(values)} rows (allowed: 1 to {MAX_NUMBERS})")
    if not np.isfinite(values).all():
        raise ValueError(f"row {int(np.argmin(np.isfinite(values))) + 1} is not finite")
    return values


def _read_csv(path: Path, column: str) -> Floats:
    with path.open(newline="", encoding="utf-8-sig") as lines:
        try:
            for mark, name in ((";", "semicolons"), ("\t", "tabs")):
                if column in _names(lines, mark):
                    remedy = "write commas, and a decimal point in numbers"
                    raise ValueError(f"has cells separated by {name}; {remedy}")
            lines.seek(0)
            rows = csv.reader(lines, skipinitialspace=True, strict=True)
            names = [name.strip() for name in next(rows, [])]
            if names.count(column) != 1:
                raise ValueError(_no_column(column, names))
            place = names.index(column)
            return np.array([_number(row, names, place, rows.line_num) for row in rows if any(row)])
        except csv.Error as error:
            raise ValueError(f"not CSV: {error}") from None
        except UnicodeDecodeError:
            raise ValueError("not a text file in UTF-8") from None


def _names(lines: TextIO, mark: str) -> list[str]:
    """Return the column names if this separator gives several columns."""
    lines.seek(0)
    names = next(csv.reader(lines, delimiter=mark, skipinitialspace=True), [])
    return [name.strip() for name in names] if names[1:] else []


def _number(row: list[str], names: list[str], place: int, line: int) -> float:
    """Return the number in one cell of a row; raise a `ValueError` that explains the fault."""
    if len(row) != len(names):
        cells = counted(len(row), "cell")
        raise ValueError(
            f"line {line}: has {cells}, the first line {len(names)}; all rows must have as many, "
            "and numbers a decimal point, not a comma"
        )
    cell = row[place].strip()
    try:
        value = float(cell)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        remedy = "; write it with a decimal point" if _DECIMAL_COMMA.fullmatch(cell) else ""
        problem = f"column '{names[place]}' must be a finite number: '{cell}'{remedy}"
        raise ValueError(f"line {line}: {problem}")
    return value


_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")


def _read_netcdf(path: Path, column: str) -> Floats:
    import xarray as xr

    try:
        refuse_tricks(path)
        with xr.open_dataset(path, engine="netcdf4", decode_timedelta=False) as ds:
            wide = [str(name) for name in ds.variables if ds[name].ndim == 1]
            if column not in wide:
                raise ValueError(_no_column(column, wide))
            if ds[column].size > MAX_NUMBERS:
                raise ValueError(f"has {ds[column].size} rows (allowed: 1 to {MAX_NUMBERS})")
            return np.asarray(ds[column].values, dtype=float)
    except (OSError, RuntimeError, TypeError):
        raise ValueError("not a netCDF file of numbers") from None


def _no_column(column: str, names: list[str]) -> str:
    listing = ", ".join(names) or "none"
    if column in names:
        return f"has several columns '{column}'; give each its own name (its columns: {listing})"
    return f"has no column '{column}'{nearest(column, names)} (its columns: {listing})"
