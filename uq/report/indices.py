"""What a report says of sensitivities: one table for each target of each method."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import xarray as xr

from uq.analysis.findings import Findings
from uq.drawing.figure import sentence, with_symbol
from uq.drawing.index_plot import subject
from uq.errors import InputError
from uq.indices.sensitivities import methods
from uq.indices.targets import FORMS, split_name
from uq.report.cells import Cell, Table
from uq.report.pictures import Picture, pictures
from uq.wording import index, index_interval

_SHARES, _LEAST = ("S1", "ST", "shapley"), 0.05
"""Of these shares of a variance, less than that is not worth a sentence of its own."""


class Subject(NamedTuple):
    """The indices of one target by one method.

    Attributes
    ----------
    name : str
    words : str
    refused : str
        Why there are none, or "".
    tables : list of Table
    pictures : tuple of Picture
    notes : list of str
    leading : str
        A sentence on the input with the largest index; "" where none is larger than that of an
        input without effect.
    """

    name: str
    words: str
    refused: str = ""
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    notes: tuple[str, ...] = ()
    leading: str = ""


class Method(NamedTuple):
    """What one method has to say; where it has nothing at all, ``refused`` says why."""

    name: str
    refused: str = ""
    used: str = ""
    subjects: tuple[Subject, ...] = ()


Drawn = defaultdict[tuple[str, str], list[Picture]]
"""Method and target -> their figures."""


def sensitivity_of(findings: Findings) -> list[Method]:
    """Return the indices by every method that the study asks for.

    Parameters
    ----------
    findings : Findings

    Returns
    -------
    list of Method
    """
    drawn: Drawn = defaultdict(list)
    for of, picture in pictures(findings, "sensitivities"):
        drawn[of.method, of.name].append(picture)
    return [_method(findings, name, drawn) for name in methods(findings.ds)]


def _method(findings: Findings, name: str, drawn: Drawn) -> Method:
    try:
        found = findings.sensitivities(name)
    except InputError as error:
        return Method(name, refused=str(error))
    used = f"Of {found['rows_used']} rows"
    if found["groups_dropped"]:
        used += (
            f", {found['groups_dropped']} groups dropped for lack of a value in some of their rows"
        )
    subjects = (
        _subject(findings.ds, name, label, entry, drawn[name, label])
        for label, entry in found["outputs"].items()
    )
    return Method(name, used=used, subjects=tuple(subjects))


def _subject(
    ds: xr.Dataset, method: str, name: str, entry: Mapping[str, Any], drawn: Sequence[Picture]
) -> Subject:
    words = " ".join(subject(ds, name).split())
    if "refused" in entry:
        return Subject(name, words, refused=entry["refused"])
    kinds = {kind: value for kind, value in entry.items() if _is_index(value)}
    pairs = {"S2": kinds.pop("S2")} if "S2" in kinds else {}
    dummy = entry.get("dummy", {})
    told: tuple[tuple[str, Mapping[str, Any], Mapping[str, float]], ...] = (
        (f"Indices of {name}", kinds, dummy),
        (f"Second order, of {name}", pairs, {}),
    )
    tables = tuple(_table(*one) for one in told if one[1])
    if noise := entry.get("noise"):
        line = [(Cell("noise"), _cell(noise, "ST"))]
        tables += (Table(f"Share of noise in the variance of {name}", ("", "share"), line),)
    article = "the " * (split_name(name)[0] in FORMS)
    leading = _leading(ds, method, f"{article}{words[:1].lower()}{words[1:]}", kinds, dummy)
    return Subject(name, words, "", tables, tuple(drawn), tuple(entry["notes"]), leading)


def _leading(
    ds: xr.Dataset,
    method: str,
    words: str,
    kinds: Mapping[str, Any],
    dummy: Mapping[str, float],
) -> str:
    if not kinds:
        return ""
    kind, (first, *others) = list(kinds)[-1], _ranking(kinds)
    entry = kinds[kind][first]
    value = entry["value"] or 0.0
    if value <= dummy.get(f"{kind}_any", dummy.get(kind, 0.0)):
        return ""
    told, low = kind if kind == method else f"{method}: {kind}", entry.get("low")
    size = index(entry, "value", kind)
    if others and low is not None and low < (kinds[kind][others[0]]["value"] or 0.0):
        return (
            f"Which input matters most to {words} is not settled "
            f"({told} of {first} is {index_interval(entry, kind)})."
        )
    if kind in _SHARES and value < _LEAST:
        return f"No input alone does much to {words} ({told} is {size} at most)."
    name = sentence(with_symbol(ds[first]), width=1000)
    return f"{name} matters most to {words} ({told} = {size})."


def _is_index(value: Any) -> bool:
    return (
        isinstance(value, Mapping)
        and bool(value)
        and all(isinstance(one, Mapping) for one in value.values())
    )


def _ranking(kinds: Mapping[str, Any]) -> list[str]:
    last = list(kinds.values())[-1]
    return sorted(last, key=lambda label: -(last[label]["value"] or 0.0))


def _table(caption: str, kinds: Mapping[str, Any], dummy: Mapping[str, float]) -> Table:
    rows = [
        (Cell(label), *(_cell(one[label], kind) for kind, one in kinds.items()))
        for label in _ranking(kinds)
    ]
    if dummy:
        limits = (_cell({"value": dummy.get(kind)}, kind) for kind in kinds)
        rows.append((Cell("(an input without effect)"), *limits))
    if any(f"{kind}_any" in dummy for kind in kinds):
        limits = (_cell({"value": dummy.get(f"{kind}_any")}, kind) for kind in kinds)
        rows.append((Cell(f"(largest of {len(rows) - 1} such inputs)"), *limits))
    return Table(caption, ("input", *kinds), rows)


def _cell(entry: Mapping[str, Any], kind: str) -> Cell:
    ends = {"low": None, "high": None, **entry}
    return Cell(index(entry, "value", kind), index_interval(ends, kind), entry["value"])
