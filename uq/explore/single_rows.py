"""Single rows: a single run of a model, or a recomputed row of a result."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Model, Status
from uq.errors import InputError
from uq.execution.loading import run_alone
from uq.execution.recomputation import (
    computed_again,
    differing,
    other_versions,
    settings_by_row,
    study_here,
)
from uq.files.interrupts import in_background
from uq.files.netcdf_files import refuse_tricks
from uq.result import result_file
from uq.result.elements import flags
from uq.result.one_row import Row, run_row
from uq.result.result import AnyResult, Result
from uq.result.row_choice import (
    Choice,
    highest_row,
    lowest_row,
    near_quantile_row,
    place_of,
    stored_row,
)
from uq.study.installed_models import model_at

MOST_SHOWN = 6
"""Maximum number of quantities in the figure of a time history."""

PLACES = ("world", "unit", "repeat", "replicate", "group", "block")
"""Variables with the design indices of a row."""


def simulate(
    model: str | Model,
    parameters: Mapping[str, float] | None = None,
    settings: Mapping[str, Any] | None = None,
    seed: int = 0,
    trajectory: bool = True,
) -> xr.Dataset:
    """Run a model once, at its nominal values except those given.

    Parameters
    ----------
    model : str or Model
        A model, or the name of an installed one.
    parameters : dict of str to float, optional
        In the units of the model.
    settings : dict, optional
        Numerical settings by name.
    seed : int
        0 to 2^64 - 1, for models that draw random numbers.
    trajectory : bool
        Whether to compute the time history as well.

    Returns
    -------
    xarray.Dataset
        One row of outputs and its status, all parameters, and, if the model has one,
        ``trajectory`` (time, quantity) with the unit of each quantity.

    Raises
    ------
    InputError
        When a name is unknown or a value is not admissible.

    Examples
    --------
    >>> uq.simulate("linear", {"x1": 0.25})["y"].item()  # x1 + 2 x2 + 3 x3 + 4 x4
    4.75
    """
    given = dict(parameters or {}), dict(settings or {}), seed
    row = run_alone(model, *given) if isinstance(model, str) else run_row(model, *given)
    return dataset(row, trajectory)


def dataset(row: Row, trajectory: bool = True) -> xr.Dataset:
    """Return a row as the Dataset of `simulate`."""
    ds = result_file.build_rows(
        row.model, row.settings, row.values, row.columns, row.status, row.failures
    )
    return with_trajectory(ds, row) if trajectory else ds


def with_trajectory(ds: xr.Dataset, row: Row) -> xr.Dataset:
    """Return a Dataset with the time history of a row, if its model gives one."""
    if row.model.simulate is None:
        return ds
    return ds.assign(trajectory=in_background(lambda: _trajectory(row)))


def holds_trajectory(path: Path) -> bool:
    """Return whether a file is a netCDF file from `simulate` with a trajectory."""
    try:
        refuse_tricks(path)
        with xr.open_dataset(path, engine="netcdf4", decode_timedelta=False) as ds:
            roles = [variable.attrs.get("role") for variable in ds.data_vars.values()]
            return "trajectory" in roles and "schema_version" in ds.attrs
    except result_file.UNREADABLE:
        return False


def _trajectory(row: Row) -> xr.DataArray:
    assert row.model.simulate is not None
    params = row.model.parameters(**row.values)
    history = row.model.simulate(params, row.settings, seed=row.seed)
    names = list(history.quantities)
    units, meanings, series = zip(*history.quantities.values(), strict=True)
    nowhere = (np.nan, np.nan)
    shown = history.shown or tuple(names[:MOST_SHOWN])
    return xr.DataArray(
        np.stack(series, axis=1),
        dims=("time", "quantity"),
        coords={
            "time": ("time", history.time, {"units": "s", "long_name": "time"}),
            "quantity": names,
            "units": ("quantity", list(units)),  # "unit" is that of the row in its sample
            "meaning": ("quantity", list(meanings)),
            "lower_stop": ("quantity", [history.stops.get(name, nowhere)[0] for name in names]),
            "upper_stop": ("quantity", [history.stops.get(name, nowhere)[1] for name in names]),
            "turns": ("quantity", [int(name in history.angles) for name in names]),
            "shown": ("quantity", [shown.index(name) if name in shown else -1 for name in names]),
        },
        attrs={"role": "trajectory", "long_name": "time history", "period": history.period},
    )


@dataclass(frozen=True)
class RowAgain:
    """A stored row of a result and its recomputation.

    Attributes
    ----------
    number : int
    stored : xarray.Dataset
        The row in the result, along a dimension ``sample`` of size 1.
    row : Row
        The same as plain numbers.
    again : Row or None
        None if it cannot be recomputed.
    differing : list of str
        The variables that are not bitwise equal.
    reason : str
        Why the rows are not equal; "" if they are.
    versions : dict of str to tuple of str
        Versions that differ from those that made the result: name -> (there, here).
    choice : Choice, optional
        The selection of this row.
    """

    number: int
    stored: Result
    row: Row
    again: Row | None = None
    differing: tuple[str, ...] = ()
    reason: str = ""
    versions: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    choice: Choice | None = None

    @property
    def equal(self) -> bool:
        """Whether computing it again gave the same bits."""
        return self.again is not None and not self.differing

    @property
    def place(self) -> dict[str, int | str]:
        """Design indices of the row, by name; for the block its label."""
        stored = self.stored
        indices: dict[str, int | str] = {
            name: int(stored.dataset[name][0]) for name in PLACES if name in stored.dataset
        }
        return indices | {
            "block": dict(flags(stored.dataset["block"]))[int(stored.dataset["block"][0])]
        }


def row(
    result: AnyResult,
    number: int | None = None,
    *,
    lowest: str | None = None,
    near_quantile: tuple[float, str] | None = None,
    model: str | None = None,
    trajectory: bool = True,
    highest: str | None = None,
) -> xr.Dataset:
    """Return one row of a result, computed again with its time history.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
    number : int, optional
        Of the row, from 0. Give this, `lowest`, `highest` or `near_quantile`.
    lowest : str, optional
        An output, or an element of one: take the row in which it is lowest. Lives that are censored
        count as longer than those that ended, lives that never end as the longest.
    near_quantile : tuple of float and str, optional
        A probability and an output or element: take the row closest to this quantile.
    model : str, optional
        Where the model lives, if it is not installed.
    trajectory : bool
        Whether to compute the time history as well.
    highest : str, optional
        As `lowest`: take the row in which it is highest.

    Returns
    -------
    xarray.Dataset
        The row in the result, with ``equal``: whether computing it again gives the same bits, or
        else its attribute ``reason``; and, if the model has one, ``trajectory`` (time, quantity).

    Raises
    ------
    InputError
        When there is no such row, output or model.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> shortest = uq.row(ds, lowest="life")
    >>> shortest["life"].item() == ds["life"].min().item(), shortest["equal"].item()
    (True, True)
    """
    recomputed = row_again(Result.of(result), number, lowest, near_quantile, model, highest=highest)
    attrs = {"long_name": "whether computing the row again gave the same bits"}
    reason = {"reason": recomputed.reason} if recomputed.reason else {}
    annotated = recomputed.stored.dataset.assign(equal=((), recomputed.equal, attrs | reason))
    if not trajectory or recomputed.again is None:
        return annotated
    return with_trajectory(annotated, recomputed.again)


def row_again(
    result: Result,
    number: int | None = None,
    lowest: str | None = None,
    near_quantile: tuple[float, str] | None = None,
    model: str | None = None,
    source: str = "this result",
    highest: str | None = None,
) -> RowAgain:
    """Find a row of a result and compute it again; see `row`."""
    if sum(given is not None for given in (number, lowest, highest, near_quantile)) != 1:
        raise InputError("give one of: the number of a row, --lowest, --highest, --near-quantile")
    result.refuse_if_weighted("a row computed again")
    choice = None
    if lowest is not None:
        choice = lowest_row(result, lowest)
    elif highest is not None:
        choice = highest_row(result, highest)
    elif near_quantile is not None:
        choice = near_quantile_row(result, *near_quantile)
    chosen = choice.number if choice else int(number or 0)
    place = place_of(result, chosen)
    stored, plain = result.take([place]), stored_row(result, place)
    stored.dataset.load()
    recomputed = RowAgain(chosen, stored, plain, choice=choice)
    return _computed(result, recomputed, place, model, source)


def _computed(
    result: Result, recomputed: RowAgain, place: int, model: str | None, source: str
) -> RowAgain:
    attrs, status = result.dataset.attrs, int(recomputed.row.status[0])
    if model is not None and (other := model_at(model).name) != attrs["model"]:
        raise InputError(f"--model {model}: is '{other}'; the rows are of '{attrs['model']}'")

    def without(reason: str) -> RowAgain:
        return replace(recomputed, reason=f"it cannot be computed again: {reason}")

    if status == Status.TIMED_OUT:
        return without("it outlived its time limit")
    try:
        study, change = study_here(
            attrs["study"],
            attrs["study_identity"],
            attrs["model_version"],
            int(attrs["samples"]),
            source,
            model,
        )
        if study.model.name != attrs["model"]:
            return without(
                f"'{study.model.name}' is not its model, '{attrs['model']}'; name that with --model"
            )
        settings = settings_by_row(result.dataset, study, np.array([place]))[place]
        again = computed_again(study, settings, recomputed.number, status)
        versions = other_versions(result.dataset, study.model_reference)
    except InputError as error:
        return without("; ".join(error.lines))
    names = tuple(differing(again, recomputed.stored.dataset))
    reason = _reason(change, versions, source) if names else ""
    if again.status == recomputed.row.status:  # the sentence of this row, not of the first such row
        recomputed = replace(recomputed, row=recomputed.row._replace(failures=again.failures))
    return replace(recomputed, again=again, differing=names, reason=reason, versions=versions)


def _reason(change: str, versions: Mapping[str, tuple[str, str]], source: str) -> str:
    """Return why a row may differ."""
    if change:
        return f"another model computed it ({change})"
    if "code" in versions:
        return "another version of the code of the model computed it"
    if versions:
        return f"it was computed with another {', '.join(versions)}"
    return (
        f"either {source} has been changed, which 'uq verify' checks, or the model does not return"
        " the same for the same row"
    )
