"""From rows of parameters to outputs, with processes beside wear by impact."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.beam import batch as of_the_beam
from models.beam.outputs import MAP_NODES
from models.beam.parameters import Params, Rows, Settings
from models.beam.processes import (
    NO_BAND,
    NO_OPENING,
    has_band,
    has_processes,
    never_opens,
)
from models.beam.structure.modal import Array
from uq.contract import Status

_Beams = tuple[dict[str, NDArray[Any]], NDArray[np.int8]]
_Batch = _Beams | tuple[dict[str, NDArray[Any]], NDArray[np.int8], dict[int, str]]


def batch(x: Array, seed: NDArray[np.uint64], settings: Settings) -> _Batch:
    """Compute n rods.

    One for which no process beside wear by impact is on keeps the way of `models.beam.batch`.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        Parameters in the order of `Params`.
    seed : ndarray of uint64, shape (n,)
        Of the random force.
    settings : Settings

    Returns
    -------
    outputs : dict of str to ndarray, shape (n, ...)
        Those of `models.beam.outputs.OUTPUTS`, with ``*_censored``.
    status : ndarray of int8, shape (n,)
    reasons : dict of int to str
        Of rows refused; only if there are some.
    """
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    slow = has_processes(p, settings)
    outputs, status = of_the_beam.batch(x, seed, settings, ~slow)
    if settings.growths:
        _add_growths(outputs, x, seed, settings, ~slow)
    add_openings(outputs)
    if settings.map_growth > 0:
        _add_maps(outputs, settings)
    refused = refused_rows(p, settings)
    followed = slow & (status != Status.NON_FINITE) & ~np.isnan(outputs["work_rate_heavy"])
    followed &= ~np.isin(np.arange(len(x)), list(refused))
    if settings.instants:
        from models.beam.service.life_outputs import add_gaps  # late: its kernels are many

        add_gaps(outputs, p, settings)
    if followed.any():
        from models.beam.service.life_outputs import follow

        follow(outputs, status, p, seed, settings, followed)
    refuse(outputs, status, refused)
    return (outputs, status, refused) if refused else (outputs, status)


def refuse(
    outputs: dict[str, NDArray[Any]], status: NDArray[np.int8], refused: dict[int, str]
) -> None:
    """Set the outputs and status of refused rods."""
    for i in refused:
        status[i] = Status.NON_FINITE
        for values in outputs.values():
            if values.dtype.kind == "f":
                values[i] = np.nan
            elif values.dtype == np.int8:
                values[i] = -1


def _add_maps(outputs: dict[str, NDArray[Any]], settings: Settings) -> None:
    """Add the maps of work-rates of beams, of which nothing is mapped so far."""
    shape = (len(outputs["work_rate"]), max(1, len(settings.duty)), 2)
    outputs["mapped_gap"] = np.full(shape, np.nan)
    for name in ("mapped_work_rate", "mapped_work_rate_error"):
        outputs[name] = np.full((*shape, MAP_NODES, MAP_NODES), np.nan)


def refused_rows(p: Rows, settings: Settings) -> dict[int, str]:
    """Return the rods that cannot be computed, with the reason."""
    closed, bandless = never_opens(p, settings), ~has_band(p)
    reasons = dict.fromkeys(np.flatnonzero(closed).tolist(), NO_OPENING)
    return reasons | dict.fromkeys(np.flatnonzero(bandless).tolist(), NO_BAND)


def add_openings(outputs: dict[str, NDArray[Any]]) -> None:
    """Add the times to opening of beams: their gaps are open."""
    sites = outputs["time_to_depth"][:, :, 0]
    opened = np.where(np.isnan(sites), np.nan, 0.0)
    outputs["time_to_opening"], outputs["time_to_opening_error"] = opened, opened.copy()
    outputs["time_to_opening_censored"] = np.zeros(sites.shape, bool)


def _add_growths(
    outputs: dict[str, NDArray[Any]],
    x: Array,
    seed: NDArray[np.uint64],
    settings: Settings,
    followed: NDArray[np.bool_],
) -> None:
    """Add the times to growths of gaps of beams: lives to these depths."""
    choices = replace(settings, depths=settings.growths, instants=())
    again, _ = of_the_beam.batch(x, seed, choices, followed)
    for end in ("", "_error", "_censored"):
        outputs[f"time_to_gap_growth{end}"] = again[f"time_to_depth{end}"]
