"""Lives of rods in service: rows are integrated by turns, each as far as its responses go."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.outputs import MAP_NODES, MAP_POSITIONS
from models.beam.parameters import FACTORS, OF_PROCESSES, Params, Rows, Settings
from models.beam.service.growth import AVAILABLE, IS_MISSING, integrate_rod
from models.beam.service.responses import Responses, reach_of
from models.beam.service.work_maps import (
    FittedMaps,
    WorkMaps,
    fit_maps,
    no_maps,
)
from models.beam.start import initial_gaps, wear_shares
from models.beam.structure.modal import Array
from models.numerics.duty import OFFSET, TIME, WEAR, duty_numbers, history_numbers
from models.numerics.scars import Scar, scar, scar_depth
from models.numerics.slow_time import NEVER, PENDING, REACHED
from models.numerics.wear_laws.laws import law_numbers

LONGEST = 1e12
"""Of a life without a horizon [s]."""

_CONFIDENT = 1.6449  # half-width of a 90 % interval over the standard error

OF_WEAR = ("wear_coefficient", "wear_coefficient_ratio", "contact_area")
"""Parameters of the wear by impact alone."""


class ServiceLives(NamedTuple):
    """Lives of n rods.

    Attributes
    ----------
    time, error : ndarray, shape (n, q)
        Of the events of `models.beam.service.growth.integrate_rod` [s]; inf for never; the errors
        NaN where an event is not reached.
    censored, reached : ndarray of bool, shape (n, q)
    worn : ndarray, shape (n, T, 2)
        Depth of the rod's scar of each site at the instants [m].
    at_depth : ndarray, shape (n, D, 2)
        Gap of each site when the rod's scar at either is as deep [m]; NaN where it never is.
    changes : ndarray, shape (n,)
        Of the regime.
    lost, unfinished : ndarray of bool, shape (n,)
        No propagator can follow the rod; it needs more responses than the budget, or than are
        mapped.
    map_gap, map_work, map_error : ndarray
        As in `WorkMaps`.
    """

    time: Array
    error: Array
    censored: NDArray[np.bool_]
    reached: NDArray[np.bool_]
    worn: Array
    at_depth: Array
    changes: Array
    lost: NDArray[np.bool_]
    unfinished: NDArray[np.bool_]
    map_gap: Array
    map_work: Array
    map_error: Array

    @property
    def maps(self) -> WorkMaps:
        """Maps of their work-rates."""
        return WorkMaps(self.map_gap, self.map_work, self.map_error)

    def take(self, rows: NDArray[np.intp]) -> "ServiceLives":
        """Return copies of some of them, in their order."""
        return ServiceLives._make(field[rows] for field in self)


def scars_of(p: Rows, settings: Settings) -> Scar:
    """Return the scars of n rods."""
    return scar(
        settings.scar, p.contact_area, p.rod_radius, p.support_width, p.support_radius,
        p.support_inclination,
    )  # fmt: skip


def gaps_when_new(p: Rows) -> Array:
    """Return the gaps of n rods when new [m], shape (n, 2); Eq. (4)."""
    preload = p.preload_deflection[:, None]
    return np.where(preload > 0, -preload, initial_gaps(p) * p.initial_gap[:, None])


def drift_of(p: Rows) -> Array:
    """Return the drifts of n rods, shape (n, 7)."""
    relaxation = p.preload_deflection * (1 - p.relaxed_share)
    return np.stack(
        [
            p.creep_down, p.creep_time, relaxation, p.relaxation_time, p.swelling_rate,
            p.swelling_start, p.gap_history_factor,
        ],
        axis=1,
    )  # fmt: skip


class _Row:
    """One rod: the arguments of `integrate_rod`, and its results."""

    def __init__(self, shared: dict[str, Any], budget: int, **numbers: Any) -> None:
        states, depths = len(shared["duty"]), shared["depths"]
        events = 2 * len(depths) + 2 * len(shared["growths"]) + 2
        self.arguments = shared | numbers
        self.work, self.noise = np.zeros((2, budget, states, 2))
        self.map_terms = numbers["map_terms"]
        self.cursor, self.at = np.zeros(3, np.int64), np.zeros(1 + 2 * states)
        self.fate = np.zeros(events, np.int8)
        self.time, self.error = np.empty((2, events))

    def integrate(self, instants: Array, length: float, end: float) -> tuple[float, Array]:
        """Return the time reached and the volumes at the instants, shape (T, 2)."""
        volume = np.empty((len(instants), 2))
        a = self.arguments
        _, time = integrate_rod(
            a["gap"], a["coefficient"], a["numbers"], a["depths"], a["growths"], a["drift"],
            a["history"], a["laws"], a["duty"], a["in_sequence"], a["reach"],
            self.work, self.noise, self.cursor, self.at, a["map_gap"], a["map_growth"],
            self.map_terms, a["floor"], length, end, self.fate, self.time,
            self.error, instants, volume,
        )  # fmt: skip
        return time, volume

    def add_error_of_map(self, length: float, end: float) -> None:
        """Add the errors that times have because the polynomials of a map are uncertain.

        Times are integrated with each coefficient, in independent combinations, in turn larger by
        its standard error.
        """
        fate, time, error = self.fate.copy(), self.time.copy(), self.error.copy()
        terms, spread = self.map_terms, self.arguments["map_spread"]
        variance = np.zeros(len(time))
        nothing = np.empty(0)
        for state, site, term in zip(*np.nonzero(spread.any(axis=3)), strict=True):
            self.map_terms = terms.copy()
            self.map_terms[state, site] += spread[state, site, term]
            self.integrate(nothing, length, end)
            both = (fate == REACHED) & (self.fate == REACHED)
            variance[both] += (self.time[both] - time[both]) ** 2
        self.map_terms = terms
        self.fate[:], self.time[:] = fate, time
        self.error[:] = error + _CONFIDENT * np.sqrt(variance)


def find_service_lives(
    p: Rows,
    settings: Settings,
    seed: NDArray[np.uint64],
    end: Array,
    clock: Array,
    maps: WorkMaps | None = None,
    follows: bool = True,
) -> ServiceLives:
    """Find the lives of n rods.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    settings : Settings
    seed : ndarray of uint64, shape (n,)
        Of the random force.
    end : ndarray, shape (n,)
        Time at which lives are censored, at most `LONGEST` [s].
    clock : ndarray, shape (n,)
        Unit of the instants in `settings`.
    maps : WorkMaps, optional
        From an earlier computation.
    follows : bool
        Whether the beams are followed where nothing is mapped; else these rows are unfinished.

    Returns
    -------
    ServiceLives
    """
    n = len(seed)
    instants = np.array(settings.instants, float) / clock[:, None]
    length = float(np.sqrt(settings.accuracy))  # the error is of second order in it
    duty = duty_numbers(settings.duty, settings.order, FACTORS)
    responses = Responses(p, duty, settings, seed) if follows else None
    reach = reach_of(p, duty, settings, seed) if responses is None else responses.reach
    if maps is None:
        maps = no_maps(n, len(duty))
        if responses is not None:
            _fill_maps(maps, responses, p, duty, settings, seed)
    rods = _rows(p, settings, duty, reach, fit_maps(maps))
    until = np.zeros(n)
    worn = np.full((n, instants.shape[1], 2), np.nan)
    lost, unfinished = np.zeros((2, n), bool)
    left = list(range(n))
    while left:
        asking = []
        for i in left:
            until[i], worn[i] = rods[i].integrate(instants[i], length, end[i])
            used = rods[i].cursor[AVAILABLE]
            if not rods[i].cursor[IS_MISSING]:
                pending = bool((rods[i].fate == PENDING).any())
                unfinished[i] = pending and until[i] < end[i]
            elif used == settings.response_budget or responses is None:
                unfinished[i] = True
            else:
                asking.append(i)
        if asking and responses is not None:
            at = np.array([rods[i].at for i in asking])
            gaps = at[:, 1:].reshape(len(asking), len(duty), 2)
            work, noise = responses.settle(np.array(asking), at[:, 0], gaps)
            for j, i in enumerate(asking):
                used = rods[i].cursor[AVAILABLE]
                rods[i].work[used], rods[i].noise[used] = work[j], noise[j]
                rods[i].cursor[AVAILABLE] += 1
                lost[i] = bool(np.isnan(work[j]).any())
        left = [i for i in asking if not lost[i]]
    for i in range(n):
        rods[i].add_error_of_map(length, end[i])
    fate = np.array([rod.fate for rod in rods])
    time, error = (np.array([getattr(rod, name) for rod in rods]) for name in ("time", "error"))
    pending = fate == PENDING
    time[pending] = np.broadcast_to(until[:, None], pending.shape)[pending]
    time[fate == NEVER] = np.inf
    error[fate != REACHED] = np.nan
    time[lost], error[lost], pending[lost] = np.nan, np.nan, False
    changes = np.zeros(n)
    if responses is not None:
        changes[:] = [responses.regime_changes(i) for i in range(n)]
    reached = fate == REACHED
    at_depth = np.stack([_gaps_at_depths(rods[i], length, end[i]) for i in range(n)])
    worn = np.stack([_rod_depth(rod, volume) for rod, volume in zip(rods, worn, strict=True)])
    return ServiceLives(
        time, error, pending, reached, worn, at_depth, changes, lost, unfinished & ~lost, *maps
    )


def _fill_maps(
    maps: WorkMaps,
    responses: Responses,
    p: Rows,
    duty: Array,
    settings: Settings,
    seed: NDArray[np.uint64],
) -> None:
    """Map the work-rates of rods under a random force, each pair of gaps from the one before.

    Rods that differ in nothing that moves the beam share a map.
    """
    random = np.flatnonzero((p.random_force_level > 0) & (settings.map_growth > 0))
    if not len(random):
        return
    worn = (duty[:, TIME] > 0) & (duty[:, WEAR] > 0)
    least = np.maximum(gaps_when_new(p)[:, None] + duty[:, OFFSET, None], 0.0)
    least[:, ~worn] = np.inf
    moving = [getattr(p, name) for name in Params._fields if name not in (*OF_PROCESSES, *OF_WEAR)]
    halves = seed >> np.uint64(32), seed & np.uint64(0xFFFFFFFF)
    columns = np.column_stack([*moving, *halves, least[:, worn].reshape(len(least), -1)])[random]
    _, first, back = np.unique(columns, axis=0, return_index=True, return_inverse=True)
    rows = random[first]
    work, error = np.full((2, len(rows), *maps.work.shape[1:]), np.nan)
    times = np.zeros(len(rows))
    for right, left in np.ndindex(MAP_NODES, MAP_NODES):
        growth = settings.map_growth * np.array([MAP_POSITIONS[right], MAP_POSITIONS[left]])
        gaps = np.where(worn[:, None], least[rows] + growth, np.nan)
        settled = responses.settle(rows, times, gaps)
        for table, values in zip((work, error), settled, strict=True):
            table[..., right, left][:, worn] = values[:, worn]
        times += 1
    responses.forget(rows)
    maps.gap[random], maps.work[random], maps.error[random] = (
        least[random], work[back.reshape(-1)], error[back.reshape(-1)],
    )  # fmt: skip


def _rows(p: Rows, settings: Settings, duty: Array, reach: Array, maps: FittedMaps) -> list[_Row]:
    depths, growths = np.array(settings.depths), np.array(settings.growths, float)
    shape, drift = scars_of(p, settings), drift_of(p)
    x_0 = p.initial_gap[:, None]
    gap = gaps_when_new(p)
    coefficient = wear_shares(p) * p.wear_coefficient[:, None]
    least = np.minimum(x_0[:, 0], (1 + p.support_wear_ratio) * depths[0])
    if len(growths):
        least = np.minimum(least, growths[0])
    shared = {
        "depths": depths,
        "growths": growths,
        "history": history_numbers(settings.gap_history),
        "laws": law_numbers(settings.wear_law, settings.wear_law_numbers),
        "duty": duty,
        "in_sequence": bool(settings.duty) and settings.order == "sequence",
    }
    oxide = p.oxide_thickness, p.oxide_wear_factor
    numbers = np.stack([p.support_wear_ratio, *shape, *oxide], axis=1)
    return [
        _Row(
            shared,
            settings.response_budget,
            gap=gap[i].copy(),
            coefficient=coefficient[i].copy(),
            numbers=numbers[i].copy(),
            drift=drift[i].copy(),
            reach=reach[i].copy(),
            floor=np.full(2, least[i]),
            map_gap=maps.gap[i].copy(),
            map_growth=float(settings.map_growth),
            map_terms=maps.terms[i].copy(),
            map_spread=maps.spread[i],
        )
        for i in range(len(numbers))
    ]


def _rod_depth(rod: _Row, volume: Array) -> Array:
    """Return the depths of the rod's scar for volumes of both bodies, in the same shape."""
    kappa, *shape = rod.arguments["numbers"][:4].tolist()
    flat = [scar_depth(v, *shape) / (1 + kappa) if v >= 0 else np.nan for v in volume.flat]
    return np.array(flat, float).reshape(volume.shape)


def _gaps_at_depths(rod: _Row, length: float, end: float) -> Array:
    """Return the growth by wear of both sites when the first is as deep, shape (D, 2) [m]."""
    count = len(rod.arguments["depths"])
    reached = rod.fate[: 2 * count].reshape(2, count) == REACHED
    first = np.where(reached, rod.time[: 2 * count].reshape(2, count), np.inf).min(axis=0)
    known_at = np.flatnonzero(np.isfinite(first))
    at = np.full((count, 2), np.nan)
    if len(known_at):  # the steps are the same again
        instants = np.maximum.accumulate(first[known_at])
        _, volume = rod.integrate(instants, length, end)
        at[known_at] = (1 + rod.arguments["numbers"][0]) * _rod_depth(rod, volume)
    return at
