"""From rows of parameters to disphasing angles, start-up and regimes."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.numerics.duty import FACTORS as FIRST_FACTOR
from models.numerics.duty import TIME, WEAR, duty_numbers
from models.vibrator.lanes.machines import follows, is_rigid
from models.vibrator.parameters import FACTORS, Params, Rows, Settings
from models.vibrator.run_down import run_downs
from models.vibrator.service.life import Lives, angles_in_service, lives
from models.vibrator.start import exact, fast
from models.vibrator.start.regimes import Outcome, wrapped
from models.vibrator.theory import averaged
from uq.contract import Status

_Start = tuple[NDArray[np.int8], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]]
"""Regimes, angles [rad], which are undecided, and which lanes can follow."""


def batch(
    x: NDArray[np.float64], seed: NDArray[np.uint64], settings: Settings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Compute n machines.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        Parameters in the order of `Params`.
    seed : ndarray of uint64, shape (n,)
        Of the times at which springs break; all else is deterministic.
    settings : Settings

    Returns
    -------
    outputs : dict of str to ndarray, shape (n,)
        Those of `models.vibrator.parameters.OUTPUTS`, with ``*_censored`` beside each lifetime.
    status : ndarray of int8, shape (n,)
    """
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    outcome, status, rigid = _outcomes(p, settings)
    outputs = {
        "disphasing_angle": outcome.disphasing,
        "theory_disphasing_angle": _theory_angle(p),
        "angular_amplitude": outcome.angular_amplitude,
        "stroke_left": outcome.stroke_left,
        "stroke_right": outcome.stroke_right,
        "speed": outcome.speed,
        "power_1": outcome.power_1,
        "power_2": outcome.power_2,
        "floquet_multiplier": outcome.multiplier,
        "synchronisation_time": outcome.synchronisation_time,
        "synchronisation_time_censored": outcome.censored,
        "max_excursion": outcome.max_excursion,
        "regime": outcome.regime,
    }
    seen = outcome.regime, outcome.disphasing, status == Status.OUT_OF_BUDGET
    if settings.duty:
        life, settings = _lives_in_duty(p, seed, (*seen, rigid), settings)
    else:
        life = lives(p, seed, *seen, rigid, settings)
    outputs |= {
        "time_to_disphasing": life.time,
        "time_to_disphasing_censored": life.censored,
        "time_to_disphasing_error": life.error,
        "time_to_disphasing_cause": life.cause,
    }
    if settings.service_times:
        outputs["service_angle"] = angles_in_service(p, seed, *seen[:2], rigid, settings)
    if settings.instants:
        angle, speed_1, speed_2 = np.moveaxis(outcome.on_the_way, 2, 0)
        outputs["run_up_angle"] = wrapped(angle)
        outputs["run_up_speed_1"], outputs["run_up_speed_2"] = speed_1, speed_2
    if settings.run_down_phases:
        outputs |= run_downs(p, *seen[:2], outcome.speed, rigid, settings)
    return outputs, status


def _outcomes(p: Rows, settings: Settings) -> tuple[Outcome, NDArray[np.int8], NDArray[np.bool_]]:
    """Return the starts of n machines, their status, and which of them lanes can follow."""
    n, in_lanes = len(p.body_mass), settings.propagator == "fast"
    quick, rigid = follows(p, settings) & in_lanes, is_rigid(p, settings) & in_lanes
    outcome = Outcome.nothing(n, len(settings.instants))
    status = np.full(n, Status.OK, np.int8)
    _run(fast.outcomes, p, np.flatnonzero(quick), settings, outcome, status)
    # The exact propagator also follows machines too stiff for fixed steps.
    stiff = status == Status.NON_FINITE
    _run(exact.outcomes, p, np.flatnonzero(~quick | stiff), settings, outcome, status)
    return outcome, status, rigid & ~stiff


def _lives_in_duty(
    p: Rows, seed: NDArray[np.uint64], start: _Start, settings: Settings
) -> tuple[Lives, Settings]:
    """Return the lives of n machines in mixed duty, and the settings in time of operation.

    Ageing does not depend on the feed: a life ends in the state of duty that ends it first. `start`
    is what `lives` needs of the starts with the nominal feed.
    """
    duty = duty_numbers(settings.duty, "mixed", FACTORS, has_gaps=False)
    runs = duty[(duty[:, TIME] > 0) & (duty[:, WEAR] > 0)]
    pace = float((runs[:, TIME] * runs[:, WEAR]).sum())
    operated = replace(
        settings,
        horizon=pace * settings.horizon,
        service_times=tuple(pace * time for time in settings.service_times),
    )
    in_states = []
    for state in np.unique(runs[:, FIRST_FACTOR:], axis=0):
        q, seen = p, start
        if (state != 1).any():
            q = p._replace(**{name: getattr(p, name) * state[i] for i, name in enumerate(FACTORS)})
            outcome, status, rigid = _outcomes(q, replace(operated, instants=()))
            seen = outcome.regime, outcome.disphasing, status == Status.OUT_OF_BUDGET, rigid
        in_states.append(lives(q, seed, *seen, operated))
    every = Lives(*(np.stack(fields) for fields in zip(*in_states, strict=True)))
    order = np.lexsort((every.censored, every.time), axis=0)  # NaN is last
    first = order[0], np.arange(len(seed))
    life = Lives(*(field[first] for field in every))
    unknown = np.isnan(every.time).any(axis=0)
    life.time[unknown] = life.error[unknown] = np.nan
    life.censored[unknown], life.cause[unknown] = False, -1
    return life._replace(time=life.time / pace, error=life.error / pace), operated


def theory_batch(
    x: NDArray[np.float64], seed: NDArray[np.uint64], settings: Settings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Compute only the angle of the averaged theory, a thousand times faster; see `batch`."""
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    return {"theory_disphasing_angle": _theory_angle(p)}, np.full(len(x), Status.OK, np.int8)


def _theory_angle(p: Rows) -> NDArray[np.float64]:
    predicted = averaged.disphasing(p)
    return np.where(predicted.stable, predicted.angle, np.nan)


def _run(
    road: Callable[[Rows, Settings], tuple[Outcome, NDArray[np.int8]]],
    p: Rows,
    rows: NDArray[np.intp],
    settings: Settings,
    outcome: Outcome,
    status: NDArray[np.int8],
) -> None:
    if len(rows):
        outcome_of_rows, status[rows] = road(Params._make(field[rows] for field in p), settings)
        whole: tuple[Any, ...] = outcome
        for field, part in zip(whole, outcome_of_rows, strict=True):
            field[rows] = part
