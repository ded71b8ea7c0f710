"""Sensitivities in a report: one table for each target of each method."""

import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import isfinite
from typing import NamedTuple

from uq.assess.answer.number_targets import NumberTarget
from uq.assess.findings import Findings
from uq.assess.ranked_indices import Values, lines
from uq.assess.sensitivities import TargetIndices, methods
from uq.assess.targets import split_name
from uq.errors import InputError
from uq.indices.index import BY_CORRELATION, S1, IndexKind, Indices
from uq.render.figures.index_plot import subject
from uq.render.html.cells import SHARE, Cell, HtmlTable
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.text.keys import key_of
from uq.text.numbers import capitalized, counted
from uq.text.symbols import readable


class IndexTable(NamedTuple):
    """The indices of one target, by one method or several.

    Attributes
    ----------
    name : str
    words : str
    tables : tuple of HtmlTable
    notes : tuple of str
        Among them why a method has no indices.
    """

    name: str
    words: str
    tables: tuple[HtmlTable, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def columns(self) -> int:
        """Of its widest table."""
        return max((len(one.header) for one in self.tables), default=0)

    @property
    def output(self) -> str:
        """The output that it is about."""
        return output_of(self.name)


class MethodTable(NamedTuple):
    """The results of one method, or in ``refused`` why there are none."""

    name: str
    refused: str = ""
    used: str = ""
    subjects: tuple[IndexTable, ...] = ()


def output_of(target: str) -> str:
    """Return the output that a target of indices is about, or an event."""
    return re.split(r"[\[=]", split_name(target)[1])[0]


def sensitivity_of(findings: Findings) -> list[MethodTable]:
    """Return the indices by each method of the study.

    Parameters
    ----------
    findings : Findings

    Returns
    -------
    list of MethodTable
    """
    return [_method(findings, name) for name in methods(findings.result)]


def _method(findings: Findings, name: str) -> MethodTable:
    try:
        found = findings.sensitivities(name)
    except InputError as error:
        return MethodTable(name, refused=str(error))
    used = f"from {counted(found.rows_used, 'row')}"
    if found.groups_dropped:
        used += f"; {counted(found.groups_dropped, 'group')} with missing values dropped"
    subjects = (_subject(findings.result, name, one) for one in found.targets.values())
    return MethodTable(name, used=used, subjects=tuple(subjects))


def _subject(result: Result, method: str, found: TargetIndices) -> IndexTable:
    name, indices = found.name, found.indices
    words = capitalized(readable(subject(result, name)))
    if found.refused:
        return IndexTable(name, words, notes=(f"no indices by {method}: {found.refused}",))
    kinds, pairs = found.kinds(), found.kinds(of_pairs=True)
    of = f"{NumberTarget(result, name).name} by {method}"
    listed = ((f"Indices of {of}", kinds), (f"Second order, of {of}", pairs))
    traced = partial(key_of, "outputs", name, verb="sensitivity", options={"method": method})
    tables = tuple(_table(caption, one, indices, traced) for caption, one in listed if one)
    if indices.noise:
        line = [(Cell("noise"), _cell(S1, indices.noise, traced("noise")))]
        tables += (HtmlTable(f"Share of noise in the variance of {of}", ("", "share"), line),)
    return IndexTable(name, words, tables, indices.notes)


def of_output(methods: Sequence[MethodTable], output: str) -> list[IndexTable]:
    """Return the indices of an output, those of a target by all methods together.

    Parameters
    ----------
    methods : sequence of MethodTable
    output : str
    """
    found: dict[str, IndexTable] = {}
    for one in (one for method in methods for one in method.subjects if one.output == output):
        known = found.get(one.name, IndexTable(one.name, one.words))
        notes = (*dict.fromkeys(known.notes + one.notes),)
        found[one.name] = known._replace(tables=known.tables + one.tables, notes=notes)
    return list(found.values())


def _table(
    caption: str,
    values: Values,
    indices: Indices,
    traced: Callable[..., str],
) -> HtmlTable:
    def cells(label: str, estimates: Sequence[Estimate]) -> Iterator[Cell]:
        for kind, one in zip(values, estimates, strict=True):
            dummy = ("dummy", f"{kind.key}{'_any' * label.startswith('(largest')}")
            path = (kind.key, label) if label in values[kind] else dummy
            yield _cell(kind, one, traced(*path) if path != dummy or kind in indices.nulls else "")

    rows = [
        (Cell(label, BY_CORRELATION * (label in indices.by_correlation)), *cells(label, found))
        for label, found in lines(values, indices.nulls)
    ]
    return HtmlTable(caption, ("input", *(kind.words for kind in values)), rows)


def _cell(kind: IndexKind, one: Estimate, traced: str) -> Cell:
    key = one.value if isfinite(one.value) else None
    scale = {"variance": SHARE, "p-value": ""}.get(kind.unit, kind.key)
    return Cell(kind.text(one.value), kind.interval(one), key, traced, scale, (one.low, one.high))
