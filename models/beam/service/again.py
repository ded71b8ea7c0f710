"""Rods computed again from their mapped work-rates, under other wear, creep and duty."""

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import FACTORS, OF_PROCESSES, Params, Rows, Settings
from models.beam.service.batch import add_openings, refuse, refused_rows
from models.beam.service.life_outputs import add_gaps, follow
from models.beam.service.lives import OF_WEAR
from models.beam.service.work_maps import WorkMaps
from models.beam.structure.modal import Array
from models.numerics.duty import FACTORS as DUTY_FACTORS
from models.numerics.duty import OFFSET, duty_numbers
from uq.contract import Kept, Status

_FREE_SETTINGS = (
    "depths", "growths", "instants", "horizon", "accuracy", "wall_thickness", "scar", "wear_law",
    "wear_law_numbers", "gap_history", "duty", "order",
)  # fmt: skip
"""Settings that may change; of duty what does not move the beam."""

_NOT_MAPPED = "a gap leaves the range in which work-rates are mapped, or none are"


def again(x: Array, seed: NDArray[np.uint64], settings: Settings, kept: Kept) -> Any:
    """Compute n rods again from their mapped work-rates, under other wear, creep and duty.

    Parameters
    ----------
    x, seed, settings
        As for `batch`.
    kept : Kept
        The rods as computed before.

    Returns
    -------
    outputs, status, reasons
        As from `batch`. Out of budget are rods that leave the gaps of their map, or have none.

    Raises
    ------
    ValueError
        In one line, where another input or setting differs than those of wear, creep and duty.
    """
    _refuse_other_changes(x, settings, kept)
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    outputs: dict[str, NDArray[Any]] = {
        name: values.copy() for name, values in kept.outputs.items() if not _depends_on_wear(name)
    }
    n, depths, growths = len(x), len(settings.depths), len(settings.growths)
    shapes = {"time_to_depth": (2, depths), "first_time_to_depth": (depths,)}
    if growths:
        shapes["time_to_gap_growth"] = (2, growths)
    for name, shape in shapes.items():
        outputs[name], outputs[f"{name}_error"] = np.full((2, n, *shape), np.nan)
        outputs[f"{name}_censored"] = np.zeros((n, *shape), bool)
    outputs["first_time_to_depth_cause"] = np.full((n, depths), -1, np.int8)
    for name in ("linear_time_to_depth", "lifetime_ratio", "gap_ratio"):
        outputs[name] = np.full((n, depths), np.nan)
    outputs["regime_changes"] = np.full(n, np.nan)
    if settings.instants:
        outputs["worn_depth"] = np.full((n, 2, len(settings.instants)), np.nan)
        outputs["largest_worn_depth"] = np.full((n, len(settings.instants)), np.nan)
        add_gaps(outputs, p, settings)
    add_openings(outputs)
    gap = np.where(np.isnan(outputs["mapped_gap"]), np.inf, outputs["mapped_gap"])
    maps = WorkMaps(gap, outputs["mapped_work_rate"], outputs["mapped_work_rate_error"])
    status = np.zeros(n, np.int8)
    refused = refused_rows(p, settings)
    followed = ~np.isnan(outputs["work_rate_heavy"])
    status[~followed] = Status.NON_FINITE
    followed &= ~np.isin(np.arange(n), list(refused))
    follow(outputs, status, p, seed, settings, followed, maps)
    refuse(outputs, status, refused)
    reasons = dict.fromkeys(np.flatnonzero(status == Status.OUT_OF_BUDGET).tolist(), _NOT_MAPPED)
    return outputs, status, reasons | refused


def _depends_on_wear(name: str) -> bool:
    """Return whether an output of a beam depends on what wears it."""
    starts = ("work_rate", "mapped", "peak", "regime", "period", "floquet", "fundamental")
    return not name.startswith(starts) or name == "regime_changes"


def _refuse_other_changes(x: Array, settings: Settings, kept: Kept) -> None:
    before: Settings = kept.settings
    if not before.map_growth > 0:
        raise ValueError("no work-rates are mapped: compute the rows with settings.map_growth")
    moves = ~np.isin(Params._fields, (*OF_PROCESSES, *OF_WEAR))
    changed = np.flatnonzero((x != kept.x).any(axis=0) & moves)
    if len(changed):
        name = Params._fields[changed[0]]
        raise ValueError(f"{name} moves the beam: only wear, creep and duty can change")
    preload = Params._fields.index("preload_deflection")
    if (x[:, preload] != kept.x[:, preload]).any():
        raise ValueError("preload_deflection moves the gaps at which the maps begin")
    for field in fields(settings):
        name = field.name
        if name not in _FREE_SETTINGS and getattr(settings, name) != getattr(before, name):
            raise ValueError(f"{name} moves the beam: only wear, creep and duty can change")
    if not _moves_alike(settings, before):
        raise ValueError("duty: the work-rates of other states of duty are not mapped")


def _moves_alike(settings: Settings, other: Settings) -> bool:
    """Return whether the states of duty move the beam as the same states of other settings do."""
    first, second = (
        duty_numbers(choices.duty, choices.order, FACTORS) for choices in (settings, other)
    )
    moving = [OFFSET, *range(DUTY_FACTORS, first.shape[1])]
    return first.shape == second.shape and bool((first[:, moving] == second[:, moving]).all())
