"""Settled responses at constant gaps: work-rates and phase portraits."""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from models.beam.explore.labels import WORDS, blank, check_counts, dataset, equal_rows
from models.beam.explore.sweeps import Sweep, settled_rows
from models.beam.parameters import Params, Settings
from models.beam.structure.modal import Array, beams
from models.beam.units import watt


def work_rate_against_gap(
    params: Params, settings: Settings, gaps: ArrayLike, sweep: Sweep = "none"
) -> xr.Dataset:
    """Return the work-rates of the settled response at constant gaps.

    Parameters
    ----------
    params : Params
        Each field a float; the gap asymmetry is not used.
    settings : Settings
    gaps : array_like, shape (n,) or (n, 2)
        Of both sites, or of the right and the left [m].
    sweep : {"none", "up", "down"}
        Start each gap from the initial state of `params`, or, with the exact propagator, from the
        final state of the one before it or after it.

    Returns
    -------
    xarray.Dataset
        Along ``case``, one for each gap: ``gap``, ``work_rate`` and ``mean_work`` for each
        ``site``, ``regime`` and ``period``.

    Raises
    ------
    ValueError
        If a gap is not positive, `sweep` is not one of the three, or is not ``none`` with residual
        flexibility, or the load is random.
    """
    apart = _gaps(gaps)
    p = equal_rows(params, len(apart))
    work, regime, period = blank(len(apart))
    for rows, settled, *_ in settled_rows(p, apart / params.initial_gap, settings, sweep, 0):
        work[rows], regime[rows], period[rows] = settled.work, settled.regime, settled.period
    w0 = beams(equal_rows(params, 1), settings).frequency[0, 0]
    return dataset(
        {
            "gap": (("case", "site"), apart),
            "work_rate": (("case", "site"), work * watt(params)),
            "mean_work": (("case", "site"), work * params.forcing_frequency / w0),
            "regime": ("case", WORDS[regime]),
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
        Each field a float; the gap asymmetry is not used.
    settings : Settings
        Its `steps_per_period` is the number of points per period.
    gaps, sweep
        As in `work_rate_against_gap`. To follow a branch far from its beginning, sweep through the
        gaps in between.
    periods : int
        Number of forcing periods.

    Returns
    -------
    xarray.Dataset
        Along ``case``, one for each gap, and ``phase`` [forcing periods]: ``displacement`` and
        ``velocity``; along ``case`` the ``gap`` of each ``site`` and the ``regime``.

    Raises
    ------
    ValueError
        As `work_rate_against_gap`, or if `periods` is not positive.
    """
    check_counts(periods=periods)
    apart = _gaps(gaps)
    x0 = params.initial_gap
    p = equal_rows(params, len(apart))
    _, regime, _ = blank(len(apart))
    x, v = np.empty((2, len(apart), 0))
    for rows, settled, record, speed in settled_rows(p, apart / x0, settings, sweep, periods + 1):
        steps = record.trace.shape[1] // (periods + 1)
        if not x.size:
            x, v = np.full((2, len(apart), periods * steps), np.nan)
        kept = slice(steps - 1, -1)  # from phase 0
        rate = 2 * np.pi * params.forcing_frequency * speed
        x[rows], v[rows] = x0 * record.trace[:, kept], x0 * rate[:, kept]
        regime[rows] = settled.regime
    return dataset(
        {
            "phase": ("phase", np.arange(x.shape[1]) * periods / max(x.shape[1], 1)),
            "displacement": (("case", "phase"), x),
            "velocity": (("case", "phase"), v),
            "gap": (("case", "site"), apart),
            "regime": ("case", WORDS[regime]),
        },
        settings,
        sweep,
    )


def _gaps(gaps: ArrayLike) -> Array:
    """Return the gaps of both sites, shape (n, 2)."""
    given = np.asarray(gaps, float)
    apart = np.repeat(given[:, None], 2, axis=1) if given.ndim == 1 else given
    if apart.ndim != 2 or apart.shape[1] != 2 or not (apart > 0).all():
        raise ValueError(f"gaps must be positive, of shape (n,) or (n, 2), not {gaps!r}")
    return apart
