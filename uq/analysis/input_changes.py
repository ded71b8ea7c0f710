"""Differences between two studies of one model: inputs, settings, design."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import xarray as xr

from uq.literals import shown
from uq.rows.elements import independent_rows, study_file_of
from uq.study.file import StudyFile, Tied
from uq.wording import law


class Change(NamedTuple):
    """One entry that differs between two studies.

    Attributes
    ----------
    kind : str
        ``model``, ``design``, ``setting``, ``dependence`` or ``input``.
    name : str
    first, second : str
        In words.
    """

    kind: str
    name: str
    first: str
    second: str


class Spread(NamedTuple):
    """Mean and standard deviation of an input, in its unit; 0 where it is one number."""

    mean: float
    sd: float


def changes(first: xr.Dataset, second: xr.Dataset) -> list[Change]:
    """Return all differences between two studies, apart from [analysis].

    Parameters
    ----------
    first, second : xarray.Dataset
        Results of one model.

    Returns
    -------
    list of Change
    """
    return [*_frame(first, second), *_inputs(first, second)]


def _frame(first: xr.Dataset, second: xr.Dataset) -> Iterator[Change]:
    studies = study_file_of(first), study_file_of(second)
    frames = [dict(_entries(ds, study)) for ds, study in zip((first, second), studies, strict=True)]
    for place in dict.fromkeys((*frames[0], *frames[1])):
        one, other = (shown(f[place]) if place in f else "default" for f in frames)
        if one != other:
            yield Change(*place, one, other)
    ranks = [
        study.dependence.model_dump(exclude={"source"}) if study.dependence else None
        for study in studies
    ]
    if ranks[0] != ranks[1]:
        told = (", ".join(one["parameters"]) if one else "none" for one in ranks)
        yield Change("dependence", "rank correlations", *told)


def _entries(ds: xr.Dataset, study: StudyFile) -> Iterator[tuple[tuple[str, str], Any]]:
    yield ("model", "version"), ds.attrs["model_version"]
    for name in ("design", "samples", "replicates", "seed"):
        value = ds.attrs[name]
        yield ("design", name), value if isinstance(value, str) else int(value)
    for name, value in study.settings.items():
        yield ("setting", name), value


def _inputs(first: xr.Dataset, second: xr.Dataset) -> Iterator[Change]:
    studies = study_file_of(first), study_file_of(second)
    for name, variable in first.data_vars.items():
        if variable.attrs["role"] in ("input", "fixed") and name in second:
            one, other = (
                _stated(ds, study, str(name))
                for ds, study in zip((first, second), studies, strict=True)
            )
            if one != other:
                yield Change("input", str(name), one[0], other[0])


def _stated(ds: xr.Dataset, study: StudyFile, name: str) -> tuple[str, Any]:
    """Return an input in words, and all that determines its rows."""
    unit = ds[name].attrs["units"]
    behind = "" if unit == "1" else f" {unit}"
    entry = study.uncertain.get(name)
    if entry is None:
        value = ds[name].values.tolist()
        if isinstance(value, list):  # imported rows
            return "as imported", value
        return f"{value!r}{behind}", value
    if isinstance(entry, Tied):
        return f"equals {entry.equals}", entry.equals
    told = f"{entry.times} times {law(entry)}" if entry.times is not None else law(entry) + behind
    return told, entry.model_dump(exclude={"source", "file", "column"}, exclude_none=True)


def spread(ds: xr.Dataset, name: str) -> Spread:
    """Return how an input of a result scatters among its independent rows."""
    values = independent_rows(ds)[name].values
    return Spread(float(values.mean()), float(values.std(ddof=1)) if values.size > 1 else 0.0)


def only_change(found: list[Change]) -> str | None:
    """Return the only input in which two studies differ, if nothing but their design does, too."""
    decisive = [change for change in found if change.kind != "design"]
    return decisive[0].name if [change.kind for change in decisive] == ["input"] else None
