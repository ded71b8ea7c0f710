"""Distances and temperatures of n moles: their rates, by settled responses along the way."""

from collections.abc import Generator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.mole.drive import COPPER, Drive, Rates, Task, drive
from models.mole.parameters import (
    AS_PRINTED,
    BY_DISTANCE,
    BY_HEAT,
    BY_REFUSAL,
    FORMULATIONS,
    Rows,
    Settings,
)
from models.mole.response.machines import Machines
from models.mole.response.measured import Response
from models.mole.response.settled import mean_rate, respond
from models.numerics.course import NEVER, REACHED, Course

_STILL = 1e-7
"""Mean velocity [m s-1] below which motion that repeats is not told from standing still; or the
tolerance, if that is larger."""

_NEGATIVE = (
    "mole_friction + friction_gradient x distance < 0: the friction would be negative at the last"
    " distance"
)
_UNBALANCED = (
    "soil_limit > 0 with formulation 'as-printed', which creates energy: choose 'physical' or"
    " 'paper'"
)


def refused(p: Rows, settings: Settings) -> dict[int, str]:
    """Return the rows whose ground cannot be, and why."""
    reasons: dict[int, str] = {}
    if settings.formulation == FORMULATIONS[AS_PRINTED]:
        pushed = (p.soil_limit > 0) | (p.soil_limit_gradient > 0)
        reasons |= dict.fromkeys(np.flatnonzero(pushed).tolist(), _UNBALANCED)
    if settings.distance:
        negative = p.mole_friction + p.friction_gradient * settings.distance[-1] < 0
        reasons |= dict.fromkeys(np.flatnonzero(negative).tolist(), _NEGATIVE)
    return reasons


def drives(
    p: Rows, machines: Machines, response: Response, settings: Settings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.bool_]]:
    """Follow n moles, from their settled responses, to all distances and temperatures.

    Returns
    -------
    outputs : dict of str to ndarray, shape (n, k)
    lost : ndarray of bool, shape (n,)
        Rows of which a later response could not be computed.
    """
    n = len(response.time)
    changes = (p.friction_gradient != 0) | (p.soil_limit_gradient != 0)
    machines = Machines(machines.system, machines.record.copy())
    changing = settings.distance[-1] if settings.distance else 0.0
    ways: list[Drive | None] = [None] * n
    going: dict[int, Generator[tuple[float, float], Rates, Drive]] = {}
    wanted: dict[int, tuple[float, float]] = {}
    for i in np.flatnonzero(np.isfinite(response.time)).tolist():
        task = Task(
            settings.distance,
            settings.temperature,
            changing if changes[i] else 0.0,
            float(p.coil_thermal_resistance[i]),
            float(p.coil_thermal_capacity[i]),
            1 / float(p.control_frequency[i]),
        )
        going[i] = drive(task)
        wanted[i] = next(going[i])
    rows, rates = np.array(list(going), np.int64), _rates(p.resistance, response, settings)
    rates = rates[rows]
    while len(rows):
        for i, each in zip(rows.tolist(), rates.tolist(), strict=True):
            try:
                wanted[i] = going[i].send(Rates(*each))
            except StopIteration as ended:
                ways[i] = ended.value
                del wanted[i]
        rows = np.array(list(wanted), np.int64)
        if len(rows):
            rates = _rates_at(rows, np.array(list(wanted.values())), p, machines, settings)
    outputs: dict[str, NDArray[Any]] = {}
    if settings.distance:
        outputs |= _times("distance", [way and way.distance for way in ways], settings)
        outputs["time_to_distance_cause"] = _causes(ways, outputs["time_to_distance_censored"])
    if settings.temperature:
        outputs |= _times("temperature", [way and way.temperature for way in ways], settings)
        none = [np.nan] * len(settings.temperature)
        warmths = [way.warmths if way else none for way in ways]
        speeds = [way.speeds if way else none for way in ways]
        outputs["warm_temperature"] = np.array(warmths, float)
        outputs["warm_progression_rate"] = np.array(speeds, float)
        warmths = [way.warmth_errors if way else none for way in ways]
        speeds = [way.speed_errors if way else none for way in ways]
        outputs["warm_temperature_error"] = np.array(warmths, float)
        outputs["warm_progression_rate_error"] = np.array(speeds, float)
    return outputs, np.array([way is not None and way.lost for way in ways], bool)


def _rates_at(
    rows: NDArray[np.int64],
    places: NDArray[np.float64],
    p: Rows,
    machines: Machines,
    settings: Settings,
) -> NDArray[np.float64]:
    """Return the rates of some moles at places and temperatures (k, 2), from their last states."""
    q: Rows = type(p)._make(field[rows] for field in p)
    q = q._replace(
        mole_friction=np.maximum(q.mole_friction + q.friction_gradient * places[:, 0], 0.0),
        soil_limit=q.soil_limit + q.soil_limit_gradient * places[:, 0],
        resistance=q.resistance * (1 + COPPER * places[:, 1]),
    )
    here = machines.with_inputs(rows, q, settings)
    response = respond(here, settings)
    machines.record[rows] = here.record
    return _rates(q.resistance, response, settings)


def _rates(resistance: Any, response: Response, settings: Settings) -> NDArray[np.float64]:
    """Return `Rates` of n moles, shape (n, 4)."""
    repeats = response.period > 0
    speed, speed_error = mean_rate(response.progress, response.time, repeats)
    speed = np.where(repeats & (np.abs(speed) < max(_STILL, settings.tolerance)), 0.0, speed)
    squared, squared_error = mean_rate(response.squared, response.time, repeats)
    power, power_error = resistance * squared, resistance * squared_error
    return np.stack([speed, speed_error, power, power_error], axis=1)


def _causes(ways: list[Drive | None], censored: NDArray[np.bool_]) -> NDArray[np.int8]:
    """Return what ended each drive, or holds a mole for ever; -1 where neither is known."""
    causes = np.full(censored.shape, -1, np.int8)
    for i, way in enumerate(ways):
        if way is None:
            continue
        fates = np.array(way.distance.fates)
        held = BY_HEAT if way.cold_speed > 0 else BY_REFUSAL
        causes[i, fates == REACHED] = BY_DISTANCE
        causes[i, fates == NEVER] = -1 if np.isnan(way.cold_speed) else held
    causes[censored] = -1
    return causes


def _times(name: str, courses: list[Course | None], settings: Settings) -> dict[str, NDArray[Any]]:
    size = len(getattr(settings, name))
    times, errors = np.full((2, len(courses), size), np.nan)
    censored = np.zeros((len(courses), size), bool)
    for i, course in enumerate(courses):
        if course is not None:
            times[i], errors[i] = course.times, course.errors
            late = np.isfinite(times[i]) & (times[i] > settings.horizon)
            censored[i] = late | (np.array(course.fates) < REACHED)
    times = np.where(censored, np.minimum(times, settings.horizon), times)
    errors[censored] = np.nan
    return {
        f"time_to_{name}": times,
        f"time_to_{name}_censored": censored,
        f"time_to_{name}_error": errors,
    }
