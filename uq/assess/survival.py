"""Lifetimes: the probability of a longer life than each time."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from uq.assess.failed_rows import outer, with_failed_at
from uq.assess.population import Population
from uq.assess.scaling import population
from uq.result.elements import Element, Floats, Mask
from uq.result.result import AnyResult, Result
from uq.stats.beta_products import BetaProducts
from uq.stats.clusters import Clusters, dealt
from uq.stats.intervals import (
    CONFIDENCE,
    Ends,
    Replicates,
    scattered_share_interval,
    upper_probability,
)
from uq.stats.kaplan_meier import SurvivalCurve, outliving
from uq.stats.quantile_functions import normal
from uq.stats.survival_band import simultaneous_band


def survival(result: AnyResult, output: str, *, plain: bool = False) -> xr.Dataset:
    """Estimate how likely a lifetime exceeds each time.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        A lifetime, or one element of it such as ``time_to_depth[site=left,depth=0.00025]``. All
        elements of an output share one time axis: of a large result ask for one at a time.
    plain : bool
        Whether lives are taken as computed; by default what only scales them is integrated exactly.

    Returns
    -------
    xarray.Dataset
        Dimensions: those of the output, and ``time`` [s], every time at which a row ended or was
        censored. ``survival``: the estimate of Kaplan and Meier. Where the output declares that a
        life that never ends is known at once, it is that of the rows that end, times their share,
        plus the share that never does. ``low``, ``high``: its pointwise 95 % interval, for
        independent rows by the exponential Greenwood formula [1]_ or, with fewer than 5 ends so far
        or 10 rows still at risk, by products of beta variables [2]_, which are conservative; else
        from the replicates; NaN where unknown. Where rows are laws of lives (attribute
        ``integrated``), the mean of their probabilities at up to 500 of these times, between which
        to interpolate; so where rows have weights. ``band_low``, ``band_high``: a simultaneous 95 %
        band, for independent rows only; see the attribute ``band``. ``never``: the share of rows
        known never to end. Counts: ``rows``, ``censored``, and ``undefined`` and ``failed``, which
        are excluded.

    Raises
    ------
    InputError
        When there is no such output or it is not a lifetime.

    References
    ----------
    .. [1] S. Sawyer, "The Greenwood and exponential Greenwood confidence intervals in survival
       analysis" (2003).
    .. [2] M. P. Fay, E. H. Brittain, M. A. Proschan, "Pointwise confidence intervals for a survival
       distribution with small samples or heavy censoring", Biostatistics 14, 723-736 (2013).

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> curve = uq.survival(ds, "life")
    >>> half = curve.sel(time=1e6, method="ffill")  # the median is known
    >>> bool(half["low"] < 0.5 < half["high"])
    True
    """
    result = Result.of(result)
    rows = result.independent
    wanted = {element.name for element in rows.lifetimes(output)}
    whole = population(rows, [output.partition("[")[0]], plain=plain)
    chosen = [element for element in whole if element.name in wanted]
    time = _times(chosen)
    replicate = rows.replicates
    lost = any(element.failed.any() for element in chosen)
    found = [_variables(element, time, replicate, lost) for element in chosen]

    of = rows.dataset[chosen[0].output]
    places = {dim: of[dim] for dim in of.dims if dim != "sample"}
    dims = tuple(places) if output == of.name else ()
    shape = tuple(of.sizes[dim] for dim in dims)
    data = {}
    for name in found[0]:
        values = np.stack([one[name] for one in found])
        along = ("time",) if values.ndim > 1 else ()
        attrs = {"long_name": _MEANINGS[name], "units": "1"}
        data[name] = ((*dims, *along), values.reshape(shape + values.shape[1:]), attrs)
    coords = places if dims else chosen[0].place
    axis = ("time", time, {"long_name": "time", "units": chosen[0].declared.unit})
    attrs = {"output": output, "long_name": of.attrs["long_name"]}
    attrs["band"] = _why_no_band(chosen[0], replicate) or BAND
    if chosen[0].law is not None:
        attrs["integrated"] = " ".join(chosen[0].law.inputs)
    return xr.Dataset(data, {**coords, "time": axis}, attrs)


BAND = (
    "covers the entire curve with 95 % confidence: beta quantiles with the same tail probability at"
    " all times, exact without censored rows"
)
NO_BAND = "none: a simultaneous band needs independent rows"
NO_WEIGHTED_BAND = "none: a simultaneous band needs rows of equal weight"


def _why_no_band(element: Element, replicate: Replicates) -> str:
    if element.weights is not None:
        return NO_WEIGHTED_BAND
    return "" if replicate is None else NO_BAND


_MEANINGS = {
    "survival": "probability of a longer life",
    "low": "lower end of the pointwise 95 % interval",
    "high": "upper end of the pointwise 95 % interval",
    "band_low": "lower end of the simultaneous 95 % band",
    "band_high": "upper end of the simultaneous 95 % band",
    "never": "share of rows that never end",
    "rows": "number of rows with a lifetime",
    "censored": "number of rows with a lower bound only",
    "undefined": "number of rows with an undefined lifetime",
    "failed": "number of rows that failed",
    "failed_low": "lower end of the pointwise 95 % interval if the failed rows had ended at once",
    "failed_high": "upper end of the pointwise 95 % interval if the failed rows never ended",
}


_MOST_TIMES = 500
_RARE = 1e-4  # share of the weight that ends before the first time, and after the last


def _times(chosen: list[Element]) -> Floats:
    """Return every time at which a row ended, or some of these for laws of lives or weights."""
    if all(element.weights is not None for element in chosen):
        return np.unique(np.concatenate([_weighted_times(element) for element in chosen]))
    time = np.unique(np.concatenate([e.values[np.isfinite(e.values)] for e in chosen]))
    if all(element.is_plain for element in chosen) or len(time) <= _MOST_TIMES:
        return time
    return time[np.linspace(0, len(time) - 1, _MOST_TIMES).round().astype(int)]


def _weighted_times(element: Element) -> Floats:
    """Return times between which equal shares of the weight have ended."""
    assert element.weights is not None
    ended = np.isfinite(element.values)
    order = np.argsort(element.values[ended], kind="stable")
    time, share = element.values[ended][order], np.cumsum(element.weights[ended][order])
    if not len(time):
        return time
    wanted = np.linspace(_RARE, 1 - _RARE, min(_MOST_TIMES, len(time))) * share[-1]
    return np.asarray(time[np.searchsorted(share, wanted)])


class Curve(NamedTuple):
    """The share that outlives each time, and its pointwise 95 % interval; shapes (k,)."""

    survival: Floats
    low: Floats
    high: Floats


def _variables(
    element: Element, time: Floats, replicate: Replicates, with_failed: bool
) -> dict[str, Any]:
    """Return every variable of `survival` for one element, named and ordered as there."""
    plain = curve(element, time, replicate)
    band_low, band_high = _band(element.plain, time, replicate)
    kept = element.present
    rows = int(kept.sum())
    worth = None if element.weights is None else element.weights[kept]
    never = np.average(element.never[kept], weights=worth) if rows else np.nan
    found = plain._asdict() | {"band_low": band_low, "band_high": band_high}
    found |= {"never": never, "rows": rows}
    found |= {name: getattr(element, name).sum() for name in ("censored", "undefined", "failed")}
    if with_failed:
        for end, life in (("low", 0.0), ("high", np.inf)):
            other = curve(with_failed_at(element, life), time, replicate)
            alone = np.isnan(other.low).all() and np.isnan(other.high).all()
            bound = other.survival if alone else getattr(other, end)
            found[f"failed_{end}"] = outer(end, bound, getattr(plain, end))
    return found


def curve(
    element: Element, time: Floats, replicate: Replicates, confidence: float = CONFIDENCE
) -> Curve:
    """Return the estimate of `survival` for one element, at times [s] that ascend."""
    if not element.is_plain:
        rows = Population(element, replicate, confidence)
        return Curve(*np.array([rows.outliving(at).numbers for at in time]).reshape(-1, 3).T)
    values, censored = element.at_least, element.censored[element.present]
    if len(values) == 0:
        return Curve(*np.full((3, len(time)), np.nan))
    known_at_once = element.declared.never_known_at_once
    found = outliving(values, censored, time, known_at_once=known_at_once)
    if replicate is None:
        ends = _pointwise(values, censored, time, confidence, found, known_at_once)
        return Curve(found.share, *ends)
    of = dealt(replicate[element.present])
    estimates = [
        outliving(values[of == r], censored[of == r], time, known_at_once=known_at_once).share
        for r in np.unique(of)
    ]
    seen = len(values) - np.searchsorted(np.sort(values[censored]), time, side="right")
    at_risk = np.where((found.share > 0) & (found.share < 1), seen, np.nan)
    samples = replicate.samples if isinstance(replicate, Clusters) else None
    interval = scattered_share_interval(
        found.share, np.array(estimates), None, confidence, rows=at_risk, samples=samples
    )
    return Curve(found.share, *interval)


def _band(element: Element, time: Floats, replicate: Replicates) -> Ends:
    """Return the simultaneous 95 % band of `survival` for one element; NaN for replicates."""
    values, censored = element.at_least, element.censored[element.present]
    if len(values) == 0 or _why_no_band(element, replicate):
        return np.full(len(time), np.nan), np.full(len(time), np.nan)
    known_at_once = element.declared.never_known_at_once
    return simultaneous_band(values, censored, time, known_at_once=known_at_once)


_FEW_ENDS = 5
_FEW_AT_RISK = 10


def _pointwise(
    values: Floats,
    censored: Mask,
    time: Floats,
    confidence: float,
    estimate: SurvivalCurve,
    known_at_once: bool,
) -> Ends:
    """Return the interval that is symmetric about the logarithm of -log(share).

    Where few rows have ended, or are still at risk, it is that of `BetaProducts`, which is
    conservative: there the other misses in up to 47 % of samples.
    """
    share, deviation = estimate.share, np.sqrt(estimate.variance)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = np.log(-np.log(share))
        half = normal(upper_probability(confidence)) * deviation / (share * -np.log(share))
        low, high = (np.exp(-np.exp(middle + side * half)) for side in (1, -1))
    inside = (share > 0) & (share < 1) & np.isfinite(deviation)
    law = BetaProducts(values, censored, known_at_once=known_at_once)
    ended, left = law.rows_ended_by(time), law.at_risk_after(time)
    few = (ended < _FEW_ENDS) | (left < _FEW_AT_RISK)
    upper = upper_probability(confidence)
    low[few] = 1 - law.ended_after(time[few]).quantile(upper)
    high[few] = 1 - law.ended_by(time[few]).quantile(1 - upper)
    return np.where(inside, low, np.nan), np.where(inside, high, np.nan)
