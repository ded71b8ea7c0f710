"""Weibull and lognormal laws fitted to lifetimes, and refused where they do not fit."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from uq.analysis.life_quantiles import B_LIVES
from uq.analysis.location_scale import FAMILIES, Family, anderson_darling, fit
from uq.intervals import CONFIDENCE
from uq.order_statistics import is_within
from uq.rows.elements import Element, Floats, Mask, independent_rows, lifetimes, replicates_of

MIN_ENDED = 20
"""Fewer ended lives than this fit every law."""

MAX_ROWS = 2000
"""More rows would refuse every law for differences that no one cares about."""

REFITS = 4999
"""Samples drawn from the fitted law, and fitted again; of many rows fewer, down to a fifth.

With so many an interval of 95 % covers 95 %, give or take 0.3 % for the luck of the draw; with a
fifth of them, 0.7 %.
"""

MOST_DRAWN = 400 * REFITS
"""Lives drawn for them all."""

LEVEL = 0.05

INDEPENDENT_ONLY = (
    "the test of fit holds for independent rows; use method = 'monte-carlo', or, of imported rows"
    " that are independent, independent = true"
)

ASSUMES = (
    "that lives follow this law: that a test of {rows} rows does not refuse it is no proof, least"
    " of all where no row lies"
)
"""What every number of an accepted law rests on."""


def fitted_laws(ds: xr.Dataset, output: str) -> dict[str, dict[str, Any]]:
    """Fit every law to a lifetime; see `uq.life_fits`.

    Returns
    -------
    dict
        Name of element -> ``weibull`` and ``lognormal`` -> ``p_value`` of the Anderson-Darling
        test, its law from refits; where it is above `LEVEL`, ``parameters`` (shape and scale [s];
        median [s] and sigma, named as in study files) and ``B1``, ``B10``, ``B50`` [s], each with
        ``value``, ``low``, ``high``, and ``extrapolated``: whether it is earlier than the rows
        reach, 1/(n + 1); ``assumes``, a sentence; else ``refused``, a sentence. ``rows``: how many
        were used.
    """
    rows = independent_rows(ds)
    independent = replicates_of(rows) is None
    return {one.name: fits_of(one, independent) for one in lifetimes(rows, output)}


def fits_of(element: Element, independent: bool) -> dict[str, Any]:
    """Fit every law to one element of a lifetime; see `fitted_laws`."""
    return {law: _one(law, element, independent) for law in FAMILIES}


class _Sample(NamedTuple):
    """Logarithms of lives, ascending, and which of them ended; shapes (k, n)."""

    x: Floats
    ended: Mask


def _one(law: str, element: Element, independent: bool) -> dict[str, Any]:
    life = element.at_least[:MAX_ROWS]
    ended = ~element.censored[element.present][:MAX_ROWS]
    entry: dict[str, Any] = {"rows": len(life)}
    if problem := _problem(life, ended, independent):
        return entry | {"refused": problem}
    family = FAMILIES[law]
    seen = _sorted(np.log(life)[None], ended[None])
    location, scale = (value[0] for value in fit(family, *seen))
    locations, scales, distances = _refits(law, location, scale, seen)
    kept = np.isfinite(locations)
    if not np.isfinite(scale) or kept.mean() < CONFIDENCE:
        return entry | {"refused": "the likelihood has no maximum that can be found"}
    distances = distances[kept]
    distance = _distance(family, location[None], scale[None], seen)
    entry["p_value"] = float((1 + (distances >= distance).sum()) / (1 + len(distances)))
    if entry["p_value"] < LEVEL:
        return entry | {
            "refused": f"does not fit: lives of this law lie as far from it in only"
            f" {entry['p_value']:.1%} of samples"
        }
    locations, scales = locations[kept], scales[kept]

    def at(w: float) -> dict[str, Any]:
        pivot = (locations + w * scales - location - w * scale) / scales
        value = location + w * scale
        return _interval(value, value - scale * pivot)

    spread = _interval(np.log(scale), np.log(scale) - np.log(scales / scale))
    if law == "weibull":
        shape = {"value": 1 / spread["value"], "low": 1 / spread["high"], "high": 1 / spread["low"]}
        entry["parameters"] = {"shape": shape, "scale": at(0.0)}
    else:
        entry["parameters"] = {"median": at(0.0), "sigma": spread}
    entry["assumes"] = ASSUMES.format(rows=len(life))
    return entry | {
        name: at(family.standard.ppf(p)) | {"extrapolated": not is_within(p, len(life))}
        for name, p in B_LIVES.items()
    }


def _problem(life: Floats, ended: Mask, independent: bool) -> str:
    """Say why no law can be fitted, or return ""."""
    if not independent:
        return INDEPENDENT_ONLY
    never = int((np.isposinf(life) & ended).sum())
    if never:
        return f"{never} of {len(life)} rows never end, and under this law all do"
    if (life <= 0).any():
        return f"{int((life <= 0).sum())} rows have no positive life, and under this law all have"
    if ended.sum() < MIN_ENDED:
        return f"only {int(ended.sum())} rows ended; {MIN_ENDED} are needed"
    if len(np.unique(life[ended])) < MIN_ENDED:
        return f"the rows that ended share fewer than {MIN_ENDED} values"
    return ""


def _sorted(x: Floats, ended: Mask) -> _Sample:
    order = np.lexsort((~ended, x), axis=1)  # of rows at one time, those that end come first
    return _Sample(np.take_along_axis(x, order, axis=1), np.take_along_axis(ended, order, axis=1))


def _refits(
    law: str, location: float, scale: float, seen: _Sample
) -> tuple[Floats, Floats, Floats]:
    """Return location, scale and distance of samples drawn from the fitted law."""
    n = seen.x.shape[1]
    if seen.ended.all():
        locations, scales, distances = _complete_refits(law, n)
        return location + scale * locations, scale * scales, distances
    rng = np.random.default_rng(0)
    family = FAMILIES[law]
    x = location + scale * family.standard.ppf(rng.random((_refits_of(n), n)))
    # The estimate of Kaplan and Meier with censoring for the end, and the end for censoring.
    share = 1 - np.cumprod(1 - ~seen.ended[0] / np.arange(n, 0, -1))
    place = np.searchsorted(share, rng.random(x.shape))
    limit = np.append(seen.x[0], np.inf)[place]
    drawn = _sorted(np.minimum(x, limit), x <= limit)
    found = fit(family, *drawn)
    return *found, _distance(family, *found, drawn)


@lru_cache(maxsize=4)
def _complete_refits(law: str, n: int) -> tuple[Floats, Floats, Floats]:
    """Return location, scale and distance of complete samples of n rows from the standard law.

    Those from any other location and scale are these, moved and scaled; distances stay.
    """
    family = FAMILIES[law]
    u = np.random.default_rng(0).random((_refits_of(n), n))
    x = np.sort(family.standard.ppf(u), axis=1)
    drawn = _Sample(x, np.ones_like(x, dtype=bool))
    found = fit(family, *drawn)
    return *found, _distance(family, *found, drawn)


def _refits_of(rows: int) -> int:
    return min(REFITS, MOST_DRAWN // rows)


def _distance(family: Family, location: Floats, scale: Floats, sample: _Sample) -> Floats:
    w = (sample.x - location[:, None]) / scale[:, None]
    return anderson_darling(family.standard.cdf(w), sample.ended)


def _interval(value: float, draws: Floats) -> dict[str, float]:
    """Return the exponentials of a value and of the ends of its interval."""
    low, high = np.quantile(draws, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2])
    logarithms = {"value": value, "low": low, "high": high}
    return {name: float(np.exp(logarithm)) for name, logarithm in logarithms.items()}
