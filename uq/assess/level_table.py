"""Variance shares by level as a Dataset."""

from typing import Any

import numpy as np
import xarray as xr

from uq.assess.level_shares import by_level
from uq.assess.variance_by_level import SOURCES
from uq.result.result import AnyResult, Result
from uq.stats.importance_weights import quality


def levels(result: AnyResult, output: str | None = None, *, plain: bool = False) -> xr.Dataset:
    """Apportion the variance to what units share, what is their own, chance, and the solver.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result, or a posterior of `uq.update`, of units never inspected.
    output : str, optional
        Only this output, or this element of one; by default those that the study shows.
    plain : bool, optional
        Whether to take lives as computed; by default what only scales a life is integrated: its
        part of the variance is known exactly, and only that of everything else is estimated.

    Returns
    -------
    xarray.Dataset
        Over ``output`` and ``level`` (``shared``, ``own``, ``chance``, ``solver``): ``share`` of
        the variance, with its 95 % interval ``share_low`` and ``share_high``, and ``reason``, why
        one of them is NaN; ``assumes`` where a share contains another. Over ``output``:
        ``variance`` (the sum of the three components), ``samples_left_out`` and ``integrated``,
        names of inputs separated by spaces. The share of the solver, from ``<output>_error``, is
        contained in the others. Lifetimes are replaced by their logarithms, or by their ranks where
        rows never end or are censored; a value with a heavy tail likewise. Of a model with regimes:
        over ``sample``, ``another_regime``, the share of the other repeats of its unit that end in
        another regime; ``another_regime_mean``, with ``_low`` and ``_high``, their mean.

    Raises
    ------
    InputError
        When the rows do not follow the laws of the inputs, or there is no such output.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> float(uq.levels(ds)["share"].sel(level="own")[0])  # every input is a unit's own
    1.0
    """
    result = Result.of(result)
    decomposition = by_level(result, output, plain=plain)
    data: dict[str, Any] = {}
    for name, end in (("share", "value"), ("share_low", "low"), ("share_high", "high")):
        data[name] = _over(decomposition.outputs.values(), end, float)
    for name in ("reason", "assumes"):
        data[name] = _over(decomposition.outputs.values(), name, str)
    data["variance"] = ("output", [target.variance for target in decomposition.outputs.values()])
    data["samples_left_out"] = (
        "output",
        [target.left_out for target in decomposition.outputs.values()],
    )
    integrated = [" ".join(target.integrated) for target in decomposition.outputs.values()]
    data["integrated"] = ("output", np.array(integrated, dtype=str))
    if decomposition.another_regime is not None:
        data["another_regime"] = ("sample", decomposition.switching)
        for end, value in zip(
            ("mean", "low", "high"), decomposition.another_regime.numbers, strict=True
        ):
            data["another_regime_mean" + f"_{end}" * (end != "mean")] = value
    attrs: dict[str, Any] = {
        "samples": decomposition.samples,
        "units_per_sample": decomposition.units,
        "repeats": decomposition.repeats,
    }
    attrs |= quality(decomposition.weights)
    coords = {"output": list(decomposition.outputs), "level": list(SOURCES)}
    return xr.Dataset(data, coords, attrs)


def _over(outputs: Any, name: str, kind: type) -> tuple[tuple[str, str], Any]:
    cells = [[getattr(target.shares[source], name) for source in SOURCES] for target in outputs]
    return ("output", "level"), np.array(cells, dtype=kind).reshape(-1, len(SOURCES))
