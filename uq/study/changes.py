"""Differences between a study and the one for which rows were computed."""

from collections.abc import Iterator
from typing import Any

from uq.sampling.designs import DESIGNS
from uq.study.definition import Study
from uq.text.literals import read_toml, shown

_FREE = {("study", "name"), ("study", "description"), ("design", "samples"), ("design", "until")}
"""Entries on which no row depends."""


def what_changed(text: str, model_version: str, study: Study) -> str:
    """Return the first difference between a study and the study of computed rows.

    Parameters
    ----------
    text : str
        The study file of the rows.
    model_version : str
        The version of the model that computed them.
    study : Study
        With another identity.

    Returns
    -------
    str
        The first difference, such as ``[design] seed = 5, now 6``.
    """
    try:
        before = dict(_entries(read_toml(text)))
    except (ValueError, OverflowError, RecursionError):
        before = {}
    now = dict(_entries(read_toml(study.text)))
    if study.design.rows_of_a_sample == 1:  # then no row depends on a level
        before, now = (
            {place: value for place, value in entries.items() if place[2:] != ("level",)}
            for entries in (before, now)
        )
    for place in before | now:
        if before.get(place) != now.get(place):
            *tables, name = place
            old, new = (
                shown(entry[place]) if place in entry else "nothing" for entry in (before, now)
            )
            return f"[{'.'.join(tables)}] {name} = {old}, now {new}"
    if model_version != study.model.version:
        return f"version {model_version} of model '{study.model.name}', now {study.model.version}"
    if list(before) != list(now):
        return "the order of [uncertain]"
    return f"the nominal values or default settings of model '{study.model.name}'"


def refusal_to_extend(study: Study) -> str | None:
    """Return why more samples cannot be appended to the rows of a study, or None."""
    method = study.design.method
    if DESIGNS[method].append_only:
        return None
    return (
        f"a '{method}' design cannot be extended: all its rows change with their number; run it "
        "again, into another output or with --fresh"
    )


def _entries(table: dict[str, Any], path: tuple[str, ...] = ()) -> Iterator[tuple[Any, Any]]:
    """Yield place and value of every entry on which rows depend."""
    for name, value in table.items():
        place = (*path, name)
        if (
            place[0] == "analysis"
            or place[:2] in _FREE
            or (path[:1] == ("uncertain",) and name == "source")
        ):
            continue
        if isinstance(value, dict) and len(path) < 2:
            yield from _entries(value, place)
        else:
            yield place, value
