"""Sensitivities in a report: one table for each target of each method."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import chain
from typing import NamedTuple

from uq.assess.answer.wording import NumberTarget
from uq.assess.findings import Findings
from uq.assess.sensitivities import TargetIndices, Values, lines, methods
from uq.assess.targets import split_name
from uq.errors import InputError
from uq.indices.index import BY_CORRELATION, S1, IndexKind, Indices
from uq.render.figures.index_plot import subject
from uq.render.html.cells import SHARE, Cell, HtmlTable, estimate_cell
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.text.keys import key_of
from uq.text.numbers import capitalized, counted
from uq.text.units import readable


class IndexTable(NamedTuple):
    """Sensitivity indices of one target, by one or several methods.

    Attributes
    ----------
    name : str
    words : str
    tables : tuple of HtmlTable
    notes : tuple of str
        Notes, including the reason why a method has no indices.
    """

    name: str
    words: str
    tables: tuple[HtmlTable, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def columns(self) -> int:
        """Number of columns of the widest table."""
        return max((len(table.header) for table in self.tables), default=0)

    @property
    def output(self) -> str:
        """Output of the target."""
        return output_of(self.name)


Methods = Mapping[str, tuple[str, Sequence[IndexTable]]]
"""Method -> its rows (or the reason why it has no indices), and the indices of each target."""


def output_of(target: str) -> str:
    """Return the output, or the event, of a target of indices."""
    return re.split(r"[\[=]", split_name(target)[1])[0]


def sensitivity_of(findings: Findings) -> Methods:
    """Return the sensitivity indices by each method of the study."""
    return {name: _method(findings, name) for name in methods(findings.result)}


def _method(findings: Findings, name: str) -> tuple[str, list[IndexTable]]:
    try:
        sensitivities = findings.sensitivities(name)
    except InputError as error:
        return str(error), []
    used = f"from {counted(sensitivities.rows_used, 'row')}"
    if sensitivities.groups_dropped:
        used += f"; {counted(sensitivities.groups_dropped, 'group')} with missing values dropped"
    targets = sensitivities.targets.values()
    return used, [_subject(findings.result, name, target_indices) for target_indices in targets]


def _subject(result: Result, method: str, target_indices: TargetIndices) -> IndexTable:
    name, indices = target_indices.name, target_indices.indices
    words = capitalized(readable(subject(result, name)))
    if target_indices.refused:
        return IndexTable(name, words, notes=(f"no indices by {method}: {target_indices.refused}",))
    kinds, pairs = target_indices.kinds(), target_indices.kinds(of_pairs=True)
    of = f"{NumberTarget(result, name).name} by {method}"
    listed = ((f"Indices of {of}", kinds), (f"Second order, of {of}", pairs))
    traced = partial(key_of, "outputs", name, verb="sensitivity", options={"method": method})
    tables = tuple(
        _table(caption, index_kind, indices, traced) for caption, index_kind in listed if index_kind
    )
    if indices.noise:
        line = [(Cell("noise"), index_cell(S1, indices.noise, traced("noise")))]
        tables += (HtmlTable(f"Share of noise in the variance of {of}", ("", "share"), line),)
    return IndexTable(name, words, tables, indices.notes)


def of_output(methods: Methods, output: str) -> list[IndexTable]:
    """Return the indices of an output, grouped by target over all methods."""
    tables: dict[str, IndexTable] = {}
    for index_table in chain.from_iterable(subjects for _, subjects in methods.values()):
        if index_table.output != output:
            continue
        merged = tables.get(index_table.name, IndexTable(index_table.name, index_table.words))
        notes = (*dict.fromkeys(merged.notes + index_table.notes),)
        tables[index_table.name] = merged._replace(
            tables=merged.tables + index_table.tables, notes=notes
        )
    return list(tables.values())


def _table(
    caption: str,
    values: Values,
    indices: Indices,
    traced: Callable[..., str],
) -> HtmlTable:
    def cells(label: str, estimates: Sequence[Estimate]) -> Iterator[Cell]:
        for kind, estimate in zip(values, estimates, strict=True):
            dummy = ("dummy", f"{kind.key}{'_any' * label.startswith('(largest')}")
            path = (kind.key, label) if label in values[kind] else dummy
            yield index_cell(
                kind, estimate, traced(*path) if path != dummy or kind in indices.nulls else ""
            )

    rows = [
        (Cell(label, BY_CORRELATION * (label in indices.by_correlation)), *cells(label, of_kinds))
        for label, of_kinds in lines(values, indices.nulls)
    ]
    return HtmlTable(caption, ("input", *(kind.words for kind in values)), rows)


def index_cell(kind: IndexKind, estimate: Estimate, traced: str) -> Cell:
    """Return the cell of an index with its bar and interval."""
    scale = {"variance": SHARE, "p-value": ""}.get(kind.unit, kind.key)
    text = kind.text(estimate.value)
    return estimate_cell(text, kind.interval(estimate), estimate, traced, scale)
