"""Evaluation of a chunk of rows by the batch function of a model, with faulty rows isolated.

A batch that raises an exception or returns arrays of the wrong shape is bisected until the faulty
rows are found. Faulty rows get a status and a message; all others get their values.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask, Model, Output, Status, censored_name, high_name
from uq.errors import InputError, described


def columns_of(model: Model, settings: Any) -> dict[str, NDArray[Any]]:
    """Return template columns of a model's batch with these settings, in declared order.

    Returns
    -------
    dict of str to ndarray, shape (*dims)
        One blank row, which defines type and shape of every row.
    """
    coordinates = model.coordinates(settings)
    columns: dict[str, NDArray[Any]] = {}
    for name, output in model.outputs.items():
        shape = tuple(len(coordinates[dim]) for dim in output.dims)
        blank = np.int8(-1) if output.is_category else np.nan
        columns[name] = np.full(shape, blank)
        if output.has_censored_flag:
            columns[censored_name(name)] = np.full(shape, False)
        if output.may_be_between:
            columns[high_name(name)] = np.full(shape, np.nan)
    return columns


def failed_rows(status: NDArray[np.int8], required: Iterable[tuple[Output, NDArray[Any]]]) -> Mask:
    """Return the mask of failed rows.

    A row that is out of budget counts as failed only if an output is missing.

    Parameters
    ----------
    status : ndarray of int8, shape (n,)
    required : iterable of (Output, ndarray)
        Each output that must be defined, and its values, shape (n, *dims).

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    if not np.any(status == Status.OUT_OF_BUDGET):  # no output needs to be read
        return np.asarray(status != Status.OK)
    incomplete = np.zeros(len(status), dtype=np.bool_)
    for output, values in required:
        incomplete |= output.is_absent(values).any(axis=tuple(range(1, values.ndim)))
    return np.where(status == Status.OUT_OF_BUDGET, incomplete, status != Status.OK)


_WITH_OUTPUTS = (Status.OK, Status.OUT_OF_BUDGET)


class KernelError(InputError):
    """Raised if a model violates its contract, independent of the row."""


class Chunk(NamedTuple):
    """Results of n evaluated rows.

    Attributes
    ----------
    columns : dict of str to ndarray, shape (n, *dims)
    status : ndarray of int8, shape (n,)
    failures : dict of str to (int, str)
        Status label -> number of the first row with this status, and its message.
    """

    columns: dict[str, NDArray[Any]]
    status: NDArray[np.int8]
    failures: dict[str, tuple[int, str]]


def examples_of(failures: Mapping[str, tuple[int, str]]) -> dict[str, str]:
    """Return status label -> message of the first row with that status, from `Chunk.failures`."""
    return {label: f"row {row}: {text}" for label, (row, text) in failures.items()}


class RowFailure(NamedTuple):
    """Reason why rows have no values."""

    status: Status
    message: str


def evaluate(
    model: Model, settings: Any, x: Floats, seed: NDArray[np.uint64], start: int = 0
) -> Chunk:
    """Evaluate a model on a range of rows.

    Parameters
    ----------
    model : Model
    settings : object
        An instance of the model's settings.
    x : ndarray, shape (n, d)
        Parameters in declared order.
    seed : ndarray of uint64, shape (n,)
    start : int
        Number of the first row.

    Returns
    -------
    Chunk
        Results; rows that are neither ok nor out of budget are blank.

    Raises
    ------
    KernelError
        Names or dtypes are wrong, or a status or category does not exist.
    """
    expected = columns_of(model, settings)
    columns = _blank_rows(expected, len(x))
    status = np.zeros(len(x), dtype=np.int8)
    messages: dict[int, str] = {}
    todo = [(0, len(x))]
    while todo:
        first, last = todo.pop()
        # Copies, so that the kernel gets private writable arrays in every process.
        returned = _call(model, settings, x[first:last].copy(), seed[first:last].copy(), expected)
        if isinstance(returned, RowFailure) and last - first > 1:
            middle = (first + last) // 2
            todo += [(middle, last), (first, middle)]
        elif isinstance(returned, RowFailure):
            status[first] = returned.status
            messages[first] = returned.message
        else:
            outputs, codes, part_messages = returned
            for name, column in columns.items():
                column[first:last] = outputs[name]
            status[first:last] = codes
            messages |= {first + row: text for row, text in part_messages.items()}
    _check_values(model, columns, status, messages)
    lost = ~np.isin(status, _WITH_OUTPUTS)
    for name, column in columns.items():
        column[lost] = expected[name]
        if column.dtype.kind == "f":
            column[np.isnan(column)] = np.nan  # one bit pattern for NaN on all processors
    return Chunk(columns, status, _first_failures(status, messages, start))


def lost_rows(model: Model, settings: Any, rows: int, fault: RowFailure, start: int = 0) -> Chunk:
    """Return blank rows that failed for the same reason; `start` as in `evaluate`."""
    status = np.full(rows, fault.status, dtype=np.int8)
    columns = _blank_rows(columns_of(model, settings), rows)
    return Chunk(columns, status, {fault.status.label: (start, fault.message)})


def _blank_rows(columns: Mapping[str, NDArray[Any]], rows: int) -> dict[str, NDArray[Any]]:
    return {name: np.full((rows, *blank.shape), blank) for name, blank in columns.items()}


def joined(chunks: Sequence[Chunk]) -> Chunk:
    """Return the concatenation of consecutive chunks."""
    if len(chunks) == 1:
        return chunks[0]
    failures: dict[str, tuple[int, str]] = {}
    for chunk in chunks:
        failures = chunk.failures | failures  # keep the first of each status
    return Chunk(
        {name: np.concatenate([chunk.columns[name] for chunk in chunks]) for name in chunks[0][0]},
        np.concatenate([chunk.status for chunk in chunks]),
        failures,
    )


_STATUS = np.zeros((), np.int8)


def _call(
    model: Model,
    settings: Any,
    x: Floats,
    seed: NDArray[np.uint64],
    expected: Mapping[str, NDArray[Any]],
) -> tuple[Mapping[str, NDArray[Any]], NDArray[np.int8], Mapping[int, str]] | RowFailure:
    try:
        with np.errstate(all="ignore"):
            returned = model.batch(x, seed, settings)
    except Exception as error:
        return RowFailure(Status.RAISED, described(error))
    if not isinstance(returned, tuple) or len(returned) not in (2, 3):
        raise _violation(model, "batch must return (outputs, status)")
    outputs, status, messages = (*returned, {})[:3]
    faults = [
        *(f"returned no output '{name}'" for name in expected if name not in outputs),
        *(f"returned '{name}', which is not declared" for name in outputs if name not in expected),
    ]
    if faults:
        raise _violation(model, *faults)
    for name, column in (*expected.items(), ("status", _STATUS)):
        array = status if name == "status" else outputs[name]
        if not isinstance(array, np.ndarray):
            kind = type(array).__name__
            raise _violation(model, f"'{name}' is a {kind}, expected an array of {column.dtype}")
        if array.dtype != column.dtype:
            raise _violation(model, f"'{name}' is {array.dtype}, expected {column.dtype}")
        if array.shape != (len(x), *column.shape):
            wrong = f"'{name}' has shape {array.shape}, expected {(len(x), *column.shape)}"
            return RowFailure(Status.BAD_SHAPE, wrong)
    unknown = np.setdiff1d(status, list(Status))
    if unknown.size:
        raise _violation(model, f"no such status: {unknown[0]}")
    return outputs, status, messages


def _violation(model: Model, *faults: str) -> KernelError:
    return KernelError(*(f"model '{model.name}': {fault}" for fault in faults))


def _check_values(
    model: Model,
    columns: Mapping[str, NDArray[Any]],
    status: NDArray[np.int8],
    messages: dict[int, str],
) -> None:
    """Reject undeclared categories; set the status of rows marked ok with invalid numbers."""
    for name, output in model.outputs.items():
        values = columns[name].reshape(len(status), -1)
        if output.is_category:
            if np.any((values < -1) | (values >= len(output.categories))):
                raise _violation(model, f"'{name}' has an undeclared category")
            continue
        invalid = output.is_invalid(values)
        guilty = (status == Status.OK) & invalid.any(axis=1)
        status[guilty] = Status.NON_FINITE
        for row in np.flatnonzero(guilty)[:1]:
            messages[row] = f"'{name}' {output.absence(values[row][invalid[row]][0])}"


def _first_failures(
    status: NDArray[np.int8], messages: Mapping[int, str], start: int
) -> dict[str, tuple[int, str]]:
    codes, firsts = np.unique(status, return_index=True)
    return {
        kind.label: (start + row, messages.get(row, kind.meaning))
        for kind, row in zip(map(Status, codes), firsts.tolist(), strict=True)
        if kind != Status.OK
    }
