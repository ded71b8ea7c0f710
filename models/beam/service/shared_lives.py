"""Lives of rods that differ only in what scales them: one of them is integrated.

Without a clock beside the wear, T ~ B/k: time is counted in that of a reference rod, whose wear
coefficient and size of scars are nominal.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Params, Rows, Settings
from models.beam.processes import has_clock, scar_scales
from models.beam.service.lives import LONGEST, ServiceLives, find_service_lives
from models.beam.service.work_maps import WorkMaps
from models.beam.structure.modal import Array

_REFERENCE = Params()
_OF_CLOCKS = ("creep_time", "relaxed_share", "relaxation_time", "swelling_start")


def find_shared_lives(
    p: Rows,
    settings: Settings,
    seed: NDArray[np.uint64],
    maps: WorkMaps | None = None,
    follows: bool = True,
) -> ServiceLives:
    """Find the lives of n rods.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    settings : Settings
        A sequence of duty states that repeats often in a life counts as mixed.
    seed : ndarray of uint64, shape (n,)
        Of the random force.
    maps : WorkMaps, optional
        From an earlier computation.
    follows : bool
        Whether the beams are followed where nothing is mapped.

    Returns
    -------
    ServiceLives
    """
    if not settings.duty or settings.order == "mixed":
        return _find(p, settings, seed, maps, follows)
    cycle = sum(
        float(value) for state in settings.duty for key, value in state if key == "duration"
    )
    mixed = replace(settings, duty=_shares(settings, cycle), order="mixed")
    lives = _find(p, mixed, seed, maps, follows)
    # Mixed, a depth is reached at most a cycle too early or too late.
    passed = lives.reached & (lives.time > 0)
    lives.error[passed] += cycle
    events = np.where(passed | lives.censored, lives.time, np.inf)
    few = np.flatnonzero(cycle > settings.accuracy * events.min(axis=1))
    if len(few):
        rods: Rows = Params._make(field[few] for field in p)
        kept = WorkMaps._make(field[few] for field in lives.maps)
        again = _find(rods, settings, seed[few], kept, follows)
        for values, part in zip(lives, again, strict=True):
            values[few] = part
    return lives


def _shares(settings: Settings, cycle: float) -> tuple[tuple[tuple[str, str | float], ...], ...]:
    """Return the states of a sequence with their shares of its cycle instead of durations."""
    return tuple(
        tuple(
            ("share", float(value) / cycle) if key == "duration" else (key, value)
            for key, value in state
        )
        for state in settings.duty
    )


def _find(
    p: Rows, settings: Settings, seed: NDArray[np.uint64], maps: WorkMaps | None, follows: bool
) -> ServiceLives:
    """Find the lives of n rods; those of one reference rod once."""
    rods, unit = _reference_rods(p, settings)
    end = np.minimum(settings.horizon, LONGEST) * np.ones(len(seed))
    end[~np.asarray(has_clock(p, settings))] = LONGEST
    clock = unit if settings.instants else np.ones(len(seed))
    halves = np.stack([seed >> np.uint64(32), seed & np.uint64(0xFFFFFFFF)], axis=1)
    columns = np.column_stack([*rods, halves.astype(float), clock])
    _, first, back = np.unique(columns, axis=0, return_index=True, return_inverse=True)
    distinct: Rows = Params._make(field[first] for field in rods)
    kept = None if maps is None else WorkMaps._make(field[first] for field in maps)
    lives = find_service_lives(
        distinct, settings, seed[first], end[first], clock[first], kept, follows
    )
    return _in_time(lives.take(back.reshape(-1)), unit, settings.horizon)


def _reference_rods(p: Rows, settings: Settings) -> tuple[Rows, Array]:
    """Return the rods to integrate, and the time of each over that of its rod, shape (n,)."""
    scaling = {"wear_coefficient": -1.0, **scar_scales(settings)}
    free = ~np.asarray(has_clock(p, settings)) & np.ones(len(p.length), bool)
    unit = np.ones(len(free))
    fields = {}
    for name, exponent in scaling.items():
        values, nominal = getattr(p, name), getattr(_REFERENCE, name)
        unit[free] *= (values[free] / nominal) ** exponent
        fields[name] = np.where(free, nominal, values)
    for name in _OF_CLOCKS:
        fields[name] = np.where(free, getattr(_REFERENCE, name), getattr(p, name))
    return p._replace(**fields), unit


def _in_time(lives: ServiceLives, unit: Array, horizon: float) -> ServiceLives:
    """Return lives counted in units of time [s], censored at the horizon."""
    time, error = lives.time * unit[:, None], lives.error * unit[:, None]
    reached = lives.reached & (time <= horizon)
    censored = (lives.reached & ~reached) | lives.censored
    unfinished = np.asarray((censored & (time < horizon)).any(axis=1))
    return lives._replace(
        time=np.where(censored, np.minimum(time, horizon), time),
        error=np.where(reached, error, np.nan),
        censored=censored,
        reached=reached,
        unfinished=unfinished,
    )
