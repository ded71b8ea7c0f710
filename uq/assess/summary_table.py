"""Summary of a result as a pandas table: outputs in rows, statistics in columns."""

from math import inf, isfinite, nan
from typing import Any

import pandas as pd

from uq.assess.statistic import Reader, Statistic, place_of
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import Described, Summary, summarise
from uq.result.result import AnyResult, Result
from uq.stats.estimate import Estimate


def summary(result: AnyResult, *, plain: bool = False) -> pd.DataFrame:
    """Describe a result in a table, one line per element of each output.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    plain : bool
        Whether lives are taken as computed; by default what only scales them is integrated exactly.

    Returns
    -------
    pandas.DataFrame
        Index: name of the element. Columns: ``units``, and every statistic under its own name, such
        as ``mean``, ``q0.5``, ``B10`` or ``P(>t)``, with ``_low`` and ``_high`` for the 95 %
        interval; ``docs/statistics.md`` explains each. Where rows failed, ``_failed_low`` and
        ``_failed_high`` are the ends with these rows at best and at worst. Infinity means never,
        NaN that there is no estimate.

    Examples
    --------
    >>> table = uq.summary(uq.run("studies/ishigami.toml"))
    >>> line = table.loc["y"]
    >>> bool(line["mean_low"] < 3.5 < line["mean_high"])  # the mean is known
    True
    """
    result = Result.of(result)
    return table_of(summarise(result, plain=plain))


def table_of(summarised: Summary) -> pd.DataFrame:
    """Return a summary as a table."""
    lines = {name: _line(described) for name, described in summarised.outputs.items()}
    return pd.DataFrame(list(lines.values()), index=pd.Index(list(lines), name="output"))


def _line(output: Described) -> dict[str, Any]:
    """Return one line of `summary`."""
    line: dict[str, Any] = {"units": output.units}
    for name in sorted(output.parts, key=lambda name: place_of(STATISTICS[name]).columns):
        for statistic in output.parts[name]:
            column = statistic.label if statistic.column is None else statistic.column
            if column and statistic.is_read_by(Reader.COLUMNS):
                line |= _cells(column, statistic)
    return line


def _cells(column: str, statistic: Statistic) -> dict[str, float]:
    """Return the numbers of a statistic under the names of their columns."""
    if statistic.kind.is_count:
        count = statistic.estimate.value
        return {column: int(count) if isfinite(count) else nan}
    cells = {column: _number(statistic.estimate, "value")}
    if statistic.kind.has_interval:
        cells |= {f"{column}_{end}": _number(statistic.estimate, end) for end in ("low", "high")}
    if statistic.failed is not None:
        cells |= {
            f"{column}_failed_{end}": _number(statistic.failed, end) for end in ("low", "high")
        }
    return cells


def _number(estimate: Estimate, end: str) -> float:
    """Return a number: infinity for never, NaN if unknown."""
    value = getattr(estimate, end)
    return value if isfinite(value) or (value == inf and end not in estimate.beyond) else nan
