"""Rows of one model that are to be computed, by a study or any other analysis."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Model
from uq.result import result_file
from uq.study.row_sampling import Rows, group_size, row_block, rows

if TYPE_CHECKING:
    from uq.study.definition import Study

Finish = Callable[
    [Rows, Mapping[str, NDArray[Any]], NDArray[np.int8], Mapping[str, str]], xr.Dataset
]


class Workload(NamedTuple):
    """Rows to be computed.

    Attributes
    ----------
    model : Model
    model_reference : str
        By which `uq.study.installed_models.model_at` finds the model in any process.
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
