"""Convergence: estimates as the rows came in, and the error of sampling beside other errors."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from uq.assess.sensitivities import sensitivities
from uq.assess.statistic import Reader
from uq.assess.statistics.counts import stated_error
from uq.assess.summary import Described, summarise
from uq.assess.targets import split_name
from uq.errors import InputError
from uq.indices.methods import METHODS, piloted_by
from uq.result.elements import (
    Element,
    are_independent,
    elements_of,
    independent_rows,
    named_elements,
    output_names,
)
from uq.result.nesting import first_samples
from uq.result.variables import error_name
from uq.result.weights import refuse_weights
from uq.sampling.designs import DESIGNS
from uq.text.element_names import is_whole, whole_name

COLUMNS = ["output", "estimate", "samples", "value", "low", "high", "kind", "input"]

_FEWEST = 16  # samples


def running_estimates(ds: xr.Dataset, output: str | None = None) -> pd.DataFrame:
    """Estimate everything from the first samples of a result, in increasing numbers.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str, optional
        Only this output, or this element of one.

    Returns
    -------
    pandas.DataFrame
        Columns ``output`` (its element), ``estimate`` (``mean``, ``quantile 0.5``, ``P(>t)``,
        ``P(<t)``, and ``S1 x``, ``ST x`` for a crossed design), ``samples``, ``value``, ``low``,
        ``high``; of an index also its ``kind`` and ``input``, elsewhere "". Sizes double up to the
        whole result. The intervals are pointwise.

    Raises
    ------
    InputError
        When there is no such output, or the first rows of the design are not a smaller one.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> running = uq.running_estimates(ds)
    >>> running[running["estimate"] == "mean"]["samples"].to_list()
    [16, 32, 63, 125, 250, 500, 1000]
    """
    refuse_weights(ds, "running estimates")
    names = None
    if output is not None:
        whole = output if is_whole(output) else whole_name(output)
        names = {whole, *(element.name for element in named_elements(ds, output))}
    # Those of all rows: of the first ones alone a life may have another target.
    targets = list(sensitivities(ds, method).targets) if (method := method_shown(ds)) else []
    lines = [
        (name, label, samples, *numbers, *index)
        for samples in _sizes(ds)
        for name, label, numbers, *index in estimates_from(first_samples(ds, samples), targets)
        if names is None or split_name(name)[1] in names
    ]
    return pd.DataFrame(lines, columns=COLUMNS)


def enough(ds: xr.Dataset, output: str | None = None) -> pd.DataFrame:
    """Compare the error of sampling with the errors of the rows themselves.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str, optional
        Only this output, or this element of one.

    Returns
    -------
    pandas.DataFrame
        Index: element of an output. ``estimate``, its mean or, where rows never end or are
        censored or the tail is heavy, its median; ``sampling``, the half-width of its interval;
        ``own``, the mean magnitude of ``<output>_error``, the error of solver and time averages
        that the model gives for each row (NaN where it gives none): the error of the estimate if
        all of them had the same sign; ``warning``, not empty where `own` is the larger: then more
        rows do not help.
    """
    refuse_weights(ds, "the error of sampling")
    found, names = summarise(ds).outputs, output_names(ds)
    rows = independent_rows(ds)
    plain = [name for name in names if name not in {error_name(one) for one in names}]
    lines = {}
    for element in named_elements(rows, output) if output else elements_of(rows, plain):
        if element.name not in found:
            continue
        lines[element.name] = compared(rows, element, found[element.name])
    columns = ["estimate", "sampling", "own", "warning"]
    return pd.DataFrame(
        list(lines.values()), index=pd.Index(list(lines), name="output"), columns=columns
    )


class Errors(NamedTuple):
    """The error of sampling and that of the rows themselves, as `enough` returns them."""

    estimate: str
    sampling: float
    own: float
    warning: str


def compared(ds: xr.Dataset, element: Element, described: Described) -> Errors:
    """Compare the error of sampling of an element with that of the rows themselves.

    Parameters
    ----------
    ds : xarray.Dataset
        The independent rows of a result.
    element : Element
    described : Described
        Its statistics.
    """
    label, one = "mean", described.find("mean")
    if one is None or np.isnan(one.estimate.value) or one.estimate.reason:
        label, one = "median", described.find("quantiles", "0.5")
    known = one is not None and one.estimate.has_interval
    sampling = (one.estimate.high - one.estimate.low) / 2 if one and known else np.nan
    own = _own_error(ds, element)
    words = _WARNING.format(own=own, units=element.units, sampling=sampling)
    return Errors(label, sampling, own, words if own > sampling else "")


_WARNING = (
    "the rows' own error ({own:.3g} {units}) is larger than that of sampling ({sampling:.3g}): more"
    " rows do not help, finer settings or longer averages do"
)


def _own_error(ds: xr.Dataset, element: Element) -> float:
    error = stated_error(ds, element)
    if error is None:
        return np.nan
    sizes = np.abs(error.values[np.isfinite(error.values)])
    return float(sizes.mean()) if len(sizes) else np.nan


def _sizes(ds: xr.Dataset) -> list[int]:
    method, size = ds.attrs["design"], int(ds.attrs["samples"])
    if not (DESIGNS[method].append_only or are_independent(ds)):
        able = " or ".join(f"'{name}'" for name, design in DESIGNS.items() if design.append_only)
        raise InputError(
            f"the first rows of design '{method}' are not a smaller one, so there are no"
            f" estimates from fewer samples; use {able}"
        )
    sizes = [size]
    while (size := -(-size // 2)) >= _FEWEST:
        sizes.append(size)
    return sizes[::-1]


def method_shown(ds: xr.Dataset) -> str | None:
    """Return the method whose indices are estimated from the first rows, if they suffice."""
    groups = len(np.unique(ds["group"])) * ds.attrs["replicates"]
    name = piloted_by(DESIGNS[ds.attrs["design"]])
    return name if name and groups >= METHODS[name].least else None


Line = tuple[str, str, tuple[float, float, float], str, str]


def estimates_from(ds: xr.Dataset, targets: list[str]) -> Iterator[Line]:
    """Yield what some rows give: output, label, value with interval; of an index kind and input."""
    for name, output in summarise(ds).outputs.items():
        for one in output.statistics:
            if one.is_read_by(Reader.RUNNING):
                yield name, one.label, one.estimate.finite.numbers, "", ""
    if method := method_shown(ds):
        for name, found in sensitivities(ds, method, targets).targets.items():
            for kind, values in found.kinds().items():
                for label, index in values.items():
                    yield name, f"{kind.key} {label}", index.numbers, kind.key, label
