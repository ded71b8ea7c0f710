"""The times from the beginning of a life that are asked for, in the unit of the lives."""

from collections.abc import Iterator, Sequence
from math import inf

import xarray as xr

from uq.contract import Output
from uq.errors import InputError, choices
from uq.rows.elements import analysis_of, shown_outputs
from uq.rows.variables import outputs_of
from uq.written import read_threshold


def shown_lives(ds: xr.Dataset) -> Iterator[tuple[str, Output]]:
    """Yield the lives that a result shows and that end, not succeed."""
    declared = outputs_of(ds)
    for name in shown_outputs(ds, analysis_of(ds)):
        if declared[name].is_lifetime and not declared[name].success:
            yield name, declared[name]


def read_times(option: str, texts: Sequence[str], ds: xr.Dataset) -> list[float]:
    """Return times that an option of the command line gives, with or without a unit.

    Parameters
    ----------
    option : str
        Such as ``--by``.
    texts : sequence of str
    ds : xarray.Dataset
        Whose lives they are times of.

    Raises
    ------
    InputError
        When one is no such time, in a unit that does not fit, or lives are in several units.
    """
    if not texts:
        return []
    units = list({output.unit: None for _, output in shown_lives(ds)})
    if len(units) != 1:
        found = f"lives are in several units ({choices(units)})" if units else "no life is shown"
        raise InputError(f"{option} {texts[0]}: {found}; name one life in [analysis] outputs")
    times = [read_threshold(option, text, "a life", units[0]) for text in texts]
    check_times(times, option)
    return times


def check_times(times: Sequence[float], asked_by: str) -> None:
    """Refuse times that are negative or not finite."""
    if wrong := [time for time in times if not 0 <= time < inf]:
        raise InputError(f"{asked_by}: time = {wrong[0]:g}: must be finite, and 0 or more")
