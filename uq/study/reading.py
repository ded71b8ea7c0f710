"""From the text of a study file to its tables: syntax and shape, every fault in a line."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ValidationError

from uq.designs.registry import IMPORTED
from uq.errors import InputError, nearest
from uq.inputs.faults import Fault
from uq.inputs.law import Law
from uq.inputs.registry import LAWS
from uq.literals import read_toml
from uq.study.file import DependenceTable, StudyFile, Tied, Tolerance


def read_study_text(text: str, source: str = "study") -> StudyFile:
    """Read the text of a study without its model.

    Parameters
    ----------
    text : str
        The whole TOML.
    source : str
        What error lines call it.

    Returns
    -------
    StudyFile

    Raises
    ------
    InputError
        One line per fault of syntax or shape.
    """
    data = parse(text, source)
    faults = shape_faults(data)
    if faults:
        raise InputError(*(f"{source}: {fault.line}" for fault in faults))
    return StudyFile.model_validate(data)


def parse(text: str, source: str) -> dict[str, Any]:
    """Read TOML; raise `InputError` with the line where it goes wrong."""
    try:
        return read_toml(text)
    except (ValueError, OverflowError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{source}: not valid TOML: {reason}") from error


def shape_faults(data: dict[str, Any]) -> list[Fault]:
    """Return what is wrong with the shape of a parsed study file, all of it."""
    faults = list(_size_faults(data))
    try:
        StudyFile.model_validate(data)
    except ValidationError as invalid:
        faults += [_fault(dict(error)) for error in invalid.errors(include_url=False)]
    return [fault for fault in faults if not any(_is_meant(fault, other) for other in faults)]


def _size_faults(data: dict[str, Any]) -> Iterator[Fault]:
    """Yield whether a design lacks its size: a file of rows has its own."""
    design = data.get("design")
    if not isinstance(design, dict) or "samples" in design:
        return
    if design.get("method") not in IMPORTED:
        yield Fault(("design", "samples"), _MISSING)


def _is_meant(missing: Fault, other: Fault) -> bool:
    """Whether what is missing is what another fault's key is told to mean."""
    *table, key = missing.path
    beside = missing.problem.startswith(_MISSING) and other.path[:-1] == tuple(table)
    return beside and f"did you mean '{key}'?" in other.problem


def sound_entries(data: dict[str, Any], faults: list[Fault]) -> dict[str, dict[str, Any]]:
    """Return the entries without a fault of shape, so that the rest is checked all the same.

    Parameters
    ----------
    data : dict
        As parsed.
    faults : list of Fault
        What `shape_faults` found.

    Returns
    -------
    dict
        Every table of a study file, perhaps empty: key -> value as parsed.
    """
    broken = {fault.path for fault in faults if len(fault.path) == 1}
    sound = {
        table: {} if (table,) in broken else dict(data.get(table, {}))
        for table in StudyFile.model_fields
    }
    for key, value in sound["analysis"].items():
        sound["analysis"][key] = value.copy() if isinstance(value, list | dict) else value
    # From the end, so that places in a list keep their number until their turn.
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


def _fault(error: dict[str, Any]) -> Fault:
    path, value, law = list(error["loc"]), error["input"], None
    if path[0] == "uncertain" and len(path) > 2:
        # Pydantic puts into the path what kind of entry it is, and then the law's name.
        tied = path.pop(2) == "equals"
        law = Tied if tied else LAWS[path.pop(2)] if len(path) > 2 else None
    match error["type"]:
        case "extra_forbidden":
            kind, known = _beside(path, law)
            problem = f"no such {kind}{nearest(str(path[-1]), known)} (allowed: {', '.join(known)})"
            return Fault(tuple(path), problem, value)
        case "missing":
            return Fault(tuple(path), _MISSING)
        case "union_tag_not_found":
            for key, given in value.items():
                if meant := nearest(key, ["distribution"]):
                    return Fault((*path, key), f"no such key{meant}", given)
            return Fault((*path, "distribution"), f"{_MISSING} (one of {', '.join(LAWS)})")
        case "union_tag_invalid":
            name = error["ctx"]["tag"]
            problem = f"no such law{nearest(name, LAWS)} (allowed: {', '.join(LAWS)})"
            return Fault((*path, "distribution"), problem, name)
    template = _REASONS.get(error["type"], "")
    reason = template.format(**error.get("ctx", {})) or error["msg"]
    return Fault(tuple(path), reason, value)


def _beside(path: list[Any], law: type[BaseModel] | None) -> tuple[str, list[str]]:
    """Return what could stand where something unknown stands: kind and names."""
    if law is not None:
        common = list(Law.model_fields)[1:] if law is not Tied else []  # last, but the source
        own = [name for name in law.model_fields if name not in common]
        return f"argument of {path[1]}'s law", own + common
    if len(path) == 1:
        return "table", list(StudyFile.model_fields)
    if len(path) == 3:
        return "key", list(Tolerance._fields)
    table: Any = StudyFile.model_fields[path[0]].annotation
    if path[0] == "dependence":
        table = DependenceTable
    return "key", list(table.model_fields)


_MISSING = "is missing"
_REASONS = {
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "dict_type": "must be a table",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "int_type": "must be a whole number, without a decimal point",
    "bool_type": "must be true or false",
    "string_type": "must be a text in quotes",
    "string_too_long": "must have at most {max_length} characters",
    "string_pattern_mismatch": "must consist of letters, digits, '-' and '_'",
    "tuple_type": "must be a list",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le}",
    "value_error": "{error}",
}
