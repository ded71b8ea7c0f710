"""Outputs of rods that depend on their lives in service."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Params, Rows, Settings
from models.beam.service.lives import ServiceLives, drift_of, gaps_when_new, scars_of
from models.beam.service.shared_lives import find_shared_lives
from models.beam.service.work_maps import WorkMaps
from models.beam.start import wear_shares
from models.beam.structure.modal import Array
from models.numerics.duty import history_numbers
from models.numerics.gap_drift import drift
from models.numerics.scars import scar_volume
from uq.contract import Status

MAPS = ("mapped_gap", "mapped_work_rate", "mapped_work_rate_error")
"""Outputs that keep a map."""


def follow(
    outputs: dict[str, NDArray[Any]],
    status: NDArray[np.int8],
    p: Rows,
    seed: NDArray[np.uint64],
    settings: Settings,
    followed: NDArray[np.bool_],
    maps: WorkMaps | None = None,
) -> None:
    """Find the lives of some rods, and set their outputs and status.

    With maps, the beams are not followed where nothing is mapped.
    """
    rows = np.flatnonzero(followed)
    q: Rows = Params._make(field[rows] for field in p)
    shares = np.where(q.random_force_level > 0, seed[rows], np.uint64(0))
    kept = None if maps is None else WorkMaps._make(field[rows] for field in maps)
    lives = find_shared_lives(q, settings, shares, kept, maps is None)
    status[rows] = _note(outputs, rows, q, lives, settings)


def add_gaps(outputs: dict[str, NDArray[Any]], p: Rows, settings: Settings) -> None:
    """Add the gaps at the instants, and the shares of their growth by wear, from worn depths.

    Both are NaN once the scar has the last of the depths.
    """
    history, c = history_numbers(settings.gap_history), drift_of(p)
    moved = np.array([[drift(t, row, history) for t in settings.instants] for row in c])
    is_known = outputs["worn_depth"] < settings.depths[-1]
    worn = np.where(is_known, outputs["worn_depth"], np.nan)
    by_wear = (1 + p.support_wear_ratio)[:, None, None] * worn
    grown = by_wear + moved[:, None]
    outputs["gap"] = gaps_when_new(p)[:, :, None] + grown
    share = np.full_like(grown, np.nan)
    outputs["wear_share"] = np.divide(by_wear, grown, out=share, where=grown > 0)


def _note(
    outputs: dict[str, NDArray[Any]],
    rows: NDArray[np.intp],
    p: Rows,
    lives: ServiceLives,
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
    site = np.where(reached.any(axis=1), first[:, 0], -1)
    outputs["first_time_to_depth_cause"][rows] = site
    linear = linear_lives(outputs["work_rate"][rows], p, settings)
    outputs["linear_time_to_depth"][rows] = linear
    life = outputs["first_time_to_depth"][rows]
    whole = np.asarray(reached.any(axis=1))
    ratio = np.full_like(linear, np.nan)
    defined = whole & np.isfinite(linear)
    outputs["lifetime_ratio"][rows] = np.divide(linear, life, out=ratio, where=defined)
    outputs["gap_ratio"][rows] = _gap_ratio(p, lives, life, first[:, 0], whole, settings)
    outputs["regime_changes"][rows] = np.where(lives.lost, np.nan, lives.changes)
    unknown: NDArray[np.bool_] = np.zeros(n, bool)
    if settings.instants:
        worn = np.minimum(lives.worn, settings.depths[-1]).transpose(0, 2, 1)
        # A site at the last depth is not followed further, as a map may end there.
        instants = np.array(settings.instants)
        at_last = reached[:, :, -1, None] & (sites[:, :, -1, None] <= instants)
        worn = np.where(np.isnan(worn) & at_last, settings.depths[-1], worn)
        unknown = np.asarray(np.isnan(worn).any(axis=(1, 2)))
        outputs["worn_depth"][rows] = worn
        outputs["largest_worn_depth"][rows] = worn.max(axis=1)
        part = {"worn_depth": worn}
        add_gaps(part, p, settings)
        for name in ("gap", "wear_share"):
            outputs[name][rows] = part[name]
    if settings.map_growth > 0:
        gap = np.where(np.isfinite(lives.map_gap), lives.map_gap, np.nan)
        for name, values in zip(MAPS, (gap, lives.map_work, lives.map_error), strict=True):
            outputs[name][rows] = values
    unfinished = lives.lost | lives.unfinished | unknown
    status = np.where(unfinished, Status.OUT_OF_BUDGET, Status.OK)
    return status.astype(np.int8)


def linear_lives(work_rate: Array, p: Rows, settings: Settings) -> Array:
    """Return the earlier time to each depth at constant work-rates by Archard's law [s], (n, D).

    T = (1 + kappa)^(p - 1) B d^p/(k U).
    """
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
    lives: ServiceLives,
    life: Array,
    first: NDArray[np.intp],
    whole: NDArray[np.bool_],
    settings: Settings,
) -> Array:
    """Return the gap of the less worn site over that of the other at the first time to depth."""
    history, c = history_numbers(settings.gap_history), drift_of(p)
    begin = gaps_when_new(p)
    ratio = np.full(life.shape, np.nan)
    for i, j in zip(*np.nonzero(whole), strict=True):
        gaps = begin[i] + lives.at_depth[i, j] + drift(life[i, j], c[i], history)
        worn = gaps[first[i, j]]
        ratio[i, j] = gaps[1 - first[i, j]] / worn if worn > 0 else np.nan
    return ratio
