"""Parser of a study file: syntax and schema of its tables, with one error line per fault."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import lru_cache
from typing import Any

from pydantic import BaseModel, ValidationError

from uq.contract import Model
from uq.errors import InputError, first_fault_alone, one_line
from uq.sampling.designs import IMPORTED
from uq.sampling.input_faults import MISSING, InputFault, fault_of
from uq.sampling.laws import LAWS, law_fault, listed_once
from uq.sampling.named_values import setting_types
from uq.study.changes import study_text
from uq.study.file import DependenceTable, StudyFile, Tied, Tolerance, Until
from uq.text.literals import key as written_key
from uq.text.literals import read_toml, toml
from uq.text.quantities import misfit, read_quantity

_MOST_ENTRIES = 2_000  # per table; the time to find faults grows with its square


def read_study_text(text: str, source: str = "study") -> StudyFile:
    """Return the study file from its text, checked without its model.

    Parameters
    ----------
    text : str
        Complete TOML text.
    source : str
        Name of the text in error lines.

    Returns
    -------
    StudyFile

    Raises
    ------
    InputError
        One line per fault of syntax or schema.
    """
    return read_study_tables(parse(text, source), source)


def read_study_tables(data: dict[str, Any], source: str) -> StudyFile:
    """Return the study file from its parsed text; raise `InputError` with one line per fault."""
    if faults := shape_faults(data):
        raise InputError(*(f"{source}: {fault.line}" for fault in faults))
    return StudyFile.model_validate(data)


@lru_cache(maxsize=2)
@first_fault_alone()
def study_of_result(text: str) -> StudyFile:
    """Return the study stored in a result; raise `InputError` with one line if it is invalid."""
    return read_study_text(text, "study of this result")


def parse(text: str, source: str) -> dict[str, Any]:
    """Return parsed TOML; raise `InputError` with the number of the invalid line."""
    try:
        data = read_toml(text)
    except (ValueError, OverflowError, RecursionError) as error:
        problem = f"not valid TOML: {one_line(error)}{_remedy(text, str(error))}"
        raise InputError(f"{source}: {problem}") from error
    for name, table in (("", data), *data.items()):
        if isinstance(table, dict) and len(table) > _MOST_ENTRIES:
            where = f"[{written_key(name)}]" if name else "it"
            problem = f"has {len(table)} entries (allowed: at most {_MOST_ENTRIES})"
            raise InputError(f"{source}: {where} {problem}")
    return data


_AT_LINE = re.compile(r"at line (\d+)")
_COMMA = re.compile(r"=\s*([-+]?\d+),(\d+)\s*(?:#|$)")
_UNIT = re.compile(r"=\s*([-+\d.]+(?:e[-+]?\d+)?\s*[^\W\d_][^,}#\n]*)")
_WORD = re.compile(r"=\s*([^\W\d_][\w .-]*?)\s*(?:[,}#]|$)")


def _remedy(text: str, problem: str) -> str:
    """Return how to mend the line of a fault of syntax, or ""."""
    match, lines = _AT_LINE.search(problem), text.splitlines()
    if match is None or not 1 <= int(match[1]) <= len(lines):
        return ""
    line = lines[int(match[1]) - 1]
    if comma := _COMMA.search(line):
        return f"; numbers have a decimal point: {comma[1]}.{comma[2]}"
    if line.startswith("[") and "]" not in line:
        return f"; close the bracket: {line.strip()}]"
    for pattern in (_UNIT, _WORD):
        if (word := pattern.search(line)) and word[1] not in ("true", "false", "inf", "nan"):
            return f'; text has quotes: "{word[1].strip()}"'
    return ""


def shape_faults(data: dict[str, Any]) -> list[InputFault]:
    """Return all schema faults of a parsed study file."""
    design, faults = data.get("design"), []
    if isinstance(design, dict) and "samples" not in design:
        if design.get("method") not in IMPORTED:  # a file of rows defines its own size
            faults.append(InputFault(("design", "samples"), MISSING))
    try:
        StudyFile.model_validate(data)
    except ValidationError as invalid:
        faults += [_fault(dict(error)) for error in invalid.errors(include_url=False)]
    meant = [fault for fault in faults if not any(_is_meant(fault, other) for other in faults)]
    return listed_once(meant)


def _is_meant(missing: InputFault, other: InputFault) -> bool:
    """Return whether the unknown key of another fault is probably a misspelt missing key."""
    *table, key = missing.path
    beside = missing.problem.startswith(MISSING) and other.path[:-1] == tuple(table)
    return beside and f"did you mean '{key}'?" in other.problem


_PLAIN = ("distribution", "source", "times", "level", "equals", "file", "column")
"""Keys of an uncertain input that are no numbers."""


def in_units_of(model: Model, data: dict[str, Any]) -> dict[tuple[str, ...], str]:
    """Convert quantities with units in [fixed], [uncertain] and [settings], in place.

    Parameters
    ----------
    model : Model
    data : dict
        Parsed study file. Text with a number and a unit becomes a number in the unit of the
        parameter or setting; an argument without a unit, such as `cv`, may be in per cent.

    Returns
    -------
    dict of tuple of str to str
        Path -> why the unit of its quantity, which stays as it is, does not fit.
    """
    misfits: dict[tuple[str, ...], str] = {}

    def convert(entries: Any, key: Any, units: str, path: tuple[str, ...]) -> None:
        misfits.update(_converted(entries, key, units, path))

    def table(name: str) -> dict[str, Any]:
        return entries if isinstance(entries := data.get(name), dict) else {}

    for name in {*table("fixed")} & {*model.parameter_names}:
        entries, key = table("fixed"), name
        if isinstance(entries[name], dict):
            entries, key = entries[name], "value"
        if key in entries:
            convert(entries, key, model.parameter(name).unit, ("fixed", name))
    for name in {*table("uncertain")} & {*model.parameter_names}:
        misfits |= law_in_units(table("uncertain")[name], name, model.parameter(name).unit)
    kinds = setting_types(model)
    for name in {*table("settings")} & {*kinds}:
        declared = model.setting(name)
        if not declared.choices and "str" not in str(kinds[name]):
            convert(table("settings"), name, declared.unit, ("settings", name))
        elif kinds[name] == tuple[float | str, ...]:  # text of another unit has its own meaning
            convert(table("settings"), name, declared.unit, ("settings", name))
            for path in [path for path in misfits if path[:2] == ("settings", name)]:
                del misfits[path]
    return misfits


def law_in_units(entry: Any, name: str, unit: str) -> dict[tuple[str, ...], str]:
    """Convert the quantities in one table of [uncertain], in place; see `in_units_of`.

    Parameters
    ----------
    entry : object
        As parsed; anything but a table stays as it is.
    name : str
        Parameter.
    unit : str
        CF unit of the parameter.
    """
    misfits: dict[tuple[str, ...], str] = {}
    if isinstance(entry, dict):
        law = LAWS.get(str(entry.get("distribution")))
        for key in [key for key in entry if key not in _PLAIN]:
            is_pure = "times" in entry or (law is not None and key in law.pure)
            misfits |= _converted(entry, key, "1" if is_pure else unit, ("uncertain", name, key))
    return misfits


def _converted(
    entries: Any, key: Any, units: str, path: tuple[str, ...]
) -> dict[tuple[str, ...], str]:
    """Convert one entry, or each of a list, in place; return why its unit does not fit."""
    if isinstance(values := entries[key], list):
        lines = [_converted(values, i, units, (*path, str(i))) for i in range(len(values))]
        return {place: why for line in lines for place, why in line.items()}
    try:
        entries[key] = _in_unit(values, path[2 if path[0] == "uncertain" else 1], units)
    except InputError as fault:
        return {path: str(fault)}
    return {}


def _in_unit(value: Any, name: str, units: str) -> Any:
    """Return a value in a CF unit if it is a quantity with a unit, else as it is."""
    if not isinstance(value, str):
        return value
    try:
        problem, number = misfit(value, name, units), float(read_quantity(value, units))
    except ValueError:
        return value  # no quantity: a fault of the schema
    if problem:
        raise InputError(problem)
    return number


def with_numbers(text: str, data: dict[str, Any]) -> str:
    """Return the text of a study file with the numbers that `in_units_of` has put into its data.

    The text keeps its comments where each quantity is found as it was written.
    """
    before = read_toml(text)
    if before == data:
        return text
    for quantity, number in dict(_replaced(before, data)).items():
        written = rf"\"{re.escape(quantity)}\"|'{re.escape(quantity)}'"
        text = re.sub(written, toml(number), text)
    with suppress(ValueError):
        if read_toml(text) == data:
            return text
    return study_text(data)


def _replaced(before: Any, after: Any) -> Iterator[tuple[str, float]]:
    """Yield each text that became a number."""
    if isinstance(before, str) and not isinstance(after, str):
        yield before, after
    elif isinstance(before, dict | list):
        keys = before if isinstance(before, dict) else range(len(before))
        for key in keys:
            yield from _replaced(before[key], after[key])


def sound_entries(data: dict[str, Any], faults: list[InputFault]) -> dict[str, dict[str, Any]]:
    """Return the entries without schema faults, for further checks.

    Parameters
    ----------
    data : dict
        Parsed file.
    faults : list of InputFault
        Result of `shape_faults`.

    Returns
    -------
    dict
        Every table of a study file, possibly empty: key -> value as parsed.
    """
    broken = {fault.path for fault in faults if len(fault.path) == 1}
    sound = {
        table: {} if (table,) in broken else dict(data.get(table, {}))
        for table in StudyFile.model_fields
    }
    for key, value in sound["analysis"].items():
        sound["analysis"][key] = value.copy() if isinstance(value, list | dict) else value
    # From the end, so that indices in a list stay valid until they are removed.
    for path in sorted((fault.path for fault in faults if len(fault.path) > 1), reverse=True):
        _remove(sound, path[:3] if path[0] == "analysis" else path[:2])
    return sound


def _remove(entries: Any, path: tuple[str | int, ...]) -> None:
    *way, last = path
    for part in way:
        entries = entries.get(part, {}) if isinstance(entries, dict) else {}
    if isinstance(entries, dict):
        entries.pop(last, None)
    elif isinstance(entries, list) and isinstance(last, int) and last < len(entries):
        del entries[last]


def _fault(error: dict[str, Any]) -> InputFault:
    path = list(error["loc"])
    if path[0] != "uncertain" or len(path) < 2:
        return fault_of(error, _allowed)
    law: type[BaseModel] | None = None
    if len(path) > 2:  # pydantic adds the kind of entry and the name of the law
        tied = path.pop(2) == "equals"
        law = Tied if tied else LAWS[path.pop(2)] if len(path) > 2 else None
    return law_fault({**error, "loc": path}, law)


def _allowed(path: Sequence[Any]) -> tuple[str, list[str]]:
    """Return the kind and the names of the keys allowed in place of an unknown key."""
    if len(path) == 1:
        return "table", list(StudyFile.model_fields)
    if len(path) == 3:
        return "key", list(Until.model_fields if path[1] == "until" else Tolerance._fields)
    table: Any = StudyFile.model_fields[path[0]].annotation
    return "key", list((DependenceTable if path[0] == "dependence" else table).model_fields)
