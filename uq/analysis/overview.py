"""What a result says, as a table to look at and to compute with."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from uq.analysis.statistics import COUNTS, summarise


def summary(ds: xr.Dataset) -> pd.DataFrame:
    """Describe a result in a table, one line per element of each output.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.

    Returns
    -------
    pandas.DataFrame
        Index: name of the element. Columns: units, mean, sd and each quantile, with ``_low`` and
        ``_high`` for the 95 % interval; ``tail_k``, the shape of the heavier tail (no variance
        from 0.5 on, no mean from 1 on); tolerance bounds, where the study asks for them, with the
        rows they need; counts of rows never, censored, undefined and failed, and, where an accuracy
        was asked for, of those whose error is larger (``accuracy_missed``); ``B1``, ``B10`` and
        ``B50`` of lifetimes; and for each threshold ``P(>t)`` and ``P(<t)`` with their intervals,
        where it is one of the output's.
        Where rows failed, ``_failed_low`` and ``_failed_high`` are the ends with these rows at best
        and at worst. Infinity stands for never, NaN for what could not be given.

    Examples
    --------
    >>> table = uq.summary(uq.run("studies/ishigami.toml"))
    >>> line = table.loc["y"]
    >>> bool(line["mean_low"] < 3.5 < line["mean_high"])  # the mean is known
    True
    """
    lines = {name: _line(entry) for name, entry in summarise(ds)["outputs"].items()}
    return pd.DataFrame(list(lines.values()), index=pd.Index(list(lines), name="output"))


_FAILED = ("failed_low", "failed_high")


def _line(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return one line of `summary`."""
    line = {"units": entry["units"]}
    line |= _cells("mean", {"value": entry["mean"], **entry["mean_interval"]})
    line |= _cells("sd", {"value": entry["sd"], **entry["sd_interval"]})
    line["tail_k"] = entry["tail"]["k"] if entry["tail"] else np.nan
    for probability, estimate in entry["quantiles"].items():
        line |= _cells(f"q{probability}", estimate)
    if bounds := entry["tolerance"]:
        line |= _cells("tolerance", bounds)
    line |= {count: entry[count] for count in COUNTS}
    if "accuracy" in entry:
        line["accuracy_missed"] = entry["accuracy"]["missed"]
    for name, life in entry["b_lives"].items():
        line |= _cells(name, life)
    for threshold, shares in entry["thresholds"].items():
        line |= _cells(f"P(>{threshold})", shares["above"])
        line |= _cells(f"P(<{threshold})", shares["below"])
    return line


def _cells(name: str, entry: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of an entry of `summarise`, named after what they say."""
    cells = {}
    for key in ("value", "low", "high", *_FAILED, "lower", "upper", "rows_needed"):
        if key in entry and not (key == "rows_needed" and "value" in entry):
            never = entry.get("never" if key == "value" else f"{key}_never")
            number = np.nan if entry[key] is None else entry[key]
            cells[name if key == "value" else f"{name}_{key}"] = np.inf if never else number
    return cells
