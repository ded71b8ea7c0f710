"""Sensitivities in a report: one table for each target of each method."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import isfinite
from typing import NamedTuple

import xarray as xr

from uq.analysis.findings import Findings
from uq.drawing.index_plot import subject
from uq.errors import InputError
from uq.estimate import Estimate
from uq.indices.ranked import Values, lines
from uq.indices.sensitivities import TargetIndices, methods
from uq.keys import key_of
from uq.methods.indices import S1, IndexKind, Null
from uq.report.cells import Cell, Table
from uq.report.pictures import Picture, pictures


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
    """

    name: str
    words: str
    refused: str = ""
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    notes: tuple[str, ...] = ()


class Method(NamedTuple):
    """The results of one method, or in ``refused`` why there are none."""

    name: str
    refused: str = ""
    used: str = ""
    subjects: tuple[Subject, ...] = ()


Drawn = defaultdict[tuple[str, str], list[Picture]]
"""Method and target -> their figures."""


def sensitivity_of(findings: Findings) -> list[Method]:
    """Return the indices by each method of the study.

    Parameters
    ----------
    findings : Findings

    Returns
    -------
    list of Method
    """
    drawn: Drawn = defaultdict(list)
    for picture in pictures(findings, "sensitivities"):
        drawn[picture.of.method, picture.of.name].append(picture)
    return [_method(findings, name, drawn) for name in methods(findings.ds)]


def _method(findings: Findings, name: str, drawn: Drawn) -> Method:
    try:
        found = findings.sensitivities(name)
    except InputError as error:
        return Method(name, refused=str(error))
    used = f"From {found.rows_used} rows"
    if found.groups_dropped:
        used += f"; {found.groups_dropped} groups with missing values dropped"
    subjects = (
        _subject(findings.ds, name, one, drawn[name, target])
        for target, one in found.targets.items()
    )
    return Method(name, used=used, subjects=tuple(subjects))


def _subject(
    ds: xr.Dataset, method: str, found: TargetIndices, drawn: Sequence[Picture]
) -> Subject:
    name, indices = found.name, found.indices
    words = subject(ds, name)
    words = words[:1].upper() + words[1:]
    if found.refused:
        return Subject(name, words, refused=found.refused)
    kinds, pairs = found.kinds(), found.kinds(of_pairs=True)
    listed = ((f"Indices of {name}", kinds), (f"Second order, of {name}", pairs))
    traced = partial(key_of, "outputs", name, verb="sensitivity", options={"method": method})
    tables = tuple(_table(caption, one, indices.nulls, traced) for caption, one in listed if one)
    if indices.noise:
        line = [(Cell("noise"), _cell(S1, indices.noise, traced("noise")))]
        tables += (Table(f"Share of noise in the variance of {name}", ("", "share"), line),)
    return Subject(name, words, "", tables, tuple(drawn), indices.notes)


def _table(
    caption: str,
    values: Values,
    nulls: Mapping[IndexKind, Null],
    traced: Callable[..., str],
) -> Table:
    def cells(label: str, estimates: Sequence[Estimate]) -> Iterator[Cell]:
        for kind, one in zip(values, estimates, strict=True):
            dummy = ("dummy", f"{kind.key}{'_any' * label.startswith('(largest')}")
            yield _cell(kind, one, traced(*((kind.key, label) if label in values[kind] else dummy)))

    rows = [(Cell(label), *cells(label, found)) for label, found in lines(values, nulls)]
    return Table(caption, ("input", *(kind.key for kind in values)), rows)


def _cell(kind: IndexKind, one: Estimate, traced: str) -> Cell:
    key = one.value if isfinite(one.value) else None
    return Cell(kind.text(one.value), kind.interval(one), key, traced)
