"""Differences between two studies of one model: inputs, settings, design."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from uq.contract import Floats
from uq.result.result import Result
from uq.study.file import DependenceTable, StudyFile, Tied
from uq.text.literals import shown
from uq.text.numbers import law


class ChangedEntry(NamedTuple):
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


class InputMoments(NamedTuple):
    """Mean and standard deviation of an input in its unit; sd 0 for a fixed value."""

    mean: float
    sd: float


class OnlyChange(NamedTuple):
    """The only input that differs between two studies, with its spread in each."""

    name: str
    units: str
    first: InputMoments
    second: InputMoments


def changes(first: Result, second: Result) -> list[ChangedEntry]:
    """Return all differences between two studies, apart from [analysis].

    Parameters
    ----------
    first, second : Result
        Results of one model.

    Returns
    -------
    list of ChangedEntry
    """
    sides = [(result, result.study) for result in (first, second)]
    return [*_frame(sides), *_inputs(sides)]


Side = tuple[Result, StudyFile]


def _frame(sides: list[Side]) -> Iterator[ChangedEntry]:
    frames = [dict(_entries(*side)) for side in sides]
    for place in dict.fromkeys((*frames[0], *frames[1])):
        first, other = (shown(f[place]) if place in f else "default" for f in frames)
        if first != other:
            yield ChangedEntry(*place, first, other)
    ranks = [
        study.dependence.model_dump(exclude={"source"}) if study.dependence else None
        for _, study in sides
    ]
    if ranks[0] != ranks[1]:
        parameters = (_dependence(study.dependence) for _, study in sides)
        yield ChangedEntry("dependence", "rank correlations", *parameters)


def _dependence(table: DependenceTable | None) -> str:
    """Return the dependent parameters, and their copula if it is not the normal one."""
    if table is None:
        return "none"
    rank = f"{table.words}, {table.rank_correlation[0][1]:g}" if table.words else ""
    return ", ".join(table.parameters) + f" ({rank})" * bool(rank)


def _entries(result: Result, study: StudyFile) -> Iterator[tuple[tuple[str, str], Any]]:
    yield ("model", "version"), result.dataset.attrs["model_version"]
    for name in ("design", "samples", "replicates", "seed"):
        value = result.dataset.attrs[name]
        yield ("design", name), value if isinstance(value, str) else int(value)
    for name, value in study.settings.items():
        yield ("setting", name), value


def _inputs(sides: list[Side]) -> Iterator[ChangedEntry]:
    first, second = (result.dataset for result, _ in sides)
    for name, variable in first.data_vars.items():
        if variable.attrs.get("role") in ("input", "fixed") and name in second:
            stated, other = (_stated(*side, str(name)) for side in sides)
            if stated != other:
                yield ChangedEntry("input", str(name), stated[0], other[0])


def _stated(result: Result, study: StudyFile, name: str) -> tuple[str, Any]:
    """Return an input in words, and all that determines its rows."""
    unit = result.dataset[name].attrs["units"]
    behind = "" if unit == "1" else f" {unit}"
    entry = study.uncertain.get(name)
    if entry is None:
        value = result.dataset[name].values.tolist()
        if isinstance(value, list):  # imported rows
            return "as imported", value
        return f"{value!r}{behind}", value
    if isinstance(entry, Tied):
        return f"equals {entry.equals}", entry.equals
    stated = law(entry) + behind if entry.times is None else f"{entry.times} times {law(entry)}"
    return stated, entry.model_dump(exclude={"source", "file", "column"}, exclude_none=True)


def only_change(first: Result, second: Result, entries: list[ChangedEntry]) -> OnlyChange | None:
    """Return the only input that differs, if nothing else but the design does."""
    decisive = [change for change in entries if change.kind != "design"]
    if [change.kind for change in decisive] != ["input"]:
        return None
    name = decisive[0].name
    spreads = (_spread(result.independent.dataset[name].values) for result in (first, second))
    return OnlyChange(name, str(first.dataset[name].attrs["units"]), *spreads)


def _spread(values: Floats) -> InputMoments:
    return InputMoments(float(values.mean()), float(values.std(ddof=1)) if values.size > 1 else 0.0)
