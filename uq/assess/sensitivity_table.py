"""Sensitivity indices as xarray arrays and as a tree of facts."""

from functools import partial
from math import isfinite
from typing import Any

import numpy as np
import xarray as xr

from uq.assess.fact import Fact
from uq.assess.sensitivities import Sensitivities, TargetIndices, sensitivities
from uq.indices.index import Null
from uq.indices.methods import indices_of
from uq.result.result import AnyResult, Result
from uq.stats.estimate import NOTHING
from uq.stats.estimate_json import numbers


def sensitivity(result: AnyResult, method: str | None = None) -> xr.Dataset:
    """Estimate sensitivity indices as arrays.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    method : str, optional
        By default the first of `methods`.

    Returns
    -------
    xarray.Dataset
        Each index over ``output`` and ``parameter`` (``S2`` over ``pair``), with ``_low`` and
        ``_high``; NaN where there is none. ``dummy_<index>``, ``groups_dropped`` and ``refused``
        (why there are no indices, or "") over ``output``; so is ``noise``, with ``_low`` and
        ``_high``, where a model is random. ``by_correlation`` over ``output`` and ``parameter``
        where an index is due to correlation alone.

    Raises
    ------
    InputError
        When the design cannot feed the method.

    Examples
    --------
    >>> found = uq.sensitivity(uq.run("studies/ishigami.toml"))
    >>> found["ST"].sel(output="y").to_series().round(2).to_dict()  # 0.558, 0.442, 0.244
    {'x1': 0.56, 'x2': 0.45, 'x3': 0.25}
    """
    result = Result.of(result)
    computed = sensitivities(result, method)
    targets = list(computed.targets.values())
    data: dict[str, Any] = {
        name: ("output", [getattr(target, name) for target in targets])
        for name in ("groups_dropped", "refused")
    }
    coords: dict[str, Any] = {"output": list(computed.targets)}
    # The indices of quantiles have other names for a lifetime.
    kinds = {
        kind: list(by_label)
        for target in targets
        for kind, by_label in target.indices.values.items()
    }
    for kind, labels in kinds.items():
        dim = "pair" if kind.of_pairs else "parameter"
        coords[dim] = labels
        estimates = [target.indices.values.get(kind, {}) for target in targets]
        table = [
            [by_label.get(label, NOTHING).numbers for label in labels] for by_label in estimates
        ]
        for end, values in zip(_ENDS, np.moveaxis(np.array(table), -1, 0), strict=True):
            data[f"{kind.key}{end}"] = (("output", dim), values)
    if any(target.indices.noise for target in targets):
        shares = np.array([(target.indices.noise or NOTHING).numbers for target in targets])
        for end, values in zip(_ENDS, shares.T, strict=True):
            data[f"noise{end}"] = ("output", values)
    if any(target.indices.by_correlation for target in targets):
        names = coords["parameter"]
        due = [[name in target.indices.by_correlation for name in names] for target in targets]
        data["by_correlation"] = (("output", "parameter"), due)
    for kind in {kind: None for target in targets for kind in target.indices.nulls}:
        nulls = [target.indices.nulls.get(kind, Null(np.nan)) for target in targets]
        data[f"dummy_{kind.key}"] = ("output", [null.limit for null in nulls])
        if np.isfinite([null.largest for null in nulls]).any():
            data[f"dummy_{kind.key}_any"] = ("output", [null.largest for null in nulls])
    return xr.Dataset(data, coords, {"method": computed.method})


_ENDS = ("", "_low", "_high")


def sensitivity_facts(sensitivities: Sensitivities) -> Fact:
    """Return the indices of all targets."""
    method = sensitivities.method
    return Fact(
        {
            "method": method,
            "rows_used": sensitivities.rows_used,
            "groups_dropped": sensitivities.groups_dropped,
            "outputs": {
                name: _target(target, method) for name, target in sensitivities.targets.items()
            },
        },
        (partial(indices_of, method, ""),),
        rows=sensitivities.rows,
    )


def _target(target: TargetIndices, method: str) -> Fact:
    indices, notes = target.indices, tuple(target.indices.notes)
    members: dict[str, Any] = {
        "rows_used": target.rows_used,
        "groups_dropped": target.groups_dropped,
    }
    if target.refused:
        return Fact(members | {"refused": target.refused})
    for kind, values in indices.values.items():
        by_input = {label: numbers(index) for label, index in values.items()}
        members[kind.key] = Fact(by_input, (partial(indices_of, method, kind.key),), notes=notes)
    if indices.noise is not None:
        members["noise"] = numbers(indices.noise)
    if indices.by_correlation:
        members["by_correlation"] = list(indices.by_correlation)
    if indices.nulls:
        members["dummy"] = {
            key: number
            for kind, null in indices.nulls.items()
            for key, number in ((kind.key, null.limit), (f"{kind.key}_any", null.largest))
            if isfinite(number)
        }
    return Fact(members | {"notes": list(notes)}, notes=notes)
