"""All inspections of a result, each used once."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import xarray as xr

from uq.errors import InputError
from uq.learning.inspections import Inspection, read_inspections, read_tables
from uq.learning.result import inspections_of

Given = str | Path | Sequence[Mapping[str, object]]
"""A file of inspections, or tables with the same columns."""


def read(given: Given) -> list[Inspection]:
    """Return the inspections of a file or of tables."""
    if isinstance(given, str | Path):
        return read_inspections(Path(given))
    found = read_tables(given, "inspection")
    if not found:
        raise InputError("there is no inspection")
    return found


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
