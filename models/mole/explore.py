"""Time histories, Poincaré sections and bifurcation diagrams of the mole, labelled for plotting.

For a phase portrait, plot velocity over displacement of a history. Basins of attraction, of this
model or any other, come from ``uq.basins``.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from models.mole import exact
from models.mole.batch import batch
from models.mole.lanes.rows import CONTACTS, CURRENT, HIGH, PROGRESS, P, U, V, X
from models.mole.parameters import REGIMES, Params, Rows, Settings
from models.mole.response.machines import Machines
from models.mole.theory import equations
from models.mole.theory.periods import common_periods
from models.mole.theory.system import mole

Array = NDArray[np.float64]

_STATES = {
    "displacement": (U, "m", "displacement u of the bar relative to the mole"),
    "velocity": (V, "m s-1", "rate of u"),
    "mole_velocity": (X, "m s-1", "velocity of the mole"),
    "current": (CURRENT, "A", "current through the coil"),
    "voltage": (P, "V", "voltage of the source less that of the capacitor"),
}
_SEEN = {
    "peak_contact_force": ("N", "largest force of the stop on the bar since the previous point"),
    "impacts": ("1", "contacts begun since the previous point"),
    "advance": ("m", "progression of the mole since the previous point"),
}
_HISTORY = {
    "displacement": (equations.DISPLACEMENT, *_STATES["displacement"][1:]),
    "velocity": (equations.VELOCITY, *_STATES["velocity"][1:]),
    "mole_displacement": (equations.MOLE_DISPLACEMENT, "m", "progression of the mole"),
    "mole_velocity": (equations.MOLE_VELOCITY, *_STATES["mole_velocity"][1:]),
    "current": (equations.CURRENT, *_STATES["current"][1:]),
}


def history(
    params: Params, settings: Settings, begin: float, end: float, points: int = 4000
) -> xr.Dataset:
    """Return part of the time history of one mole.

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings
        Only formulation and tolerance are used.
    begin, end : float
        Since the relay first closed [s].
    points : int
        Evenly spaced, including both ends.

    Returns
    -------
    xarray.Dataset
        Along ``time``: ``displacement`` (u), ``velocity`` (v), ``mole_displacement`` (w),
        ``mole_velocity`` (x) and ``current`` (i). NaN after the step budget runs out, should it
        ever.

    Raises
    ------
    ValueError
        If not 0 <= begin < end, or `points` is not positive.
    """
    if not 0 <= begin < end < np.inf:
        raise ValueError(f"must have 0 <= begin < end: begin = {begin!r}, end = {end!r}")
    _check_counts(points=points)
    q = mole(params, settings.formulation)
    time = np.linspace(begin, end, points)
    motion = exact.propagate(q, exact.start(params, q), end, settings.tolerance, time)
    series = {
        name: ("time", motion.samples[:, i], {"units": unit, "long_name": meaning})
        for name, (i, unit, meaning) in _HISTORY.items()
    }
    about = {"units": "s", "long_name": "time since the relay first closed"}
    return xr.Dataset(series, {"time": ("time", time, about)}, _about(settings))


def poincare_section(
    params: Params,
    settings: Settings,
    periods: int,
    dropped: int,
    starts: ArrayLike | None = None,
    common: bool = False,
) -> xr.Dataset:
    """Return the states of a mole at the instants at which its relay closes.

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings
        Only formulation and tolerance are used.
    periods : int
        Number of points returned.
    dropped : int
        Control periods dropped before the first.
    starts : array_like, shape (k, 2), optional
        Initial displacements [m] and velocities [m/s] to follow, instead of those in `params`.
    common : bool
        Whether to sample once per common period of control and half a mains cycle instead of once
        per control period: a period-1 response is then one point.

    Returns
    -------
    xarray.Dataset
        Along ``start``, if there are `starts`, and ``period``, which counts control periods since
        the relay first closed: ``displacement``, ``velocity``, ``mole_velocity``, ``current`` and
        ``voltage`` (u, v, x, i, p) just after the relay has closed, and over the time since the
        previous point: ``peak_contact_force``, ``impacts``, ``advance``. NaN after a step budget
        runs out.

    Raises
    ------
    ValueError
        If there is no common period, `periods` is not positive, `dropped` is negative, or `starts`
        is not a list of pairs.
    """
    _check_counts(periods=periods, dropped=dropped)
    stride = 1
    if common:
        stride = int(common_periods(params.control_frequency, params.supply_frequency))
        if not stride:
            raise ValueError(
                f"control at {params.control_frequency!r} Hz and mains at "
                f"{params.supply_frequency!r} Hz have no common period within 40 control periods"
            )
    if starts is None:
        return _strobed("start", _rows(params, 1), settings, dropped, periods, stride).isel(start=0)
    pairs = np.asarray(starts, float)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise ValueError(f"starts must be pairs (displacement, velocity): {starts!r}")
    u, v = pairs.T
    rows = _rows(params, len(u), initial_displacement=u, initial_velocity=v)
    ds = _strobed("start", rows, settings, dropped, periods, stride)
    return ds.assign_coords(
        initial_displacement=("start", u, {"units": "m", "long_name": "displacement at the start"}),
        initial_velocity=("start", v, {"units": "m s-1", "long_name": "velocity at the start"}),
    )


def bifurcation_diagram(
    frequencies: Sequence[float] | Array,
    params: Params,
    settings: Settings,
    dropped: int,
    kept: int,
) -> xr.Dataset:
    """Return how the response of a mole changes with its control frequency.

    Each frequency is followed from the initial state in `params`, so the diagram shows the branch
    reached from there.

    Parameters
    ----------
    frequencies : array_like, shape (n,)
        Control frequencies [Hz].
    params : Params
        Each field a float; the control frequency is not used.
    settings : Settings
    dropped, kept : int
        Control periods dropped, and those shown after them.

    Returns
    -------
    xarray.Dataset
        Along ``control_frequency`` and ``period`` what `poincare_section` returns; along
        ``control_frequency`` the ``progression_rate`` and the ``regime`` of the settled response,
        as in the model's outputs.

    Raises
    ------
    ValueError
        If a frequency or `kept` is not positive, or `dropped` is negative.
    """
    _check_counts(kept=kept, dropped=dropped)
    frequencies = np.asarray(frequencies, float)
    if not np.all(frequencies > 0):
        raise ValueError(f"control frequencies must be positive: {frequencies.min():g} Hz")
    rows = _rows(params, len(frequencies), control_frequency=frequencies)
    ds = _strobed("control_frequency", rows, settings, dropped, kept, 1)
    seed = np.zeros(len(frequencies), np.uint64)
    settled, _ = batch(np.stack(rows, axis=1), seed, settings)
    words = np.array(["none", *REGIMES])[settled["regime"] + 1]
    along = "control_frequency"
    return ds.assign(
        progression_rate=(
            along,
            settled["progression_rate"],
            {"units": "m s-1", "long_name": "mean velocity of the mole, positive forwards"},
        ),
        regime=(
            along,
            words,
            {"long_name": "type of settled response", "flag_meanings": " ".join(REGIMES)},
        ),
    ).assign_coords(
        {along: (along, frequencies, {"units": "Hz", "long_name": "control frequency"})}
    )


def best_frequency(
    frequencies: ArrayLike,
    rates: ArrayLike,
    probability: float = 0.1,
    fixed: float = 8.0,
    confidence: float = 0.95,
) -> xr.Dataset:
    """Return a low quantile of progression by control frequency, and what a fixed one loses.

    Parameters
    ----------
    frequencies : array_like, shape (n,)
        Control frequencies of n moles [Hz], several moles at each.
    rates : array_like, shape (n,)
        Their ``progression_rate`` [m/s]; NaN of invalid rows.
    probability : float
        Of a mole below the quantile.
    fixed : float
        The frequency to compare with the best [Hz], one of `frequencies`.
    confidence : float
        Of each interval.

    Returns
    -------
    xarray.Dataset
        Along ``control_frequency``: ``quantile``, its interval ``lower`` and ``upper`` by order
        statistics, without an assumption about the law (infinite where moles are too few), the
        number of ``moles``, and whether the frequency ``may_be_best``, its interval reaching that
        of the best. ``best`` [Hz]; ``loss`` [m/s], by which the quantile at `fixed` is lower than
        that at the best, with ``loss_lower`` and ``loss_upper``. These are the differences of the
        ends of both intervals: at least as wide as they need to be.

    Raises
    ------
    ValueError
        If no mole has the frequency `fixed`, or a probability is not between 0 and 1.
    """
    for name, value in ("probability", probability), ("confidence", confidence):
        if not 0 < value < 1:
            raise ValueError(f"{name} must be between 0 and 1: {value!r}")
    at, rate = np.asarray(frequencies, float), np.asarray(rates, float)
    at, rate = at[np.isfinite(rate)], rate[np.isfinite(rate)]
    places = np.unique(at)
    if fixed not in places:
        raise ValueError(f"no mole at {fixed!r} Hz: frequencies are {places.tolist()}")
    groups = [np.sort(rate[at == place]) for place in places]
    quantile = np.array([np.quantile(group, probability) for group in groups])
    lower, upper = np.transpose([_order_interval(g, probability, confidence) for g in groups])
    best = int(quantile.argmax())
    here = int(np.searchsorted(places, fixed))
    loss = quantile[best] - quantile[here]
    least = lower[best] - upper[here] if here != best else 0.0
    most = upper[best] - lower[here] if here != best else 0.0
    unit = {"units": "m s-1"}
    dim = "control_frequency"
    return xr.Dataset(
        {
            "quantile": (dim, quantile, unit),
            "lower": (dim, lower, unit),
            "upper": (dim, upper, unit),
            "moles": (dim, [len(group) for group in groups]),
            "may_be_best": (dim, upper >= lower[best]),
            "best": ((), places[best], {"units": "Hz"}),
            "loss": ((), loss, unit),
            "loss_lower": ((), max(least, 0.0), unit),
            "loss_upper": ((), most, unit),
        },
        {dim: (dim, places, {"units": "Hz", "long_name": "control frequency"})},
        {"model": "mole", "probability": probability, "confidence": confidence, "fixed": fixed},
    )


def _order_interval(values: Array, probability: float, confidence: float) -> tuple[float, float]:
    """Return the interval of a quantile between two of its ordered values.

    The number of values below the quantile is binomial; each end is missed with at most half of
    the probability allowed.
    """
    n, miss = len(values), 0.5 * (1 - confidence)
    odds = math.log(probability), math.log1p(-probability)
    ways = [math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1) for k in range(n + 1)]
    below = np.cumsum([math.exp(w + k * odds[0] + (n - k) * odds[1]) for k, w in enumerate(ways)])
    left = int((below <= miss).sum())  # P(fewer than `left` values below) <= miss
    right = int((below < 1 - miss).sum()) + 1
    low = float(values[left - 1]) if left > 0 else -math.inf
    return low, float(values[right - 1]) if right <= n else math.inf


def _check_counts(dropped: int = 0, **positive: int) -> None:
    if dropped < 0:
        raise ValueError(f"dropped must not be negative: {dropped!r}")
    for name, count in positive.items():
        if count < 1:
            raise ValueError(f"{name} must be positive: {count!r}")


def _rows(params: Params, n: int, **varied: Array) -> Rows:
    """Return the parameters of n moles, each field of shape (n,)."""
    values: dict[str, Any] = params._asdict() | varied
    return Params._make(np.broadcast_to(x, n).astype(float) for x in values.values())


def _strobed(
    dim: str, p: Rows, settings: Settings, dropped: int, points: int, stride: int
) -> xr.Dataset:
    """Sample n moles every `stride` control periods."""
    n = len(p.control_frequency)
    machines = Machines.started(p, settings, dropped + points * stride)
    rows = np.arange(n)

    def run_to(period: int) -> NDArray[np.int64]:
        return rows[machines.run(rows, np.full(len(rows), period))]

    if dropped:
        rows = run_to(dropped)
    closings = dropped + stride * np.arange(1, points + 1)
    seen = {name: np.full((n, points), np.nan) for name in (*_STATES, *_SEEN)}
    for k in range(points):
        rows = run_to(int(closings[k]))
        record = machines.record[rows]
        for name, (i, _, _) in _STATES.items():
            seen[name][rows, k] = record[:, i]
        gap = np.maximum(record[:, HIGH] - p.stop_gap[rows], 0.0)
        seen["peak_contact_force"][rows, k] = p.contact_stiffness[rows] * gap
        seen["impacts"][rows, k] = record[:, CONTACTS]
        seen["advance"][rows, k] = record[:, PROGRESS]
    about = {name: texts for name, (_, *texts) in _STATES.items()} | _SEEN
    return xr.Dataset(
        {
            name: ((dim, "period"), values, {"units": about[name][0], "long_name": about[name][1]})
            for name, values in seen.items()
        },
        {"period": ("period", closings, {"units": "1", "long_name": "control periods so far"})},
        _about(settings),
    )


def _about(settings: Settings) -> dict[str, Any]:
    return {"model": "mole", "formulation": settings.formulation}
