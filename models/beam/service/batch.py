"""From rows of parameters to outputs, with processes beside wear by impact."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from models.beam import batch as of_the_beam
from models.beam.parameters import Params, Rows, Settings
from models.beam.processes import has_processes
from models.beam.start import wear_shares
from models.beam.structure.modal import Array
from uq.contract import Status

if TYPE_CHECKING:
    from models.beam.service.lives import ServiceLives

_Beams = tuple[dict[str, NDArray[Any]], NDArray[np.int8]]
_Batch = _Beams | tuple[dict[str, NDArray[Any]], NDArray[np.int8], dict[int, str]]

_NO_OPENING = (
    "preload_deflection > 0 and nothing opens the gaps: set creep_down, or relaxed_share below 1"
)


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
    _add_openings(outputs)
    if settings.growths:
        _add_growths(outputs, x, seed, settings, ~slow)
    refused = _refused(p, settings)
    followed = slow & (status != Status.NON_FINITE) & ~np.isnan(outputs["work_rate_heavy"])
    rows = np.flatnonzero(followed & ~np.isin(np.arange(len(x)), list(refused)))
    if len(rows):
        from models.beam.service.lives import find_service_lives  # late: its kernels are many

        q: Rows = Params._make(field[rows] for field in p)
        shares = np.where(q.random_force_level > 0, seed[rows], np.uint64(0))
        lives = find_service_lives(q, settings, shares)
        status[rows] = _note(outputs, rows, q, lives, settings)
    for i in refused:
        status[i] = Status.NON_FINITE
        for values in outputs.values():
            if values.dtype.kind == "f":
                values[i] = np.nan
            elif values.dtype == np.int8:
                values[i] = -1
    return (outputs, status, refused) if refused else (outputs, status)


def _refused(p: Rows, settings: Settings) -> dict[int, str]:
    offsets = [value for state in settings.duty for key, value in state if key == "gap_offset"]
    opens = bool(settings.gap_history) or any(float(offset) > 0 for offset in offsets)
    is_preloaded = (p.preload_deflection > 0) & (p.creep_down == 0) & (p.relaxed_share == 1)
    return dict.fromkeys(np.flatnonzero(is_preloaded & (not opens)).tolist(), _NO_OPENING)


def _add_openings(outputs: dict[str, NDArray[Any]]) -> None:
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


def _note(
    outputs: dict[str, NDArray[Any]],
    rows: NDArray[np.intp],
    p: Rows,
    lives: "ServiceLives",
    settings: Settings,
) -> NDArray[np.int8]:
    """Set the outputs of some rows that depend on their lives; return their status."""
    n, count, more = len(rows), len(settings.depths), len(settings.growths)

    def put(name: str, part: slice, size: int) -> None:
        shape = (n, 2, size) if size else (n, 2)
        outputs[name][rows] = lives.time[:, part].reshape(shape)
        outputs[f"{name}_error"][rows] = lives.error[:, part].reshape(shape)
        outputs[f"{name}_censored"][rows] = lives.censored[:, part].reshape(shape)

    put("time_to_depth", slice(0, 2 * count), count)
    put("time_to_opening", slice(2 * count + 2 * more, None), 0)
    if more:
        put("time_to_gap_growth", slice(2 * count, 2 * count + 2 * more), more)
    sites = lives.time[:, : 2 * count].reshape(n, 2, count)
    reached = lives.reached[:, : 2 * count].reshape(n, 2, count)
    # A site that is censored may still be the first: only the times reached count, or none.
    first = np.where(reached, sites, np.inf).argmin(axis=1)[:, None]
    censored = lives.censored[:, : 2 * count].reshape(n, 2, count)
    none = ~reached.any(axis=1) & censored.any(axis=1)
    for name in ("", "_error", "_censored"):
        values = outputs[f"time_to_depth{name}"][rows]
        earlier = np.take_along_axis(values, first, axis=1)[:, 0]
        outputs[f"first_time_to_depth{name}"][rows] = earlier
    earliest = np.where(censored, sites, np.inf).min(axis=1)
    outputs["first_time_to_depth"][rows] = np.where(
        none, earliest, outputs["first_time_to_depth"][rows]
    )
    outputs["first_time_to_depth_censored"][rows] = none
    linear = linear_lives(outputs["work_rate"][rows], p, settings)
    outputs["linear_time_to_depth"][rows] = linear
    life = outputs["first_time_to_depth"][rows]
    whole = np.asarray(reached.any(axis=1))
    ratio = np.full_like(linear, np.nan)
    defined = whole & np.isfinite(linear)
    outputs["lifetime_ratio"][rows] = np.divide(linear, life, out=ratio, where=defined)
    outputs["gap_ratio"][rows] = _gap_ratio(p, lives, life, first[:, 0], whole, settings)
    outputs["regime_changes"][rows] = np.where(lives.lost, np.nan, lives.changes)
    if settings.instants:
        worn = np.minimum(lives.worn, settings.depths[-1]).transpose(0, 2, 1)
        outputs["worn_depth"][rows] = worn
        outputs["largest_worn_depth"][rows] = worn.max(axis=1)
    status = np.where(lives.lost | lives.unfinished, Status.OUT_OF_BUDGET, Status.OK)
    return status.astype(np.int8)


def linear_lives(work_rate: Array, p: Rows, settings: Settings) -> Array:
    """Return the earlier time to each depth at constant work-rates by Archard's law [s], (n, D).

    T = (1 + kappa)^(p - 1) B d^p/(k U).
    """
    from models.beam.service.lives import scars_of
    from models.numerics.scars import scar_volume

    shares = wear_shares(p)
    fastest = (work_rate * shares).max(axis=1) * p.wear_coefficient
    shape = scars_of(p, settings)
    linear = np.empty((len(fastest), len(settings.depths)))
    for i in range(len(fastest)):
        kappa = float(p.support_wear_ratio[i])
        for j, depth in enumerate(settings.depths):
            whole = (1 + kappa) * float(depth)
            volume = scar_volume(whole, shape.factor[i], shape.power[i], shape.tilt[i])
            linear[i, j] = volume / (1 + kappa) / fastest[i] if fastest[i] > 0 else np.inf
    return linear


def _gap_ratio(
    p: Rows,
    lives: "ServiceLives",
    life: Array,
    first: NDArray[np.intp],
    whole: NDArray[np.bool_],
    settings: Settings,
) -> Array:
    """Return the gap of the less worn site over that of the other at the first time to depth."""
    from models.beam.service.lives import drift_of, gaps_when_new
    from models.numerics.duty import history_numbers
    from models.numerics.gap_drift import drift

    history, c = history_numbers(settings.gap_history), drift_of(p)
    begin = gaps_when_new(p)
    ratio = np.full(life.shape, np.nan)
    for i, j in zip(*np.nonzero(whole), strict=True):
        gaps = begin[i] + lives.at_depth[i, j] + drift(life[i, j], c[i], history)
        worn = gaps[first[i, j]]
        ratio[i, j] = gaps[1 - first[i, j]] / worn if worn > 0 else np.nan
    return ratio
