"""All inspections of a result, each used once."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import xarray as xr

from uq.errors import InputError
from uq.learning.inspections import Inspection, read_inspections, read_tables
from uq.learning.result import inspections_of
from uq.literals import read_toml
from uq.places import node

Given = str | Path | Sequence[Mapping[str, object]]
"""A file of inspections, CSV or TOML, or tables with the same columns."""


def read(given: Given) -> list[Inspection]:
    """Return the inspections of a file or of tables."""
    if isinstance(given, str | Path) and Path(given).suffix.lower() != ".toml":
        return read_inspections(Path(given))
    if isinstance(given, str | Path):
        found = read_tables(_tables(Path(given)), f"{given}: [[inspection]]")
    else:
        found = read_tables(given, "inspection")
    if not found:
        raise InputError("there is no inspection")
    return found


def _tables(path: Path) -> list[Mapping[str, object]]:
    """Return the tables ``[[inspection]]`` of a TOML file."""
    if what := node(path):
        raise InputError(f"{path}: is {what}, not a file")
    try:
        data = read_toml(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"{path}: not TOML: {error}") from None
    tables = data.get("inspection", [])
    if list(data) != ["inspection"] or not isinstance(tables, list):
        raise InputError(f"{path}: must consist of tables [[inspection]]")
    if not all(isinstance(one, dict) for one in tables):
        raise InputError(f"{path}: must consist of tables [[inspection]]")
    return tables


def all_of(ds: xr.Dataset, new: Sequence[Inspection]) -> list[Inspection]:
    """Return the inspections that a result has been updated with, and new ones.

    Raises
    ------
    InputError
        One line for each that has been used.
    """
    used, faults = inspections_of(ds), []
    count = len(used)
    for number, one in enumerate(new, start=1):
        if one in used:
            where = "by this result" if used.index(one) < count else "in these inspections"
            faults.append(
                f"inspection {number} (unit {one.unit}, {one.output}, {one.kind}): already used"
                f" {where}; a measurement counts once"
            )
        used.append(one)
    if faults:
        raise InputError(*faults)
    return used
