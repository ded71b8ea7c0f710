"""From rows of parameters to work-rates, regimes and lives by wear by impact alone."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import OF_PROCESSES, Params, Rows, Settings
from models.beam.processes import has_band
from models.beam.response.further_starts import add_other_responses
from models.beam.response.neighbouring_starts import add_neighbour_error
from models.beam.response.response import Response
from models.beam.response.settling import NINE_IN_TEN, settle
from models.beam.response.step_error import add_step_error
from models.beam.start import PROPAGATORS, initial_gaps, initial_state, wear_shares
from models.beam.structure.modal import Array, beams
from models.beam.structure.propagation import Propagator, System
from models.beam.units import newton, watt, wear_per_work
from models.beam.wear.lives import Lives, find_lives
from models.beam.wear.random_lives import find_random_lives
from uq.contract import Status

# These only scale lifetimes (eq 12): rows that differ only here share a simulation.
_SCALES = [Params._fields.index(name) for name in ("wear_coefficient", "contact_area")]
_UNUSED = [Params._fields.index(name) for name in OF_PROCESSES]
_BAND = [Params._fields.index(name) for name in ("random_force_low", "random_force_high")]


class Simulated(NamedTuple):
    """The dimensionless results of n beams."""

    response: Response
    lives: Lives
    fundamental: Array


def batch(
    x: Array,
    seed: NDArray[np.uint64],
    settings: Settings,
    followed: NDArray[np.bool_] | None = None,
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Compute n beams.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        Parameters in the order of `Params`.
    seed : ndarray of uint64, shape (n,)
        Of the realisation of the random force; without one the beam is deterministic.
    settings : Settings
    followed : ndarray of bool, shape (n,), optional
        Mask of the beams whose lives are found, all by default; those of others are unknown.

    Returns
    -------
    outputs : dict of str to ndarray, shape (n, ...)
        Those of `models.beam.outputs.OUTPUTS` that wear by impact decides, with ``*_censored``
        beside each lifetime.
    status : ndarray of int8, shape (n,)
        Non-finite, as are all outputs, where the band of a random force has no width.
    """
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    seed = np.where(p.random_force_level > 0, seed, np.uint64(0))
    # The halves of a seed are exact as floats.
    halves = np.stack([seed >> np.uint64(32), seed & np.uint64(0xFFFFFFFF)], axis=1)
    given = x.copy()
    given[np.ix_(p.random_force_level == 0, _BAND)] = 0.0  # a band without a load has no effect
    # The instants of such rows differ in the time of the simulation.
    shared = _UNUSED if settings.instants else _UNUSED + _SCALES
    dynamic = np.hstack([np.delete(given, shared, axis=1), halves.astype(float)])
    if followed is not None:
        dynamic = np.hstack([dynamic, followed[:, None].astype(float)])
    _, first, back = np.unique(dynamic, axis=0, return_index=True, return_inverse=True)
    distinct: Rows = Params._make(np.ascontiguousarray(x[first].T))
    among = None if followed is None else followed[first]
    simulated = simulate_rows(distinct, settings, seed[first], among)
    return _in_units(p, _take(simulated, back.reshape(-1)), settings)


def simulate_rows(
    p: Rows,
    settings: Settings,
    seed: NDArray[np.uint64] | None = None,
    followed: NDArray[np.bool_] | None = None,
) -> Simulated:
    """Find the settled response and the dimensionless lives of n beams.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    settings : Settings
    seed : ndarray of uint64, shape (n,), optional
        Of the random force; 0 if not given.
    followed : ndarray of bool, shape (n,), optional
        As in `batch`.

    Returns
    -------
    Simulated
        NaN for a beam with too many steps or events in a period, and for one whose random force has
        no band.
    """
    b = beams(p, settings, seed)
    propagator = PROPAGATORS[settings.propagator]
    n = len(p.length)
    lives = Lives.nothing(n, len(settings.depths), len(settings.instants))
    whole = Simulated(Response.nothing(n), lives, b.frequency[:, 0])
    possible = np.flatnonzero(has_band(p))
    for group, system in propagator.groups(b.take(possible), settings):
        rows = possible[group]
        q = Params._make(field[rows] for field in p)
        among = np.ones(len(rows), bool) if followed is None else followed[rows]
        settled, lives = _simulate_group(propagator, system, q, settings, among)
        fields: tuple[Any, ...] = (*whole.response, *whole.lives)
        for field, part in zip(fields, (*settled, *lives), strict=True):
            field[rows] = part
    return whole


def _simulate_group(
    propagator: Propagator,
    system: System,
    p: Rows,
    settings: Settings,
    followed: NDArray[np.bool_],
) -> tuple[Response, Lives]:
    gaps, state = initial_gaps(p), initial_state(propagator, system, p)
    begin = state.copy()
    settled = settle(propagator, system, state, gaps)
    first = Response._make(field.copy() for field in settled)
    add_step_error(propagator, system, state, gaps, settled)
    add_neighbour_error(propagator, system, begin, gaps, settled)
    add_other_responses(propagator, system, gaps, first, settled, settings.starts)
    share = wear_shares(p)
    growths = np.asarray(settings.depths) / p.initial_gap[:, None]
    clock = np.asarray(settings.instants) * (p.forcing_frequency * wear_per_work(p))[:, None]
    lives = Lives.nothing(len(growths), growths.shape[1], clock.shape[1])
    valid = np.isfinite(settled.work).all(axis=1) & followed
    for is_random in (False, True):
        rows = np.flatnonzero(valid & (system.beams.is_random == is_random))
        if not len(rows):
            continue
        start = (propagator, system.take(rows), state[rows], gaps[rows], first.work[rows])
        wear = (share[rows], growths[rows], clock[rows], settings.accuracy)
        part = (
            find_random_lives(*start, first.error[rows] / NINE_IN_TEN, *wear)
            if is_random
            else find_lives(*start, first.regime[rows], *wear)
        )
        for field, values in zip(lives, part, strict=True):
            field[rows] = values
    return settled, lives


def _take(s: Simulated, rows: NDArray[np.intp]) -> Simulated:
    return Simulated(
        Response._make(a[rows] for a in s.response),
        Lives._make(a[rows] for a in s.lives),
        s.fundamental[rows],
    )


def _in_units(
    p: Rows, s: Simulated, settings: Settings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Convert the results to units, and apply the horizon."""
    to_watt = watt(p)[:, None]
    wear_rate = wear_per_work(p)
    to_second = 1 / (p.forcing_frequency * wear_rate)[:, None, None]
    time, error = s.lives.time * to_second, s.lives.error * to_second
    reached = s.lives.reached & (time <= settings.horizon)
    never = np.isinf(s.lives.time)
    # The work of a beam that no propagator could follow is NaN: its life is unknown.
    lost = np.asarray(np.isnan(s.response.work).any(axis=1), bool)
    censored = ~reached & ~never & ~lost[:, None, None]
    time = np.where(censored, np.minimum(time, settings.horizon), time)
    error = np.where(reached, error, np.nan)

    work = s.response.work
    fastest = (work * wear_shares(p)).max(axis=1) * wear_rate * p.forcing_frequency
    depths = np.asarray(settings.depths)
    with np.errstate(divide="ignore"):
        linear = depths / (fastest * p.initial_gap)[:, None]
    first_reached = reached[:, 2]
    earlier = np.where(reached[:, :2], time[:, :2], np.inf).argmin(axis=1)
    outputs = {
        "work_rate": work * to_watt,
        "work_rate_error": s.response.error * to_watt,
        "work_rate_heavy": work.max(axis=1) * to_watt[:, 0],
        "work_rate_light": work.min(axis=1) * to_watt[:, 0],
        "peak_contact_force": s.response.peak * newton(p)[:, None],
        "time_to_depth": time[:, :2],
        "time_to_depth_censored": censored[:, :2],
        "time_to_depth_error": error[:, :2],
        "first_time_to_depth": time[:, 2],
        "first_time_to_depth_censored": censored[:, 2],
        "first_time_to_depth_error": error[:, 2],
        "first_time_to_depth_cause": np.where(first_reached, earlier, -1).astype(np.int8),
        "linear_time_to_depth": linear,
        "lifetime_ratio": np.divide(
            linear,
            time[:, 2],
            out=np.full_like(linear, np.nan),
            where=first_reached & np.isfinite(linear),
        ),
        "gap_ratio": np.where(first_reached, s.lives.ratio, np.nan),
        "floquet_multiplier": s.response.multiplier,
        "regime_changes": np.where(lost, np.nan, s.lives.changes),
        "fundamental_frequency": s.fundamental / (2 * np.pi),
    }
    if settings.instants:
        worn = np.minimum(s.lives.depth * p.initial_gap[:, None, None], depths[-1])
        outputs |= {"worn_depth": worn, "largest_worn_depth": worn.max(axis=1)}
    outputs["regime"] = np.where(lost, np.int8(-1), s.response.regime)
    outputs["period"] = np.where(lost, -1, s.response.period).astype(np.int8)
    unfinished = (censored & (time < settings.horizon)).any(axis=(1, 2))
    status = np.where(lost | unfinished, Status.OUT_OF_BUDGET, Status.OK).astype(np.int8)
    absurd = ~has_band(p)
    status[absurd] = Status.NON_FINITE
    outputs["fundamental_frequency"][absurd] = np.nan
    return outputs, status
