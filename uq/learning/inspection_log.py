"""All inspections of a result, each used once."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from uq.errors import InputError
from uq.files.paths import node
from uq.learning.inspections import Inspection, InspectionKind, read_inspections, read_tables
from uq.text.literals import read_toml

Given = str | Path | Sequence[Mapping[str, object]]
"""A file of inspections, CSV or TOML, or tables with the same columns."""

_HEADER = re.compile(r"\s*\[\[\s*[\"']?inspection[\"']?\s*\]\]")


def read(given: Given) -> list[Inspection]:
    """Return the inspections of a file or of tables."""
    if isinstance(given, str | Path) and Path(given).suffix.lower() != ".toml":
        return read_inspections(Path(given))
    if isinstance(given, str | Path):
        inspections = read_tables(*_tables(Path(given)))
    else:
        inspections = read_tables(given)
    if not inspections:
        raise InputError("there is no inspection")
    return inspections


def _tables(path: Path) -> tuple[list[Mapping[str, object]], list[str]]:
    """Return the tables ``[[inspection]]`` of a TOML file, and where each is written."""
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
    """Return the inspections that a result has been updated with, and new ones.

    Raises
    ------
    InputError
        One line for each that has been used, and for each life that was seen running after its end.
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
