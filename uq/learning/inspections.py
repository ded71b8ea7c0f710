"""Inspections: reading from files and tables, with a check that each is used only once."""

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import StrEnum
from math import inf, isfinite
from numbers import Real
from pathlib import Path

import numpy as np
import xarray as xr

from uq.errors import InputError, nearest, nearest_file
from uq.files.whole_files import node
from uq.result.result import Result
from uq.text.literals import read_number, read_toml, shown


class InspectionKind(StrEnum):
    """Kinds of observation: a value, a limit on one side, or an outcome of a life."""

    MEASURED = "measured"
    BELOW = "below"
    ABOVE = "above"
    SURVIVED = "survived"
    ENDED = "ended"


MOST_CV = 10.0
"""Implausibly large coefficient of variation of an error: probably given in per cent."""

OUTCOMES = (InspectionKind.SURVIVED, InspectionKind.ENDED)


@dataclass(frozen=True)
class Inspection:
    """One observation of one unit.

    Attributes
    ----------
    unit : str
        The label of the unit.
    output : str
        The observed quantity: the name of an element, or for example ``depth[site=right]``.
    kind : InspectionKind
        ``measured``: the value; ``below``, ``above``: on which side of the value it lies, or
        whether it was not or was detected; ``survived``, ``ended``: whether the life had ended.
    time : float or None
        Time since the start of the life, in its unit.
    value : float or None
        In the unit of the output.
    sd : float or None
        Standard deviation of a normal error.
    cv : float or None
        Coefficient of variation of a lognormal error, whose median is 1.
    detection_50, detection_90 : float or None
        Sizes detected with probability 50 % and 90 %; they define a lognormal detection curve.
    where : str
        Location in the source, for messages: ``found.csv, line 3``.
    """

    unit: str
    output: str
    kind: InspectionKind
    time: float | None = None
    value: float | None = None
    sd: float | None = None
    cv: float | None = None
    detection_50: float | None = None
    detection_90: float | None = None
    where: str = field(default="", compare=False, repr=False)


COLUMNS = tuple(column.name for column in fields(Inspection) if column.compare)
"""Columns of a file of inspections."""

_REQUIRED = ("unit", "output", "kind")
_NUMBERS = COLUMNS[3:]
_DETECTION = ("detection_50", "detection_90")
_SEPARATE = "separate cells by commas, and write a decimal point in numbers"

EXACT = 0.05
"""Coefficient of variation with which an exact life of a record counts as measured.

The density of computed lives is thus smoothed, by less than lives scatter.
"""

Given = str | Path | xr.Dataset | Sequence[Mapping[str, object]]
"""A file of inspections, CSV or TOML, tables with the same columns, or lives from the field."""

_HEADER = re.compile(r"\s*\[\[\s*[\"']?inspection[\"']?\s*\]\]")


def read_inspections(path: Path) -> list[Inspection]:
    """Read inspections from a CSV file.

    Parameters
    ----------
    path : Path
        Its first line names the columns: ``unit``, ``output``, ``kind``, and those of ``time``,
        ``value``, ``sd``, ``cv``, ``detection_50`` and ``detection_90`` that are needed.

    Returns
    -------
    list of Inspection
        In the order of the lines, at least one.

    Raises
    ------
    InputError
        One line for each mistake.
    """
    inspections = _read_all((f"{path}, line {line}", cells) for line, cells in _lines(path))
    if not inspections:
        raise InputError(f"{path}: has no inspection below its first line")
    return inspections


def read_tables(
    tables: Sequence[Mapping[str, object]], places: Sequence[str] = ()
) -> list[Inspection]:
    """Read inspections from tables, as `read_inspections` from lines.

    Parameters
    ----------
    tables : sequence of dict
        Column -> value.
    places : sequence of str, optional
        Location of each in the source, for messages; by default its number.
    """
    numbers = [f"inspection {number}" for number in range(1, len(tables) + 1)]
    return _read_all(zip(places or numbers, tables, strict=True), _misfit)


def _read_all(
    entries: Iterable[tuple[str, Mapping[str, object]]],
    misfit: Callable[[str, object], Iterable[str]] = lambda name, value: (),
) -> list[Inspection]:
    """Parse inspections from their locations and cells; raise one error with all faults."""
    faults: list[str] = []
    inspections = []
    for where, table in entries:
        given = {name: value for name, value in table.items() if value is not None}
        problems = [problem for name, value in given.items() for problem in misfit(name, value)]
        cells = {name: str(value) for name, value in given.items()}
        numbers, problems = ({}, problems) if problems else _numbers(cells)
        faults += [f"{where}: {problem}" for problem in problems]
        if not problems:
            kind = InspectionKind(cells["kind"])
            inspections.append(
                Inspection(cells["unit"], cells["output"], kind, **numbers, where=where)
            )
    if faults:
        raise InputError(*faults)
    return inspections


def _misfit(name: str, value: object) -> Iterator[str]:
    """Yield the faults of an entry of a table, before it is read."""
    if name not in COLUMNS:
        yield _no_column(name)
    elif name in _NUMBERS:
        if isinstance(value, bool) or not isinstance(value, Real):
            yield f"{name} = {shown(value)}: must be a number, without quotes"
    elif not isinstance(value, str):
        yield f"{name} = {shown(value)}: must be text, in quotes"


def _lines(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    """Yield the number and the cells of each line below the first."""
    if node_kind := node(path):
        raise InputError(f"{path}: is {node_kind}, not a file")
    if not path.is_file():
        names = [entry.name for entry in path.parent.glob("*")] if path.parent.is_dir() else []
        raise InputError(f"{path}: no such file{nearest_file(path.name, names)}")
    try:
        with path.open(newline="", encoding="utf-8-sig") as text:
            rows = csv.reader(text, skipinitialspace=True, strict=True)
            names = [name.strip() for name in next(rows, [])]
            _check_columns(path, names)
            for row in rows:
                cells = [cell.strip() for cell in row]
                if not any(cells):
                    continue
                if len(cells) != len(names):
                    raise InputError(
                        f"{path}, line {rows.line_num}: {len(cells)} of {len(names)} cells;"
                        f" {_SEPARATE}"
                    )
                yield rows.line_num, {n: c for n, c in zip(names, cells, strict=True) if c}
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except csv.Error as error:
        raise InputError(f"{path}, line {rows.line_num}: not CSV: {error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not CSV in UTF-8") from None


def _check_columns(path: Path, names: Sequence[str]) -> None:
    if len(names) == 1 and (";" in names[0] or "\t" in names[0]):
        raise InputError(f"{path}, line 1: {_SEPARATE}")
    faults = [_no_column(name) for name in names if name not in COLUMNS]
    faults += [f"has several columns '{name}'" for name in COLUMNS if names.count(name) > 1]
    faults = faults or [f"has no column '{name}'" for name in _REQUIRED if name not in names]
    if faults:
        raise InputError(*(f"{path}, line 1: {fault}" for fault in faults))


def _no_column(name: str) -> str:
    if not name:
        return "has a column without a name"
    return f"no such column '{name}'{nearest(name, COLUMNS)} (allowed: {', '.join(COLUMNS)})"


def _numbers(cells: Mapping[str, str]) -> tuple[dict[str, float], list[str]]:
    """Return the numbers of an inspection and the faults of its cells."""
    faults = [f"{name} is missing" for name in _REQUIRED if not cells.get(name, "").strip()]
    if not cells.get("unit", "").isprintable():
        faults.append(f"unit = {cells['unit']!r}: must consist of printable characters")
    numbers: dict[str, float] = {}
    for name in _NUMBERS:
        if name in cells:
            try:
                numbers[name] = _number(cells[name])
            except (ValueError, OverflowError):
                since = ", in the unit of the life, since that began" if name == "time" else ""
                faults.append(f"{name} = {cells[name]}: must be a finite number{since}")
    kinds = list(InspectionKind)
    if (kind := cells.get("kind")) and kind not in kinds:
        allowed = f"{nearest(kind, kinds)} (allowed: {', '.join(kinds)})"
        faults.append(f"kind = {kind}: no such kind{allowed}")
    return numbers, faults or list(_conflicts(InspectionKind(cells["kind"]), numbers))


def _number(text: str) -> float:
    if "_" in text or not text.isascii():  # Python accepts these as digits
        raise ValueError
    number = read_number(text)
    if not isfinite(number):
        raise ValueError
    return number


def _conflicts(kind: InspectionKind, numbers: Mapping[str, float]) -> Iterator[str]:
    """Yield numbers that are missing or not allowed for the kind of inspection."""
    given = [name for name in _NUMBERS if name in numbers]
    for name in ("sd", "cv", *_DETECTION):
        if name in numbers and numbers[name] <= 0:
            yield f"{name} = {numbers[name]:g}: must be above 0"
    if numbers.get("cv", 0.0) >= MOST_CV:
        yield f"cv = {numbers['cv']:g}: must be a coefficient of variation, such as 0.1"
    if numbers.get("time", 0.0) < 0:
        yield f"time = {numbers['time']:g}: must not be negative"
    if kind in OUTCOMES:
        if "time" not in given:
            yield f"time is missing: a life has {kind} by a time"
        for name in given:
            if name != "time":
                yield f"{name} = {numbers[name]:g}: leave it out where a unit has {kind}"
        return
    if "sd" in given and "cv" in given:
        yield "sd and cv: give one of them"
    if "cv" in given and numbers.get("value", 1.0) <= 0:
        yield f"value = {numbers['value']:g}: must be above 0 with a cv; or give an sd"
    curve = [name for name in _DETECTION if name in given]
    if kind is InspectionKind.MEASURED:
        if "value" not in given:
            yield "value is missing: what was measured"
        if "sd" not in given and "cv" not in given:
            yield "sd or cv is missing: the error of the measurement"
        if curve:
            yield f"{curve[0]} = {numbers[curve[0]]:g}: only for kinds below and above"
        return
    if curve:
        yield from _curve(curve, numbers)
    elif "value" not in given:
        yield f"value is missing: the limit; or give {' and '.join(_DETECTION)}"


def _curve(curve: Sequence[str], numbers: Mapping[str, float]) -> Iterator[str]:
    """Yield the faults of a detection curve."""
    for name in _DETECTION:
        if name not in curve:
            yield f"{name} is missing beside {curve[0]}"
    for name in ("value", "sd", "cv"):
        if name in numbers:
            yield f"{name} = {numbers[name]:g}: leave it out beside a curve of detection"
    if len(curve) == 2 and not numbers["detection_50"] < numbers["detection_90"]:
        yield (
            f"detection_90 = {numbers['detection_90']:g}: must be above detection_50 ="
            f" {numbers['detection_50']:g}"
        )


def read(given: Given) -> list[Inspection] | Result:
    """Return the inspections of a file or of tables, or a record of lives from the field.

    Raises
    ------
    InputError
        One line for each mistake.
    """
    if isinstance(given, xr.Dataset) or (
        isinstance(given, str | Path) and Path(given).suffix.lower() == ".nc"
    ):
        return _record(Result.of(given))
    if isinstance(given, str | Path) and Path(given).suffix.lower() != ".toml":
        return read_inspections(Path(given))
    if isinstance(given, str | Path):
        inspections = read_tables(*_tables(Path(given)))
    else:
        inspections = read_tables(given)
    if not inspections:
        raise InputError("there is no inspection")
    return inspections


def _record(record: Result) -> Result:
    """Return a record of lives, refused where it is none that rows can be weighted by."""
    if not record.is_field_record:
        raise InputError(
            f"{record.file}: has no lives from the field, but rows of"
            f" '{record.dataset.attrs['model']}'; inspections are CSV, lives come from 'uq import'"
        )
    if record.recorded_life.entered is not None:
        raise InputError(
            f"{record.file}: rows entered late, and what is known given survival to an entry weighs"
            " no single row: import it again without --entered, only rows observed from the start"
        )
    return record


def of_record(record: Result, life: str) -> list[Inspection]:
    """Return the lives of a record as inspections of a lifetime, each of a unit of its own.

    Parameters
    ----------
    record : Result
        Lives from the field: exact, censored or within intervals.
    life : str
        Name of the lifetime.

    Returns
    -------
    list of Inspection
        An exact life is measured with the coefficient of variation `EXACT`; of others it is known
        that they survived their lower bound and ended by their upper one.
    """
    element, name = record.recorded_life, str(record.study.study.name)
    inspections = []
    highs = np.where(element.censored, np.inf, element.values)
    if element.high is not None:
        highs = np.where(element.censored, element.high, element.values)
    for row, (low, high) in enumerate(zip(element.values.tolist(), highs.tolist(), strict=True)):
        unit, where = f"{name} {row}", f"{record.file}, row {row}"
        if 0 < low == high:
            measured = Inspection(
                unit, life, InspectionKind.MEASURED, value=low, cv=EXACT, where=where
            )
            inspections.append(measured)
            continue
        for kind, time in ((InspectionKind.SURVIVED, low), (InspectionKind.ENDED, high)):
            is_open = time == 0 if kind is InspectionKind.SURVIVED else time == inf
            if not is_open:
                inspections.append(Inspection(unit, life, kind, time, where=where))
    return inspections


def _tables(path: Path) -> tuple[list[Mapping[str, object]], list[str]]:
    """Return the tables ``[[inspection]]`` of a TOML file and their locations."""
    if node_kind := node(path):
        raise InputError(f"{path}: is {node_kind}, not a file")
    try:
        text = path.read_text(encoding="utf-8-sig")
        data = read_toml(text)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"{path}: not TOML: {error}") from None
    tables = data.get("inspection", [])
    if (
        list(data) != ["inspection"]
        or not isinstance(tables, list)
        or not all(isinstance(table, dict) for table in tables)
    ):
        raise InputError(f"{path}: must consist of tables [[inspection]]")
    begin = [n for n, line in enumerate(text.splitlines(), start=1) if _HEADER.match(line)]
    if len(begin) == len(tables):
        return tables, [f"{path}, inspection at line {number}" for number in begin]
    return tables, [f"{path}: inspection {number + 1}" for number in range(len(tables))]


def all_of(previous: Sequence[Inspection], new: Sequence[Inspection]) -> list[Inspection]:
    """Combine the inspections already used by a result with new ones.

    Raises
    ------
    InputError
        One line for each inspection used before, and for each life observed running after its end.
    """
    used, faults = [*previous], []
    for inspection in new:
        if inspection in used:
            place = used.index(inspection)
            by = "this result" if place < len(previous) else used[place].where
            faults.append(
                f"{inspection.where} (unit {inspection.unit}, {inspection.output},"
                f" {inspection.kind}): already used by {by}; a measurement counts once"
            )
        used.append(inspection)
    faults += [
        f"{running.where} (unit {running.unit}, {running.output}): survived"
        f" until {running.time:g}, but had ended by {end.time:g} ({end.where})"
        for running in used
        for end in used
        if (running.kind, end.kind) == (InspectionKind.SURVIVED, InspectionKind.ENDED)
        and (running.unit, running.output) == (end.unit, end.output)
        and (running.time or 0.0) >= (end.time or 0.0)
    ]
    if faults:
        raise InputError(*faults)
    return used
