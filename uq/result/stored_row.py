"""A row of a result as plain numbers, as the result describes it: no model is needed."""

from collections import namedtuple
from dataclasses import dataclass
from typing import Any, NoReturn

from uq.contract import Model, censored_name
from uq.errors import InputError
from uq.result.one_row import Row
from uq.result.result import Result


def place_of(result: Result, number: int) -> int:
    """Return the place in a result of the row with a number.

    Raises
    ------
    InputError
        When there is no such row.
    """
    result.refuse_empty()
    numbers = result.dataset["row"].values
    places = (numbers == number).nonzero()[0]
    if not len(places):
        raise InputError(f"no such row: {number} (allowed: {numbers.min()} to {numbers.max()})")
    return int(places[0])


def stored_row(result: Result, place: int) -> Row:
    """Return a row of a result.

    Parameters
    ----------
    result : Result
    place : int
        As from `place_of`.

    Returns
    -------
    Row
        Its model declares what the result says, and cannot compute; its seed is 0.
    """
    stored = result.take([place])
    row, attrs = stored.dataset.load(), stored.dataset.attrs
    outputs = stored.outputs
    columns = {name: row[name].values for name in outputs}
    flags = [flag for name in outputs if (flag := censored_name(name)) in row]
    columns |= {flag: row[flag].values.astype(bool) for flag in flags}
    values = {
        str(name): float(variable.values.reshape(-1)[0])
        for name, variable in row.data_vars.items()
        if variable.attrs.get("role") in ("input", "fixed")
    }
    axes = {dim: row[dim].values.tolist() for output in outputs.values() for dim in output.dims}
    model = Model(
        name=str(attrs["model"]),
        title=str(attrs["title"]),
        version=str(attrs["model_version"]),
        parameters=namedtuple("Parameters", values),
        settings=_Nothing,
        outputs=outputs,
        batch=_refused,
        coordinates=lambda settings: axes,
    )
    return Row(model, _Nothing(), values, 0, columns, row["status"].values, {})


@dataclass(frozen=True)
class _Nothing:
    """No settings."""


def _refused(*arguments: Any) -> NoReturn:
    """Stand in for the batch function: rows of a result are shown, never computed."""
    raise NotImplementedError("this model only describes a result")
