"""One life of a beam: its gaps, work-rates and regimes during wear."""

import numpy as np
import xarray as xr

from models.beam.explore.labels import WORDS, check_counts, dataset, equal_rows
from models.beam.parameters import Params, Settings
from models.beam.response.settling import settle
from models.beam.start import initial_gaps, initial_state, one_system, wear_shares
from models.beam.structure.modal import beams
from models.beam.units import watt, wear_per_work
from models.beam.wear.regimes import CONFIRMED, ROUND, changes_of, confirmed_regimes
from models.beam.wear.worn_beams import LOOKS, wear_down


def wear_history(
    params: Params, settings: Settings, periods: int = 16_384, looks: int = 128
) -> xr.Dataset:
    """Follow one beam while its gaps wear to the last of the settings' depths.

    Times approach those of infinitely slow wear as `periods` and `looks` grow.

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings
    periods : int
        Forcing periods in which the site that wears faster reaches the last depth where the
        response is aperiodic; where it is periodic, the gaps grow from look to look.
    looks : int
        Number of intervals into which the life is divided, each of at least 32 of these periods. A
        regime counts if it lasts a tenth of them.

    Returns
    -------
    xarray.Dataset
        Along ``look``, the first of which is the settled response at the initial gaps: ``time``,
        ``dimensionless_time`` (T), ``gap_ratio`` and ``regime``; and for each ``site`` the ``gap``,
        the ``work_rate`` and its dimensionless ``mean_work`` (<u_i>). Along ``regime_change``:
        ``change_time``, ``change_gap``, ``change_from`` and ``change_to``.

    Raises
    ------
    ValueError
        If a count is not positive, a look would be too short to identify a regime, or the load is
        random.
    """
    check_counts(periods=periods, looks=looks)
    if periods < looks * 2 * ROUND:
        raise ValueError(
            f"{looks} looks of {2 * ROUND} periods need more than {periods} periods: the regime "
            "could not be identified"
        )
    p = equal_rows(params, 1)
    propagator, system = one_system(beams(p, settings), settings)
    gaps, x0 = initial_gaps(p), p.initial_gap
    state = initial_state(propagator, system, p)
    settled = settle(propagator, system, state, gaps)
    growths = np.asarray(settings.depths) / x0[:, None]
    life = wear_down(
        propagator,
        system,
        state,
        gaps,
        settled.work,
        settled.regime,
        wear_shares(p),
        growths,
        periods,
        settings.accuracy,
        looks,
    ).history
    seen = np.flatnonzero(np.isfinite(life.time[0]))
    regime = confirmed_regimes(life.regime, CONFIRMED * max(1, looks // LOOKS))
    changed = np.flatnonzero(changes_of(regime)[0])
    wear_rate = wear_per_work(params) * params.forcing_frequency
    w0 = beams(p, settings).frequency[0, 0]
    time = np.concatenate([[0.0], life.time[0, seen]])
    gap = np.concatenate([gaps, life.gaps[0, seen]]) * x0[0]
    work = np.concatenate([settled.work, life.work[0, seen]])
    return dataset(
        {
            "time": ("look", time / wear_rate),
            "dimensionless_time": ("look", time * w0 / params.forcing_frequency),
            "gap": (("look", "site"), gap),
            "gap_ratio": ("look", gap[:, 1] / gap[:, 0]),
            "work_rate": (("look", "site"), work * watt(params)),
            "mean_work": (("look", "site"), work * params.forcing_frequency / w0),
            "regime": ("look", WORDS[np.concatenate([settled.regime, regime[0, seen]])]),
            "change_time": ("regime_change", life.time[0, changed] / wear_rate),
            "change_gap": (("regime_change", "site"), life.gaps[0, changed] * x0[0]),
            "change_from": ("regime_change", WORDS[regime[0, changed - 1]]),
            "change_to": ("regime_change", WORDS[regime[0, changed]]),
        },
        settings,
    )
