"""What inputs ask of each other, of their parameters and of the design."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from uq.contract import Model, Parameter
from uq.designs.registry import DESIGNS, IMPORTED
from uq.errors import nearest
from uq.inputs.conditioning import (
    OUTSIDE_AT_MOST,
    factor_ends,
    law_problem,
    outside_share,
    ppf_within,
    support,
)
from uq.inputs.data_files import Columns, columns_of_files, numbers
from uq.inputs.dependence import matrix_problem
from uq.inputs.faults import Fault
from uq.inputs.law import Law
from uq.inputs.observed import Empirical, values_problem
from uq.methods.registry import fed_by, for_dependent_inputs
from uq.study.file import ENTRY, Tied
from uq.study.reading import parse, shape_faults, sound_entries

Entries = Mapping[str, Any]
"""Parameter -> `Law` or `Tied`."""


def read_entries(tables: Mapping[str, Any], columns: Columns) -> tuple[Entries, list[Fault]]:
    """Return the sound entries of [uncertain], with the values of those that name a file.

    Parameters
    ----------
    tables : dict
        The sound entries of a study file.
    columns : dict
        What its files hold.

    Returns
    -------
    entries : dict of str to Law or Tied
        Without those whose file could not be read.
    faults : list of Fault
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
                faults.append(Fault(("uncertain", name, "column"), problem, entry.column))
                continue
            entry = entry.model_copy(update={"values": values})
        entries[name] = entry
    return entries, faults


def laws_of(text: str) -> dict[str, Law]:
    """Return the laws in the text of a study that a result carries, with their listed values."""
    data = parse(text, "study of this result")
    tables = sound_entries(data, shape_faults(data))
    entries, _ = read_entries(tables, columns_of_files(tables, None)[0])
    return {name: entry for name, entry in entries.items() if not isinstance(entry, Tied)}


def input_faults(model: Model, entries: Entries) -> Iterator[Fault]:
    """Yield what does not suit a parameter: its law, or the one that it is tied to."""
    known = {name: entry for name, entry in entries.items() if name in model.parameter_names}
    for name, entry in known.items():
        if isinstance(entry, Tied):
            yield from _tie_faults(model, name, entry, known)
        elif entry.times is not None:
            yield from _factor_faults(model, name, entry, known)
        elif unsuited := law_problem(entry, model.parameter(name)):
            yield Fault(("uncertain", name, *unsuited.argument), unsuited.text, unsuited.value)


def dependence_faults(tables: Mapping[str, Any], entries: Entries) -> Iterator[Fault]:
    """Yield what is wrong with [dependence], by itself or for this design."""
    table = tables["dependence"]
    if not table:
        return
    names, ranks = table.get("parameters", ()), table.get("rank_correlation")
    for name in names:
        entry = entries.get(name)
        if name not in tables["uncertain"]:
            problem = f"is not uncertain{nearest(name, entries)}"
            yield Fault(("dependence", "parameters"), problem, name)
        elif isinstance(entry, Tied) or (entry is not None and entry.times is not None):
            problem = "follows another parameter already; only laws of their own can be correlated"
            yield Fault(("dependence", "parameters"), problem, name)
    if names and ranks is not None and (wrong := matrix_problem(tuple(names), ranks)):
        value = ranks[wrong.place[0]][wrong.place[1]] if wrong.place else None
        yield Fault(("dependence", "rank_correlation", *wrong.place), wrong.text, value)
    method = tables["design"].get("method")
    if method in IMPORTED:
        yield Fault(("dependence",), "imported rows are as dependent as they are; take it out")
    elif method is not None and not fed_by(DESIGNS[method], dependent=True):
        able = [n for n, d in DESIGNS.items() if not d.imported and fed_by(d, dependent=True)]
        problem = (
            f"supposes independent inputs, and [dependence] says they are not; use"
            f" {' or '.join(able)}, which feed {' and '.join(for_dependent_inputs())}"
        )
        yield Fault(("design", "method"), problem, method)


def import_faults(
    model: Model, tables: Mapping[str, Any], entries: Entries, columns: Columns
) -> Iterator[Fault]:
    """Yield what keeps the rows of a file from being a design."""
    table = tables["design"]
    if table.get("method") not in IMPORTED:
        if "file" in table and "method" in table:
            yield Fault(("design", "file"), "only for method = 'imported'", table["file"])
        return
    if "file" not in table:
        yield Fault(("design", "file"), "is missing: a CSV or netCDF file with the rows")
    if table.get("replicates", 1) > 1:
        yield Fault(("design", "replicates"), "must be 1 for 'imported'", table["replicates"])
    for name, entry in entries.items():
        if not isinstance(entry, Tied) and entry.times is not None:
            problem = f"imported rows give '{name}' itself; take it out"
            yield Fault(("uncertain", name, "times"), problem, entry.times)
    found = columns.get(table.get("file", ""), {})
    sizes = {}
    for name, text in found.items():
        if name in entries and name in model.parameter_names:
            values = numbers(text)
            sizes[name] = len(values)
            low, high = model.parameter(name).bounds
            outside = np.flatnonzero((values < low) | (values > high))
            if len(outside):
                first = int(outside[0])
                problem = (
                    f"'{name}' = {float(values[first])!r} in row {first + 1} is outside the"
                    f" parameter's bounds, {low!r} to {high!r} [{model.parameter(name).unit}]"
                )
                yield Fault(("design", "file"), problem, table["file"])
    if len(set(sizes.values())) > 1:
        text = ", ".join(f"{name} {size}" for name, size in sizes.items())
        yield Fault(("design", "file"), f"columns of different lengths: {text}", table["file"])
    elif sizes and table.get("samples", 0) > (rows := min(sizes.values())):
        problem = f"the file has {rows} rows; must be at most that"
        yield Fault(("design", "samples"), problem, table["samples"])


def _other(
    path: tuple[str, ...], name: str, other: str, entries: Entries
) -> tuple[Law | None, Fault | None]:
    """Return the law of another parameter, or why it cannot be followed."""
    own = [n for n, e in entries.items() if not isinstance(e, Tied) and e.times is None]
    if other in own and other != name:
        return entries[other], None
    known = ", ".join(n for n in own if n != name) or "none"
    problem = (
        "is the parameter itself" if other == name else "is no uncertain parameter with its own law"
    )
    return None, Fault(path, f"{problem}{nearest(other, own)} (allowed: {known})", other)


def _tie_faults(model: Model, name: str, tied: Tied, entries: Entries) -> Iterator[Fault]:
    path = ("uncertain", name, "equals")
    law, fault = _other(path, name, tied.equals, entries)
    if fault is not None:
        yield fault
    if law is None:
        return
    here, there = model.parameter(name), model.parameter(tied.equals)
    if here.unit != there.unit:
        problem = f"is in another unit, {there.unit}, than '{name}', {here.unit}"
        yield Fault(path, problem, tied.equals)
    elif unsuited := law_problem(law, here):
        yield Fault(path, f"'{name}' cannot follow it: {unsuited.text}", tied.equals)


def _factor_faults(model: Model, name: str, factor: Law, entries: Entries) -> Iterator[Fault]:
    path = ("uncertain", name, "times")
    law, fault = _other(path, name, str(factor.times), entries)
    if fault is not None:
        yield fault
    if law is None:
        return
    there = model.parameter(str(factor.times))
    if law_problem(law, there):
        return  # told at that parameter
    low, high = support(law, there.bounds)
    if low <= 0 <= high:
        problem = f"must not change sign or be zero: lies within {low:g} to {high:g}"
        yield Fault(path, problem, factor.times)
    elif unsuited := _product_problem(model.parameter(name), factor, law, there):
        yield Fault(("uncertain", name), unsuited)


def _product_problem(parameter: Parameter, factor: Law, law: Law, there: Parameter) -> str | None:
    """Say why a factor times another parameter does not suit a parameter, or return None."""
    from scipy.stats import norm

    # The mean over the other's law of what the factor has outside; both tails of that law count.
    z = np.linspace(-8.0, 8.0, 801)
    other = ppf_within(law, norm.cdf(z), there.bounds)
    share = outside_share(factor, *factor_ends(other, parameter.bounds))
    if share is None:
        return "these numbers are too extreme to compute with; use others"
    outside = float(np.average(share, weights=norm.pdf(z)))
    if outside <= OUTSIDE_AT_MOST:
        return None
    low, high = parameter.bounds
    return (
        f"the product has {outside:.2g} of its probability outside the parameter's bounds,"
        f" {low!r} to {high!r} [{parameter.unit}] (allowed: {OUTSIDE_AT_MOST:g}); truncate the"
        " factor, or use other numbers"
    )
