"""Consistency checks of inputs with each other, their parameters and the design."""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from uq.contract import Model, Parameter
from uq.errors import nearest
from uq.indices.methods import fed_by
from uq.sampling.copulas import NORMAL, copula_problem
from uq.sampling.data_files import Columns, columns_of_files, numbers
from uq.sampling.dependence import matrix_problem
from uq.sampling.designs import DESIGNS, IMPORTED
from uq.sampling.input_faults import InputFault
from uq.sampling.law import Law
from uq.sampling.listed_values import Empirical, values_problem
from uq.sampling.named_values import bounds_of
from uq.sampling.truncation import (
    OUTSIDE_AT_MOST,
    TOO_EXTREME,
    factor_ends,
    law_problem,
    outside_share,
    ppf_within,
    support,
)
from uq.study.file import ENTRY, Tied
from uq.study.reading import parse, shape_faults, sound_entries
from uq.text.numbers import counted

Entries = Mapping[str, Any]
"""Parameter -> `Law` or `Tied`."""


def read_entries(tables: Mapping[str, Any], columns: Columns) -> tuple[Entries, list[InputFault]]:
    """Return the valid entries of [uncertain], with the values of entries that name a file.

    Parameters
    ----------
    tables : dict
        Valid entries of a study file.
    columns : dict
        Columns of the files that it names.

    Returns
    -------
    entries : dict of str to Law or Tied
        Entries whose file cannot be read are excluded.
    faults : list of InputFault
    """
    entries: dict[str, Any] = {}
    faults = []
    for name, table in tables["uncertain"].items():
        entry = ENTRY.validate_python(table)
        if isinstance(entry, Empirical) and entry.file is not None:
            text = columns.get(entry.file, {}).get(str(entry.column))
            if text is None:
                continue
            values = tuple(numbers(text).tolist())
            if problem := values_problem(values):
                faults.append(InputFault(("uncertain", name, "column"), problem, entry.column))
                continue
            entry = entry.model_copy(update={"values": values})
        entries[name] = entry
    return entries, faults


def laws_of(text: str) -> dict[str, Law]:
    """Return the laws in the study text of a result, with their listed values."""
    return dict(_laws_of(text))


@lru_cache(maxsize=2)  # the one of a result is read by each of its numbers
def _laws_of(text: str) -> dict[str, Law]:
    return laws_in(parse(text, "study of this result"))


def laws_in(data: dict[str, Any]) -> dict[str, Law]:
    """Return the laws in a parsed study, with their listed values."""
    tables = sound_entries(data, shape_faults(data))
    entries, _ = read_entries(tables, columns_of_files(tables, None)[0])
    return {name: entry for name, entry in entries.items() if not isinstance(entry, Tied)}


def input_faults(model: Model, entries: Entries) -> Iterator[InputFault]:
    """Yield the faults of each parameter's law, or of the parameter to which it is tied."""
    model_entries = {
        name: entry for name, entry in entries.items() if name in model.parameter_names
    }
    leaders = {name: entry for name, entry in model_entries.items() if not _followed(entry)}
    for name, entry in model_entries.items():
        parameter, other = model.parameter(name), _followed(entry)
        if other is None:
            if unsuited := law_problem(entry, parameter):
                yield unsuited.within("uncertain", name)
            continue
        path = ("uncertain", name, "equals" if isinstance(entry, Tied) else "times")
        if other not in leaders:
            allowed = ", ".join(leaders) or "none"
            problem = "is not an uncertain parameter with its own law"
            if other == name:
                problem = "is the parameter itself"
            yield InputFault(
                path, f"{problem}{nearest(other, leaders)} (allowed: {allowed})", other
            )
            continue
        law, other_parameter = leaders[other], model.parameter(other)
        if text := _level_problem(entry, name, model_entries[other]):
            yield InputFault(path, text, other)
        if isinstance(entry, Tied):
            if parameter.unit != other_parameter.unit:
                problem = (
                    f"is in another unit, {other_parameter.unit}, than '{name}', {parameter.unit}"
                )
                yield InputFault(path, problem, other)
            elif unsuited := law_problem(law, parameter):
                yield InputFault(path, f"'{name}' cannot follow it: {unsuited.problem}", other)
        elif not law_problem(law, other_parameter):  # otherwise reported for the other parameter
            low, high = support(law, other_parameter.bounds)
            if low <= 0 <= high:
                problem = f"must not change sign or be zero: is within {low:g} to {high:g}"
                yield InputFault(path, problem, other)
            elif text := _product_problem(parameter, entry, law, other_parameter):
                yield InputFault(("uncertain", name), text)


def _level_problem(entry: Law | Tied, name: str, other: Law) -> str | None:
    """Return the reason why two tied parameters have inconsistent levels; None if consistent."""
    if entry.level in (None, other.level):
        return None
    verb = "equals" if isinstance(entry, Tied) else "times"
    return (
        f"is on the level '{other.level}', and '{name}' on '{entry.level}': '{verb}' joins inputs"
        f" of one level; give '{name}' level = \"{other.level}\""
    )


def _followed(entry: Law | Tied) -> str | None:
    """Return the parameter to which an entry is tied or by which it is scaled; None if neither."""
    return entry.equals if isinstance(entry, Tied) else entry.times


def dependence_faults(
    tables: Mapping[str, Any], entries: Entries, incomplete: bool
) -> Iterator[InputFault]:
    """Yield the faults of [dependence], including conflicts with the design.

    Parameters
    ----------
    tables : dict
        Valid entries of a study file.
    entries : dict of str to Law or Tied
    incomplete : bool
        Whether entries of [dependence] are invalid; its copula is then not checked.
    """
    table = tables["dependence"]
    if not table:
        return
    names, ranks = table.get("parameters", ()), table.get("rank_correlation")
    for name in names:
        if name not in tables["uncertain"]:
            problem = f"is not uncertain{nearest(name, entries)}"
            yield InputFault(("dependence", "parameters"), problem, name)
        elif name in entries and _followed(entries[name]):
            problem = "follows another parameter already; only laws of their own can be correlated"
            yield InputFault(("dependence", "parameters"), problem, name)
    levels = {name: entries[name].level for name in names if isinstance(entries.get(name), Law)}
    if len(set(levels.values())) > 1:
        seen = ", ".join(f"{name} is {level}" for name, level in levels.items())
        problem = f"must be inputs of one level: {seen}"
        yield InputFault(("dependence", "parameters"), problem)
    if names and ranks is not None:
        if wrong := matrix_problem(tuple(names), ranks):
            yield wrong.within("dependence", "rank_correlation")
        elif not incomplete and (
            wrong := copula_problem(
                tuple(names),
                ranks[0][1],
                table.get("copula", NORMAL),
                table.get("degrees_of_freedom"),
                table.get("survival", False),
            )
        ):
            yield wrong.within("dependence")
    method = tables["design"].get("method")
    if method in IMPORTED:
        yield InputFault(("dependence",), "imported rows carry their own dependence; leave it out")
    elif method is not None and not fed_by(DESIGNS[method], dependent=True):
        able: dict[tuple[str, ...], list[str]] = {}
        for name, design in DESIGNS.items():
            if not design.imported:
                able.setdefault(fed_by(design, dependent=True), []).append(name)
        remedies = (
            f"{' or '.join(designs)} for {' and '.join(feeds)}"
            for feeds, designs in able.items()
            if feeds
        )
        problem = (
            "assumes independent inputs, and [dependence] says they are not; use"
            f" {', or '.join(remedies)}"
        )
        yield InputFault(("design", "method"), problem, method)


def import_faults(
    model: Model, tables: Mapping[str, Any], entries: Entries, columns: Columns
) -> Iterator[InputFault]:
    """Yield the faults of imported rows that prevent their use as a design."""
    table = tables["design"]
    if table.get("method") not in IMPORTED:
        if "file" in table and "method" in table:
            yield InputFault(("design", "file"), "only for method = 'imported'", table["file"])
        return
    if "file" not in table:
        yield InputFault(("design", "file"), "is missing: a CSV or netCDF file with the rows")
    if table.get("replicates", 1) > 1:
        yield InputFault(("design", "replicates"), "must be 1 for 'imported'", table["replicates"])
    for name, entry in entries.items():
        if not isinstance(entry, Tied) and entry.times is not None:
            problem = f"imported rows give '{name}' itself; leave it out"
            yield InputFault(("uncertain", name, "times"), problem, entry.times)
    sizes = {}
    for name, text in columns.get(table.get("file", ""), {}).items():
        if name in entries and name in model.parameter_names:
            values, parameter = numbers(text), model.parameter(name)
            sizes[name] = len(values)
            low, high = parameter.bounds
            for first in np.flatnonzero((values < low) | (values > high))[:1]:
                problem = (
                    f"'{name}' = {float(values[first])!r} in row {first + 1} is outside the"
                    f" parameter's bounds, {bounds_of(parameter)}"
                )
                yield InputFault(("design", "file"), problem, table["file"])
    if len(set(sizes.values())) > 1:
        text = ", ".join(f"{name} {size}" for name, size in sizes.items())
        yield InputFault(("design", "file"), f"columns of different lengths: {text}", table["file"])
    elif sizes and table.get("samples", 0) > (rows := min(sizes.values())):
        problem = f"the file has {counted(rows, 'row')}; samples must not exceed that"
        yield InputFault(("design", "samples"), problem, table["samples"])


def _product_problem(
    parameter: Parameter, factor: Law, law: Law, other_parameter: Parameter
) -> str | None:
    """Return the reason why a scaled parameter exceeds its bounds; None if it does not."""
    from scipy.stats import norm

    # Probability of the factor outside, averaged over the other's law, including both its tails.
    z = np.linspace(-8.0, 8.0, 801)
    other = ppf_within(law, norm.cdf(z), other_parameter.bounds)
    share = outside_share(factor, *factor_ends(other, parameter.bounds))
    if share is None:
        return TOO_EXTREME
    outside = float(np.average(share, weights=norm.pdf(z)))
    if outside <= OUTSIDE_AT_MOST:
        return None
    return (
        f"the product has {outside:.2g} of its probability outside the parameter's bounds,"
        f" {bounds_of(parameter)} (allowed: {OUTSIDE_AT_MOST:g}); truncate the factor, or use other"
        " numbers"
    )
