"""Lifetimes: the share of rows that outlives each time."""

from typing import Any

import numpy as np
import xarray as xr
from scipy import stats

from uq.analysis.failed_rows import outer, with_failed_at
from uq.analysis.kaplan_meier import Outliving, outliving
from uq.analysis.survival_band import simultaneous_band
from uq.exact_shares import are_few, exact_interval
from uq.intervals import CONFIDENCE, Ends, Replicates, scattered_share_interval
from uq.rows.elements import Element, Floats, independent_rows, lifetimes, replicates_of


def survival(ds: xr.Dataset, output: str) -> xr.Dataset:
    """Estimate how likely a lifetime exceeds each time.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        A lifetime, or one element of it such as ``time_to_depth[site=left,depth=0.00025]``. All
        elements of an output share one time axis: of a large result ask for one at a time.

    Returns
    -------
    xarray.Dataset
        Dimensions: those of the output, and ``time`` [s], every time at which a row ended or was
        last seen. ``survival``: the estimate of Kaplan and Meier. Where the output declares that a
        life that never ends is known at once, it is that of the rows that end, times their share,
        plus the share that never does. ``low``, ``high``: its pointwise 95 % interval, for
        independent rows by the exponential Greenwood formula [1]_, else from the replicates; NaN
        where nothing can be said. ``band_low``, ``band_high``: a 95 % band that holds the whole
        curve, of independent rows only; see the attribute ``band``. ``never``: the share of rows
        known never to end. Counts: ``rows``, ``censored``, and ``undefined`` and ``failed``, which
        take no part.

    Raises
    ------
    InputError
        When there is no such output or it is not a lifetime.

    References
    ----------
    .. [1] S. Sawyer, "The Greenwood and exponential Greenwood confidence intervals in survival
       analysis" (2003).

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> curve = uq.survival(ds, "life")
    >>> half = curve.sel(time=1e6, method="ffill")  # the median is known
    >>> bool(half["low"] < 0.5 < half["high"])
    True
    """
    rows = independent_rows(ds)
    chosen = lifetimes(rows, output)
    time = np.unique(np.concatenate([_finite(element.values) for element in chosen]))
    replicate = replicates_of(rows)
    curves = [curve(element, time, replicate) for element in chosen]
    for found, element in zip(curves, chosen, strict=True):
        whole_band = band(element, time) if replicate is None else _no_band(time)
        found["band_low"], found["band_high"] = whole_band
    meanings = dict(_VARIABLES)
    if any(element.failed.any() for element in chosen):
        meanings |= _WITH_FAILED
        for one, element in zip(curves, chosen, strict=True):
            one |= _failed_band(element, time, replicate, one)

    whole = rows[chosen[0].output]
    places = {dim: whole[dim] for dim in whole.dims if dim != "sample"}
    dims = tuple(places) if output == whole.name else ()
    shape = tuple(whole.sizes[dim] for dim in dims)
    data = {}
    for name, meaning in meanings.items():
        values = np.stack([one[name] for one in curves])
        along = ("time",) if values.ndim > 1 else ()
        attrs = {"long_name": meaning, "units": "1"}
        data[name] = ((*dims, *along), values.reshape(shape + values.shape[1:]), attrs)
    coords = places if dims else chosen[0].place
    axis = ("time", time, {"long_name": "time", "units": "s"})
    attrs = {"output": output, "long_name": whole.attrs["long_name"]}
    attrs["band"] = BAND if replicate is None else NO_BAND
    return xr.Dataset(data, {**coords, "time": axis}, attrs)


BAND = (
    "holds the whole curve with 95 % confidence: Kolmogorov's without censored rows, else Hall and"
    " Wellner's, which ends where fewer than 10 rows are at risk"
)
NO_BAND = "none: a band for a whole curve takes independent rows"

_VARIABLES = {
    "survival": "probability of a longer life",
    "low": "lower end of the pointwise 95 % interval",
    "high": "upper end of the pointwise 95 % interval",
    "band_low": "lower end of the simultaneous 95 % band",
    "band_high": "upper end of the simultaneous 95 % band",
    "never": "share of rows that never end",
    "rows": "number of rows with a lifetime",
    "censored": "number of rows of which only a lower bound is known",
    "undefined": "number of rows whose lifetime has no meaning",
    "failed": "number of rows that failed",
}


_WITH_FAILED = {
    "failed_low": "lower end of the pointwise 95 % interval if the failed rows had ended at once",
    "failed_high": "upper end of the pointwise 95 % interval if the failed rows never ended",
}


def _failed_band(
    element: Element, time: Floats, replicate: Replicates, plain: dict[str, Any]
) -> dict[str, Floats]:
    """Return the band with the failed rows at worst and at best; NaN where nothing can be said."""
    ends = {}
    for end, life in (("low", 0.0), ("high", np.inf)):
        found = curve(with_failed_at(element, life), time, replicate)
        alone = np.isnan(found["low"]).all() and np.isnan(found["high"]).all()
        ends[f"failed_{end}"] = outer(end, found["survival" if alone else end], plain[end])
    return ends


def curve(element: Element, time: Floats, replicate: Replicates) -> dict[str, Any]:
    """Return every variable of `survival` for one element, at times [s] that ascend."""
    values, censored = element.at_least, element.censored[element.present]
    counts = {name: getattr(element, name).sum() for name in ("censored", "undefined", "failed")}
    counts["rows"] = len(values)
    if len(values) == 0:
        unknown = np.full(len(time), np.nan)
        return counts | {"never": np.nan} | dict.fromkeys(("survival", "low", "high"), unknown)
    known_at_once = element.declared.never_known_at_once
    found = outliving(values, censored, time, known_at_once)
    if replicate is None:
        interval = _greenwood(found)
    else:
        of = replicate[element.present]
        estimates = [
            outliving(values[of == r], censored[of == r], time, known_at_once).share
            for r in np.unique(of)
        ]
        seen = len(values) - np.searchsorted(np.sort(values[censored]), time, side="right")
        rows = np.where((found.share > 0) & (found.share < 1), seen, np.nan)
        interval = scattered_share_interval(found.share, np.array(estimates), rows=rows)
    never = element.never.sum() / len(values)
    low, high = interval
    return counts | {"never": never, "survival": found.share, "low": low, "high": high}


def band(element: Element, time: Floats) -> Ends:
    """Return the simultaneous 95 % band of `survival` for one element of independent rows."""
    values, censored = element.at_least, element.censored[element.present]
    if len(values) == 0:
        return _no_band(time)
    found = outliving(values, censored, time, element.declared.never_known_at_once)
    among = found.among or found
    at_risk = found.ending * len(values) - np.searchsorted(np.sort(values), time)
    with np.errstate(divide="ignore", invalid="ignore"):
        deviation = np.sqrt(among.variance) / among.share
    return simultaneous_band(
        ending=found.ending,
        among=among.share,
        deviation=deviation,
        at_risk=at_risk.astype(float),
        rows=len(values),
        ended=int((np.isfinite(values) & ~censored).sum()),
        complete=not censored.any(),
    )


_FEW_ENDS = 4


def _greenwood(estimate: Outliving) -> Ends:
    """Return the interval that is symmetric about the logarithm of -log(share).

    Where few rows have ended, or are left, it is exact for a share that is known as well: there it
    misses on one side in up to 13 % of samples.
    """
    share, deviation = estimate.share, np.sqrt(estimate.variance)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = np.log(-np.log(share))
        half = stats.norm.ppf(0.5 + CONFIDENCE / 2) * deviation / (share * -np.log(share))
        low, high = (np.exp(-np.exp(middle + side * half)) for side in (1, -1))
        worth = share * (1 - share) / estimate.variance
    known, few = (share > 0) & (share < 1), are_few(share, worth, _FEW_ENDS)
    exact = exact_interval(share, worth, CONFIDENCE)
    ends = (np.where(few, *pair) for pair in zip(exact, (low, high), strict=True))
    low, high = (np.where(known, end, np.nan) for end in ends)
    return low, high


def _no_band(time: Floats) -> Ends:
    return np.full(len(time), np.nan), np.full(len(time), np.nan)


def _finite(values: Floats) -> Floats:
    return values[np.isfinite(values)]
