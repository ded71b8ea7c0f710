"""Wear histories, phase portraits and bifurcation diagrams of the beam, labelled for plotting.

With them go the Figures 3 to 6 of Knudsen & Massih 2002 and the bifurcation diagram of their
journal paper. Basins of attraction, of this model or any other, come from ``uq.basins``.
"""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from models.beam.batch import initial_gaps
from models.beam.explore.branches import continue_orbit, follow_wear
from models.beam.explore.lyapunov import lyapunov_exponent
from models.beam.explore.sweeps import Sweep, one_system, settled_rows, upcrossing_rates
from models.beam.parameters import REGIMES, SITES, Params, Rows, Settings
from models.beam.response.settling import settle
from models.beam.structure.modal import Array, beams
from models.beam.wear.accelerated_life import LOOKS, run
from models.beam.wear.regimes import CONFIRMED, WINDOW, changes_of, confirmed_regimes

__all__ = [
    "bifurcation_diagram",
    "continue_orbit",
    "follow_wear",
    "lyapunov_exponent",
    "phase_portrait",
    "wear_history",
    "work_rate_against_gap",
]

_WORDS = np.array([*REGIMES, "none"])  # -1 is the last
_SITE = {"site": list(SITES)}
_ABOUT = {
    "time": ("s", "time of wear"),
    "dimensionless_time": ("1", "T: time over S/(k k_c X0 w0), k of the right site"),
    "gap": ("m", "gap between rod and stop"),
    "gap_ratio": ("1", "left gap over right gap, x_2/x_1"),
    "work_rate": ("W", "impact work-rate"),
    "mean_work": ("1", "<u_i>: work-rate over k_c X0^2 w0"),
    "regime": ("1", "kind of response"),
    "period": ("1", "period of the response in forcing periods, 0 if aperiodic"),
    "change_time": ("s", "time at which the regime has changed"),
    "change_gap": ("m", "gap at which the regime has changed"),
    "change_from": ("1", "regime before the change"),
    "change_to": ("1", "regime after the change"),
    "displacement": ("m", "tip displacement"),
    "velocity": ("m s-1", "tip velocity"),
    "phase": ("1", "forcing periods"),
    "forcing_frequency": ("Hz", "frequency of the force"),
    "frequency_ratio": ("1", "omega: forcing frequency over the fundamental one"),
    "impact_velocity": ("m s-1", "tip velocity on meeting the right stop"),
    "dimensionless_impact_velocity": ("1", "tip velocity on meeting the right stop, over X0 w0"),
}


def wear_history(
    params: Params, settings: Settings, periods: int = 16_384, looks: int = 128
) -> xr.Dataset:
    """Follow one beam while its gaps wear to the last of the settings' depths.

    This is one accelerated life. Its times come near those of infinitely slow wear as `periods`
    grow; the model's outputs extrapolate them.

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings
    periods : int
        Forcing periods in which the site that wears faster reaches the last depth.
    looks : int
        Into which these periods are divided, at least 32 periods in each. A regime counts if it
        lasts a tenth of them.

    Returns
    -------
    xarray.Dataset
        Along ``look``, the first of which is the settled response at the initial gaps: ``time``,
        ``dimensionless_time`` (T), ``gap_ratio`` and ``regime``; and for each ``site`` the
        ``gap``, the ``work_rate`` and its dimensionless ``mean_work`` (<u_i>). Along
        ``regime_change`` what happened on the way: ``change_time``, ``change_gap``,
        ``change_from`` and ``change_to``.

    Raises
    ------
    ValueError
        If a look would be too short to tell a regime, or the load is random.
    """
    _check_counts(periods=periods, looks=looks)
    if periods < looks * WINDOW:
        raise ValueError(
            f"{looks} looks of {WINDOW} periods need more than {periods} periods: the regime "
            "could not be told"
        )
    p = _rows(params, 1)
    propagator, system = one_system(p, settings)
    gaps, x0 = initial_gaps(p), p.initial_gap
    state = propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)
    settled = settle(propagator, system, state, gaps)
    share = np.array([[1.0, params.wear_coefficient_ratio]])
    growths = np.asarray(settings.depths) / x0[:, None]
    life = run(
        propagator, system, state, gaps, settled.work, share, growths, periods, looks
    ).history
    told = np.flatnonzero(np.isfinite(life.time[0]))
    regime = confirmed_regimes(life.regime, CONFIRMED * max(1, looks // LOOKS))
    changed = np.flatnonzero(changes_of(regime)[0])
    wear_rate = (
        params.wear_coefficient / params.contact_area * params.contact_stiffness * x0[0]
    ) * params.forcing_frequency
    w0 = beams(p, settings).frequency[0, 0]
    time = np.concatenate([[0.0], life.time[0, told]])
    gap = np.concatenate([gaps, life.gaps[0, told]]) * x0[0]
    work = np.concatenate([settled.work, life.work[0, told]])
    return _dataset(
        {
            "time": ("look", time / wear_rate),
            "dimensionless_time": ("look", time * w0 / params.forcing_frequency),
            "gap": (("look", "site"), gap),
            "gap_ratio": ("look", gap[:, 1] / gap[:, 0]),
            "work_rate": (("look", "site"), work * _watt(params)),
            "mean_work": (("look", "site"), work * params.forcing_frequency / w0),
            "regime": ("look", _WORDS[np.concatenate([settled.regime, regime[0, told]])]),
            "change_time": ("regime_change", life.time[0, changed] / wear_rate),
            "change_gap": (("regime_change", "site"), life.gaps[0, changed] * x0[0]),
            "change_from": ("regime_change", _WORDS[regime[0, changed - 1]]),
            "change_to": ("regime_change", _WORDS[regime[0, changed]]),
        },
        settings,
    )


def work_rate_against_gap(
    params: Params, settings: Settings, gaps: ArrayLike, sweep: Sweep = "none"
) -> xr.Dataset:
    """Return the work-rates of the settled response at gaps that do not wear.

    Parameters
    ----------
    params : Params
        Each field a float; the gap asymmetry does not count.
    settings : Settings
    gaps : array_like, shape (n,) or (n, 2)
        Of both sites, or of the right and the left one [m].
    sweep : {"none", "up", "down"}
        Whether each gap is met in the initial state of `params`, or, by the exact propagator, in
        the state left by the one before it or after it.

    Returns
    -------
    xarray.Dataset
        Along ``case``, one for each gap: ``gap``, ``work_rate`` and ``mean_work`` for each
        ``site``, ``regime`` and ``period``.

    Raises
    ------
    ValueError
        If a gap is not positive, `sweep` is not one of the three, or the load is random.
    """
    apart = _gaps(gaps)
    p = _rows(params, len(apart))
    work, regime, period = _blank(len(apart))
    for rows, settled, _ in settled_rows(p, apart / params.initial_gap, settings, sweep, 0):
        work[rows], regime[rows], period[rows] = settled.work, settled.regime, settled.period
    w0 = beams(_rows(params, 1), settings).frequency[0, 0]
    return _dataset(
        {
            "gap": (("case", "site"), apart),
            "work_rate": (("case", "site"), work * _watt(params)),
            "mean_work": (("case", "site"), work * params.forcing_frequency / w0),
            "regime": ("case", _WORDS[regime]),
            "period": ("case", period),
        },
        settings,
        sweep,
    )


def phase_portrait(
    params: Params,
    settings: Settings,
    gaps: ArrayLike,
    periods: int = 1,
    sweep: Sweep = "none",
) -> xr.Dataset:
    """Return displacement and velocity of the tip in the settled response at given gaps.

    Parameters
    ----------
    params : Params
        Each field a float; the gap asymmetry does not count.
    settings : Settings
        Its `steps_per_period` are the points of a portrait in a period.
    gaps, sweep
        As in `work_rate_against_gap`. To look at a branch far from where it begins, sweep through
        the gaps on the way.
    periods : int
        Forcing periods that are shown.

    Returns
    -------
    xarray.Dataset
        Along ``case``, one for each gap, and ``phase`` [forcing periods]: ``displacement`` and
        ``velocity``; along ``case`` the ``gap`` of each ``site`` and the ``regime``.

    Raises
    ------
    ValueError
        If a gap is not positive, `sweep` is not one of the three, or the load is random.
    """
    _check_counts(periods=periods)
    apart = _gaps(gaps)
    x0 = params.initial_gap
    p = _rows(params, len(apart))
    _, regime, _ = _blank(len(apart))
    x, v = np.empty((2, len(apart), 0))
    for rows, settled, record in settled_rows(p, apart / x0, settings, sweep, periods + 2):
        steps = record.trace.shape[1] // (periods + 2)
        if not x.size:
            x, v = np.full((2, len(apart), periods * steps), np.nan)
        # The periods at the ends are there for the sake of the differences.
        kept = slice(steps - 1, -steps - 1)
        rate = np.gradient(record.trace, 1 / (params.forcing_frequency * steps), axis=1)
        x[rows], v[rows] = x0 * record.trace[:, kept], x0 * rate[:, kept]
        regime[rows] = settled.regime
    return _dataset(
        {
            "phase": ("phase", np.arange(x.shape[1]) * periods / max(x.shape[1], 1)),
            "displacement": (("case", "phase"), x),
            "velocity": (("case", "phase"), v),
            "gap": (("case", "site"), apart),
            "regime": ("case", _WORDS[regime]),
        },
        settings,
        sweep,
    )


def bifurcation_diagram(
    params: Params,
    settings: Settings,
    forcing_frequency: ArrayLike,
    periods: int = 32,
    sweep: Sweep = "none",
) -> xr.Dataset:
    """Return the velocities with which the tip meets the right stop, against the frequency.

    They are the points of the settled response in the Poincare section x = x_1, v > 0 (eq 2),
    interpolated between the propagator's samples: to 0.3 % by the fast one's own steps, to 0.05 %
    by the exact one, as measured on periodic responses. A contact briefer than a sample may be
    missing.

    Parameters
    ----------
    params : Params
        Each field a float; the forcing frequency does not count.
    settings : Settings
    forcing_frequency : array_like, shape (n,)
        [Hz], in the order in which it is swept up.
    periods : int
        Forcing periods that are looked at.
    sweep : {"none", "up", "down"}
        Whether each frequency is met in the initial state of `params`, many at once, or, by the
        exact propagator, in the state left by the frequency before it or after it.

    Returns
    -------
    xarray.Dataset
        Along ``forcing_frequency``: ``frequency_ratio`` (omega), ``work_rate`` of each ``site``,
        ``regime`` and ``period``; and along ``impact`` too, NaN beyond the last one,
        ``impact_velocity`` and the same dimensionless.

    Raises
    ------
    ValueError
        If a frequency is not positive, `sweep` is not one of the three, or the load is random.
    """
    _check_counts(periods=periods)
    frequency = np.asarray(forcing_frequency, float)
    if frequency.ndim != 1 or not (frequency > 0).all():
        raise ValueError(f"forcing_frequency must be a list of positive numbers: {frequency}")
    p = _rows(params, len(frequency))._replace(forcing_frequency=frequency)
    gaps = initial_gaps(p)
    work, regime, period = _blank(len(frequency))
    impacts: list[Array] = [np.empty(0)] * len(frequency)
    for rows, settled, record in settled_rows(p, gaps, settings, sweep, periods):
        work[rows], regime[rows], period[rows] = settled.work, settled.regime, settled.period
        steps = record.trace.shape[1] // periods
        for row, trace in zip(rows, record.trace, strict=True):
            impacts[row] = upcrossing_rates(trace, gaps[row, 0]) * steps * frequency[row]
    velocity = np.full((len(frequency), max(map(len, impacts), default=0)), np.nan)
    for row, each in enumerate(impacts):
        velocity[row, : len(each)] = each
    w0 = beams(_rows(params, 1), settings).frequency[0, 0]
    along = "forcing_frequency"
    return _dataset(
        {
            along: (along, frequency),
            "frequency_ratio": (along, 2 * np.pi * frequency / w0),
            "impact_velocity": ((along, "impact"), velocity * params.initial_gap),
            "dimensionless_impact_velocity": ((along, "impact"), velocity / w0),
            "work_rate": (
                (along, "site"),
                work * (_watt(params) / params.forcing_frequency) * frequency[:, None],
            ),
            "regime": (along, _WORDS[regime]),
            "period": (along, period),
        },
        settings,
        sweep,
    )


def _check_counts(**counts: int) -> None:
    for name, count in counts.items():
        if not isinstance(count, int) or count < 1:
            raise ValueError(f"{name} must be a positive whole number, not {count!r}")


def _rows(params: Params, n: int) -> Rows:
    """Return the parameters of n equal beams, each field of shape (n,)."""
    if params.random_force_level > 0:
        raise ValueError("these are pictures of the harmonic force alone: random_force_level > 0")
    return Params._make(np.full(n, float(value)) for value in params)


def _gaps(gaps: ArrayLike) -> Array:
    """Return the gaps of both sites, shape (n, 2)."""
    given = np.asarray(gaps, float)
    apart = np.repeat(given[:, None], 2, axis=1) if given.ndim == 1 else given
    if apart.ndim != 2 or apart.shape[1] != 2 or not (apart > 0).all():
        raise ValueError(f"gaps must be positive, of shape (n,) or (n, 2), not {gaps!r}")
    return apart


def _blank(n: int) -> tuple[Array, NDArray[np.int8], Array]:
    """Return work, regime and period of n beams that no propagator could follow."""
    return np.full((n, 2), np.nan), np.full(n, -1, np.int8), np.full(n, np.nan)


def _watt(params: Params) -> float:
    """Return the work-rate of one unit of dimensionless work per period [W]."""
    joule = params.contact_stiffness * params.initial_gap**2
    return joule * params.forcing_frequency


def _dataset(variables: dict[str, Any], settings: Settings, sweep: Sweep = "none") -> xr.Dataset:
    labelled = {
        name: (dims, values, {"units": _ABOUT[name][0], "long_name": _ABOUT[name][1]})
        for name, (dims, values) in variables.items()
    }
    propagator = settings.propagator if sweep == "none" else "exact"
    return xr.Dataset(labelled, _SITE, {"model": "beam", "propagator": propagator, "sweep": sweep})
