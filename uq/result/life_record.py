"""A record of lives from the field, read from CSV as a result without a model."""

import csv
import hashlib
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf, isfinite, isnan, nan
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Model, Output, Parameter, cause_name, entered_name, high_name
from uq.errors import InputError, choices, nearest
from uq.files.whole_files import node
from uq.result.result_file import build_rows
from uq.sampling.listed_values import MAX_VALUES
from uq.study.changes import study_text
from uq.study.installed_models import FIELD_RECORD
from uq.study.reading import study_of_result
from uq.text.quantities import fault_of_unit, misfit, read_quantity

_HEADING = re.compile(r"\s*(.*?)\s*(?:\[([^\]]*)\]\s*)?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
_TRUE, _FALSE = ("1", "1.0", "true", "yes", "censored"), ("0", "0.0", "false", "no", "")
_NO_END = ("", "inf", "infinity", "+inf")
_MOST_LABELS = 100


@dataclass(frozen=True)
class RecordColumns:
    """Columns of a record of lives.

    Attributes
    ----------
    life : str
        Life, or time of censoring; with `low` and `high` the name of the life, and its exact value
        where such a column has one.
    unit : str
        Of all times; "" if the headings state it.
    censored : str
        1 or true where the life had not ended; "" if there is none, like those below.
    low, high : str
        The life ended after `low`, 0 or empty if unknown, and not after `high`, empty if it had not
        ended.
    entered : str
        Age at which the row came under observation, 0 or empty if new.
    cause : str
        Event that ended the life.
    """

    life: str
    unit: str = ""
    censored: str = ""
    low: str = ""
    high: str = ""
    entered: str = ""
    cause: str = ""


@dataclass(frozen=True)
class _RecordTable:
    """The cells of a CSV file by column, with the unit in each heading and the line of each row."""

    path: Path
    cells: Mapping[str, Sequence[str]]
    units: Mapping[str, str]
    lines: Sequence[int]

    def fault(self, row: int, column: str, problem: str) -> InputError:
        """Return the error of a cell."""
        return InputError(f"{self.path}: line {self.lines[row]}: column '{column}' {problem}")

    def column(self, name: str) -> Sequence[str]:
        """Return the cells of a column."""
        if name not in self.cells:
            raise InputError(
                f"{self.path}: no column '{name}'{nearest(name, self.cells)} (its columns:"
                f" {choices(self.cells)})"
            )
        return self.cells[name]

    def times(self, name: str, empty: float) -> Floats:
        """Return a column of times; an empty cell, or one that never ends, has the value `empty`.

        NaN stands for "not allowed" in `empty`.
        """
        return np.array(
            [self._time(i, name, cell, empty) for i, cell in enumerate(self.column(name))]
        )

    def _time(self, row: int, name: str, cell: str, empty: float) -> float:
        if cell.lower() in _NO_END and not isnan(empty) and (cell == "" or empty == inf):
            return empty
        number = number_of(cell)
        if not isfinite(number):
            raise self.fault(
                row, name, f"must be a time, as a finite number: '{cell}'{_remedy(cell)}"
            )
        if number < 0:
            raise self.fault(row, name, f"must not be negative: {cell}")
        return number


def number_of(cell: str) -> float:
    """Return the number in a cell; NaN if it is none."""
    try:
        return float(cell)
    except ValueError:
        return nan


def _remedy(cell: str) -> str:
    if _DECIMAL_COMMA.fullmatch(cell):
        return "; write it with a decimal point"
    if cell.lower() in _NO_END:
        return "; name the column that says so with --censored"
    if re.match(r"[-+.\d]+\s*[A-Za-z]", cell):
        return "; state the unit once, with --unit"
    return ""


def read_lives(
    path: str | Path, columns: RecordColumns, thresholds: Sequence[float | str] = ()
) -> tuple[xr.Dataset, list[str]]:
    """Return a record of lives as a result, and notes on what it leaves out.

    Parameters
    ----------
    path : path-like
        CSV with a heading; a heading may state the unit of its column: ``life [h]``.
    columns : RecordColumns
    thresholds : sequence of float or str, optional
        Of the life, for its [analysis].

    Returns
    -------
    ds : xarray.Dataset
        A result of design ``imported`` with independent rows. Lives in seconds if their unit is one
        of time; all other columns of numbers are inputs.
    notes : list of str

    Raises
    ------
    InputError
        In one line: file, line, column, value, what is allowed.
    """
    table = _read(Path(path))
    used = [name for name in vars(columns).values() if name in table.cells]
    unit, size = _unit(table, columns)
    lives = _lives(table, columns)
    name = _identifier(columns.life)
    causes, labels = _causes(table, columns, lives["censored"] & ~np.isfinite(lives["high"]))
    inputs, notes = _inputs(table, [*used, columns.life, columns.unit], name)
    has_high = bool((lives["censored"] & np.isfinite(lives["high"])).any())
    output = Output(
        unit,
        columns.life.replace("_", " "),
        "lifetime",
        never_known_at_once=False,
        causes=labels,
        may_be_between=has_high,
    )
    model = _record_model(name, output, inputs)
    n = len(table.lines)
    outputs = {name: lives["low"] * size, f"{name}_censored": lives["censored"]}
    if has_high:
        outputs[high_name(name)] = lives["high"] * size
    if labels:
        outputs[cause_name(name)] = causes
    values: dict[str, float | Floats] = dict(inputs)
    ds = build_rows(model, model.settings(), values, outputs, np.zeros(n, np.int8), {})
    if "entered" in lives:
        attrs = {"role": "entered", "units": unit, "long_name": f"start of observation of {name}"}
        ds[entered_name(name)] = ("row", lives["entered"] * size, attrs)
    for at in thresholds:
        if isinstance(at, str) and (why := _misfit(at, name, unit)):
            raise InputError(f"--threshold '{at}': {why}")
    asked = {"thresholds": {name: list(thresholds)}} if thresholds else {}
    return _as_result(ds, table.path, inputs, asked), notes


def import_lives(
    path: str | Path,
    life: str,
    *,
    unit: str = "",
    censored: str = "",
    low: str = "",
    high: str = "",
    entered: str = "",
    cause: str = "",
    thresholds: Sequence[float | str] = (),
) -> xr.Dataset:
    """Read lives from the field into a result, as ``uq import`` does.

    Parameters
    ----------
    path : path-like
        CSV with a heading, which may state units: ``life [h]``. Other columns of numbers become
        inputs.
    life : str
        Column of the life, or of the time of censoring; it names the output.
    unit : str
        Of all times, if the headings do not state it.
    censored : str, optional
        Column that is 1 where the life had not ended.
    low, high : str, optional
        Columns between which the life ended, in place of `censored`.
    entered : str, optional
        Column of the age at which a row came under observation.
    cause : str, optional
        Column of the event that ended the life.
    thresholds : sequence, optional
        Times of which to report the probability that the life has ended, in seconds or the unit of
        the life, or as text with a unit: ``"2 years"``.

    Returns
    -------
    xarray.Dataset
        A result of independent rows, which every reader of results takes.

    Raises
    ------
    InputError
        In one line: file, line, column, value, what is allowed.
    """
    columns = RecordColumns(life, unit, censored, low, high, entered, cause)
    return read_lives(path, columns, thresholds)[0]


def _read(path: Path) -> _RecordTable:
    if kind := node(path):
        raise InputError(f"{path}: is {kind}, not a CSV file")
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            first = file.readline()
            file.seek(0)
            for mark, word in ((";", "semicolons"), ("\t", "tabs")):
                if first.count(mark) > first.count(","):
                    raise InputError(
                        f"{path}: has cells separated by {word}; write commas, and a decimal point"
                        " in numbers"
                    )
            reader = csv.reader(file, skipinitialspace=True, strict=True)
            headings = next(reader, [])
            rows = [(reader.line_num, [c.strip() for c in row]) for row in reader if any(row)]
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; give a CSV file with a heading") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file in UTF-8") from None
    except csv.Error as error:
        raise InputError(f"{path}: not CSV: {error}") from None
    parts = [_HEADING.fullmatch(heading) for heading in headings]
    names = [match[1] if match else "" for match in parts]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}: has several columns '{name}'; give each its own name")
    for line, row in rows:
        if len(row) != len(names):
            raise InputError(
                f"{path}: line {line}: has {len(row)} cells, the heading {len(names)}; numbers need"
                " a decimal point, not a comma"
            )
    if not 1 <= len(rows) <= MAX_VALUES:
        raise InputError(f"{path}: has {len(rows)} rows (allowed: 1 to {MAX_VALUES})")
    cells = {name: [row[i] for _, row in rows] for i, name in enumerate(names)}
    units = {name: match[2] for name, match in zip(names, parts, strict=True) if match and match[2]}
    return _RecordTable(path, cells, units, [line for line, _ in rows])


def _unit(table: _RecordTable, columns: RecordColumns) -> tuple[str, float]:
    """Return the unit of lives in a result, and the size of the unit of the record in it."""
    times = (columns.life, columns.low, columns.high, columns.entered)
    stated = {f"column '{name}'": table.units[name] for name in times if name in table.units}
    if columns.unit:
        stated = {"--unit": columns.unit} | stated
    for who, unit in stated.items():
        if not _both_times(unit) and (fault := fault_of_unit(unit)):
            raise InputError(f"{table.path}: {who}: unit '{unit}': {fault}")
    (first, unit), *others = list(stated.items()) or [("", "1")]
    for other, another in others:
        if (
            read_quantity(f"1 {another}") != read_quantity(f"1 {unit}")
            if _both_times(unit, another)
            else another != unit
        ):
            raise InputError(
                f"{table.path}: two units of time: {first} is in '{unit}', {other} in '{another}';"
                " convert one of them"
            )
    return ("s", float(read_quantity(f"1 {unit}"))) if _both_times(unit) else (unit, 1.0)


def _misfit(text: str, name: str, unit: str) -> str:
    try:
        return misfit(text, name, unit)
    except ValueError as error:
        return str(error)


def _both_times(*units: str) -> bool:
    with suppress(ValueError):
        return all(read_quantity(f"1 {unit}").dimensions == {"s": 1} for unit in units)
    return False


def _lives(table: _RecordTable, columns: RecordColumns) -> dict[str, Any]:
    """Return lower and upper bounds, the mask of those that are not exact, and the entries."""
    if bool(columns.low) != bool(columns.high):
        raise InputError("--low and --high belong together; name both columns")
    if columns.low and columns.censored:
        raise InputError("--censored: not with --low and --high, which state it; leave one out")
    if columns.low:
        low, high = table.times(columns.low, 0.0), table.times(columns.high, inf)
        if columns.life in table.cells:
            exact = [cell != "" for cell in table.column(columns.life)]
            life = table.times(columns.life, 0.0)
            low, high = np.where(exact, life, low), np.where(exact, life, high)
        for row in np.flatnonzero(low > high)[:1]:
            raise table.fault(
                row,
                columns.low,
                f"must not be above '{columns.high}': {low[row]:g} > {high[row]:g}",
            )
        censored = low < high
    else:
        low = table.times(columns.life, nan)
        censored = np.zeros(len(low), dtype=bool)
        if columns.censored:
            censored = np.array(list(_flags(table, columns.censored)))
        high = np.where(censored, inf, low)
    lives: dict[str, Any] = {"low": low, "high": high, "censored": censored}
    if columns.entered:
        entered = table.times(columns.entered, 0.0)
        end = np.where(np.isfinite(high), high, low)
        for row in np.flatnonzero((entered >= end) & ((entered > 0) | censored & (end == 0)))[:1]:
            raise table.fault(
                row, columns.entered, f"must be before the end, {end[row]:g}: {entered[row]:g}"
            )
        # A life that ended between two inspections is known to exceed its entry.
        lives["entered"] = entered
        lives["low"] = np.where(censored, np.maximum(low, entered), low)
    return lives


def _flags(table: _RecordTable, column: str) -> Iterator[bool]:
    for row, cell in enumerate(table.column(column)):
        if cell.lower() not in (*_TRUE, *_FALSE):
            raise table.fault(row, column, f"must be 1 (censored) or 0 (ended): '{cell}'")
        yield cell.lower() in _TRUE


def _causes(
    table: _RecordTable, columns: RecordColumns, has_no_end: NDArray[np.bool_]
) -> tuple[NDArray[np.int8], tuple[str, ...]]:
    """Return the code of the cause of each row, and the causes."""
    if not columns.cause:
        return np.full(len(table.lines), -1, np.int8), ()
    cells = [_word(cell) for cell in table.column(columns.cause)]
    for row, cell in enumerate(cells):
        if cell and has_no_end[row]:
            raise table.fault(
                row, columns.cause, f"names a cause without an end: '{cell}'; leave it empty"
            )
        if not cell and not has_no_end[row]:
            raise table.fault(
                row, columns.cause, "is empty, but the life has ended; name its cause, or 'unknown'"
            )
    labels = tuple(sorted({cell for cell in cells if cell}))
    if not 1 <= len(labels) <= _MOST_LABELS:
        raise InputError(
            f"{table.path}: column '{columns.cause}' has {len(labels)} causes (allowed: 1 to"
            f" {_MOST_LABELS})"
        )
    return np.array([labels.index(c) if c else -1 for c in cells], np.int8), labels


def _word(cell: str) -> str:
    """Return the label of a cause as one word."""
    return re.sub(r"[\s,/\[\]=]+", "-", cell)


def _identifier(name: str) -> str:
    """Return the name of a column as that of a variable."""
    word = re.sub(r"\W+", "_", name).strip("_")
    return word if word.isidentifier() else f"column_{word}"


def _inputs(
    table: _RecordTable, used: Sequence[str], life: str
) -> tuple[dict[str, Floats], list[str]]:
    """Return the columns of numbers that say nothing of the life, and notes on the others."""
    inputs, notes = dict[str, Floats](), list[str]()
    taken = {"row", "replicate", "group", "block", "status", "world", "unit", "repeat", "rerun"}
    taken |= {life, cause_name(life), high_name(life), entered_name(life), f"{life}_censored"}
    for name, cells in table.cells.items():
        if name in used:
            continue
        numbers = np.array([number_of(cell) for cell in cells])
        new = _identifier(name)
        while new in taken:
            new += "_"
        if np.isfinite(numbers).all():
            taken.add(new)
            inputs[new] = numbers
            continue
        row = int(np.argmin(np.isfinite(numbers)))
        if _DECIMAL_COMMA.fullmatch(cells[row]):
            raise table.fault(row, name, f"must be a number: '{cells[row]}'{_remedy(cells[row])}")
        notes.append(f"column '{name}' is left out: line {table.lines[row]} has '{cells[row]}'")
    return inputs, notes


def _record_model(name: str, output: Output, inputs: Mapping[str, Floats]) -> Model:
    """Return the declarations of a record as those of a model that computes nothing."""
    from collections import namedtuple

    from uq.machines.row_by_row import NoSettings

    fields = {
        column: Parameter(column, "1", column.replace("_", " "), (-inf, inf), "as recorded")
        for column in inputs
    }
    made: Any = namedtuple("Columns", fields, defaults=[v[0] for v in inputs.values()])  # type: ignore[misc]
    made.__annotations__ = {column: Annotated[float, fields[column]] for column in fields}

    def batch(x: Any, seed: Any, settings: Any) -> Any:
        raise InputError("a record of lives has no model")

    title = "lives from the field"
    return Model(
        FIELD_RECORD, title, "1", made, NoSettings, {name: output}, batch, row_name=("row", "rows")
    )


def _as_result(
    ds: xr.Dataset, path: Path, inputs: Mapping[str, Floats], asked: Mapping[str, Any]
) -> xr.Dataset:
    """Return rows with the attributes and design indices of a result."""
    uncertain, n = {}, ds.sizes["row"]
    for name, values in inputs.items():
        if len(set(values.tolist())) < 2:
            attrs = ds[name].attrs | {"role": "fixed", "nominal": float(values[0])}
            attrs.pop("admissible")
            ds[name] = ((), values[0], attrs)
        else:
            law = {"distribution": "empirical", "values": values.tolist(), "source": "as recorded"}
            uncertain[name] = law
    study = study_text(
        {
            "study": {
                "name": _identifier(path.stem).replace("_", "-"),
                "model": FIELD_RECORD,
                "description": f"lives of {path.name}",
            },
            "design": {"method": "imported", "independent": True},
            "uncertain": uncertain,
        }
        | ({"analysis": asked} if asked else {})
    )
    study_of_result(study)  # refuses thresholds that are no times
    along = ("row",)
    block = {"flag_values": np.int16(0), "flag_meanings": "sample"}
    zeros = np.zeros(n, np.int64)
    ds = ds.assign_coords(
        row=(along, np.arange(n), {"long_name": "row"}),
        replicate=(along, zeros, {"long_name": "independent scramble of the design"}),
        group=(along, np.arange(n), {"long_name": "base point of the design"}),
        block=(along, zeros.astype(np.int16), {"long_name": "block of the design"} | block),
    )
    ds.attrs |= {
        "title": f"lives of {path.name}",
        "study": study,
        "study_sha256": hashlib.sha256(study.encode()).hexdigest(),
        "study_identity": "",
        "design": "imported",
        "samples": n,
        "replicates": 1,
        "second_order": 0,
        "seed": 0,
    }
    for variable in ds.variables.values():
        variable.encoding["_FillValue"] = None
    return ds
