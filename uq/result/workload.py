"""Workload: rows of one model to compute, and running statistics of arriving rows."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Model, censored_name
from uq.result import result_file
from uq.study.row_sampling import Rows, group_size, row_block, rows

if TYPE_CHECKING:
    from uq.study.definition import Study
    from uq.study.evaluate import Chunk


Finish = Callable[
    [Rows, Mapping[str, NDArray[Any]], NDArray[np.int8], Mapping[str, str]], xr.Dataset
]


class Workload(NamedTuple):
    """Rows to be computed.

    Attributes
    ----------
    model : Model
    model_reference : str
        Reference with which `uq.study.installed_models.model_at` loads the model in any process.
    settings : object
        An instance of ``model.settings``.
    total : int
        Rows in all.
    group : int
        Rows that one kernel call computes together.
    block : callable
        ``block(start, stop)`` -> those `Rows`, the same bits for any start and stop.
    finish : callable
        ``finish(rows, columns, status, failures)`` -> Dataset of all rows, or None if none is
        needed.
    output : str
        The only output, if a cheap one is computed alone; see `uq.contract.Model.cheap`.
    shown : tuple of str
        Outputs to be shown while rows arrive.
    """

    model: Model
    model_reference: str
    settings: Any
    total: int
    group: int
    block: Callable[[int, int], Rows]
    finish: Finish | None = None
    output: str = ""
    shown: tuple[str, ...] = ()


def workload_of(study: "Study") -> Workload:
    """Return the rows of a study as a workload."""
    return Workload(
        study.model,
        study.model_reference,
        study.settings,
        rows(study),
        group_size(study),
        partial(row_block, study),
        partial(result_file.build, study),
        shown=study.analysis.outputs,
    )


_KEPT = 4096
"""Maximum number of stored values of a life; beyond it, every second, fourth ... is stored."""


class Preview:
    """Running statistics of the rows of a run in bounded memory; they do not enter the result.

    Parameters
    ----------
    workload : Workload
    """

    def __init__(self, workload: Workload) -> None:
        self._regimes: tuple[str, ...] = ()
        self._life, self._label = "", ""
        self._lives = _Thinned()
        outputs = workload.model.outputs
        if "regime" in outputs and outputs["regime"].is_category:
            self._regimes = outputs["regime"].categories
        lives = [
            name
            for name in workload.shown
            if outputs[name].is_lifetime and outputs[name].unit == "s"
        ]
        if lives:  # the first element of the first life represents all
            self._life, dims = lives[0], outputs[lives[0]].dims
            coordinates = workload.model.coordinates(workload.settings)
            place = ",".join(f"{dim}={list(coordinates[dim])[0]}" for dim in dims)
            self._label = f"{self._life}[{place}]" if place else self._life
        self._counts = np.zeros(len(self._regimes), dtype=np.int64)

    def add(self, chunk: "Chunk") -> None:
        """Include the rows of a chunk."""
        if self._regimes:
            codes = chunk.columns["regime"]
            self._counts += np.bincount(codes[codes >= 0], minlength=len(self._counts))
        if self._life:
            first: Any = (slice(None), *[0] * (chunk.columns[self._life].ndim - 1))
            values = chunk.columns[self._life][first]
            if (flag := censored_name(self._life)) in chunk.columns:
                values = np.where(chunk.columns[flag][first], np.inf, values)
            self._lives.add(values[~np.isnan(values)])

    @property
    def median(self) -> tuple[str, float] | None:
        """Name and median of a life [s], inf if most rows do not end; None without a life."""
        median = self._lives.median
        return None if median is None else (self._label, median)

    @property
    def shares(self) -> dict[str, float]:
        """Share of each regime that occurs, the largest first."""
        total = int(self._counts.sum())
        pairs = zip(self._regimes, self._counts.tolist(), strict=True)
        shares = {name: count / total for name, count in pairs if count}
        return dict(sorted(shares.items(), key=lambda pair: -pair[1]))


class _Thinned:
    """Systematic subsample of a stream."""

    def __init__(self) -> None:
        self._values: Floats = np.empty(0)
        self._step, self._next = 1, 0

    def add(self, values: NDArray[Any]) -> None:
        taken = values[self._next :: self._step]
        self._next = self._next + len(taken) * self._step - len(values)
        self._values = np.append(self._values, taken)
        while len(self._values) > _KEPT:
            if len(self._values) % 2:
                self._next += self._step
            self._values = self._values[::2]
            self._step *= 2

    @property
    def median(self) -> float | None:
        if not len(self._values):
            return None
        return float(np.partition(self._values, len(self._values) // 2)[len(self._values) // 2])
