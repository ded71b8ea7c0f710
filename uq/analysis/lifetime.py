"""Lifetimes: the share of rows that outlives each time."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy import stats

from uq.analysis.failed_rows import HIGH, LOW, with_failed_at
from uq.intervals import CONFIDENCE, Interval, Replicates, scattered_share_interval
from uq.rows.elements import Element, Floats, Mask, independent_rows, lifetimes, replicates_of


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
        where nothing can be said. ``never``: the share of rows known never to end. Counts:
        ``rows``, ``censored``, and ``undefined`` and ``failed``, which take no part.

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
    meanings = dict(_VARIABLES)
    if any(element.failed.any() for element in chosen):
        meanings |= _WITH_FAILED
        for one, element in zip(curves, chosen, strict=True):
            one |= _failed_band(element, time, replicate)

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
    return xr.Dataset(data, {**coords, "time": axis}, attrs)


_VARIABLES = {
    "survival": "probability of a longer life",
    "low": "lower end of the pointwise 95 % interval",
    "high": "upper end of the pointwise 95 % interval",
    "never": "share of rows that never end",
    "rows": "number of rows with a lifetime",
    "censored": "number of rows of which only a lower bound is known",
    "undefined": "number of rows whose lifetime has no meaning",
    "failed": "number of rows that failed",
}


_WITH_FAILED = {
    LOW: "lower end of the pointwise 95 % interval if the failed rows had ended at once",
    HIGH: "upper end of the pointwise 95 % interval if the failed rows never ended",
}


def _failed_band(element: Element, time: Floats, replicate: Replicates) -> dict[str, Floats]:
    """Return the band with the failed rows at worst and at best; NaN where nothing can be said."""
    ends = {}
    for key, life, end in ((LOW, 0.0, "low"), (HIGH, np.inf, "high")):
        found = curve(with_failed_at(element, life), time, replicate)
        alone = np.isnan(found["low"]).all() and np.isnan(found["high"]).all()
        ends[key] = found["survival" if alone else end]
    return ends


def curve(element: Element, time: Floats, replicate: Replicates) -> dict[str, Any]:
    """Return every variable of `survival` for one element, at times [s] that ascend."""
    values, censored = element.at_least, element.censored[element.present]
    counts = {name: getattr(element, name).sum() for name in ("censored", "undefined", "failed")}
    counts["rows"] = len(values)
    if len(values) == 0:
        unknown = np.full(len(time), np.nan)
        return counts | {"never": np.nan} | dict.fromkeys(("survival", "low", "high"), unknown)
    known_at_once = element.never_known_at_once
    found = _estimate(values, censored, time, known_at_once)
    if replicate is None:
        interval = _greenwood(found)
    else:
        of = replicate[element.present]
        estimates = [
            _estimate(values[of == r], censored[of == r], time, known_at_once).share
            for r in np.unique(of)
        ]
        interval = scattered_share_interval(found.share, np.array(estimates))
    never = element.never.sum() / len(values)
    return counts | {"never": never, "survival": found.share} | interval._asdict()


class _Estimate(NamedTuple):
    """Share that outlives each time, and the variance of that estimate from independent rows."""

    share: Floats
    variance: Floats


def _estimate(values: Floats, censored: Mask, time: Floats, known_at_once: bool) -> _Estimate:
    """Estimate the share that outlives each time.

    Parameters
    ----------
    values : ndarray, shape (n,)
        +inf for rows that never end.
    censored : ndarray of bool, shape (n,)
    time : ndarray
        [s]
    known_at_once : bool
        Whether every censored row is one that ends.

    Returns
    -------
    _Estimate

    Notes
    -----
    With p the share of the n rows that end, and S the estimate of Kaplan and Meier among these,
    the share that outlives t is 1 - p + p S(t). Given how many rows end, S has no bias worth the
    name, so that the errors of p and S are uncorrelated, and the variance is
    (1 - S)^2 p (1 - p) / n + p^2 Var(S), with Greenwood's Var(S). Without censored rows that is
    the variance of the share of all rows, F (1 - F) / n with F = p (1 - S).

    Where never is learnt late, a row that never ends is at risk until the last time: p is 1.
    """
    never = np.isposinf(values)
    if not known_at_once:
        return _kaplan_meier(np.where(never, time.max(initial=0.0), values), never | censored, time)
    p = 1 - never.mean()
    of_ending = _kaplan_meier(values[~never], censored[~never], time)
    share = 1 - p + p * of_ending.share
    spread = (1 - of_ending.share) ** 2 * p * (1 - p) / len(values)
    return _Estimate(share, spread + p**2 * of_ending.variance)


def _kaplan_meier(values: Floats, censored: Mask, time: Floats) -> _Estimate:
    """Return Kaplan and Meier's estimate from finite values, with Greenwood's variance.

    scipy's ``ecdf`` has the first, but gives the second within its own intervals alone.
    """
    ends, count = np.unique(values[~censored], return_counts=True)
    at_risk = len(values) - np.searchsorted(np.sort(values), ends)
    share = np.cumprod((at_risk - count) / at_risk)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = share**2 * np.cumsum(count / (at_risk * (at_risk - count)))
    # All have ended: certain of these rows, unless some were lost from sight before.
    variance[share == 0] = np.nan if censored.any() else 0.0
    place = np.searchsorted(ends, time, side="right")
    return _Estimate(np.append(1.0, share)[place], np.append(0.0, variance)[place])


def _greenwood(estimate: _Estimate) -> Interval:
    """Return the interval that is symmetric about the logarithm of -log(share)."""
    share, deviation = estimate.share, np.sqrt(estimate.variance)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = np.log(-np.log(share))
        half = stats.norm.ppf(0.5 + CONFIDENCE / 2) * deviation / (share * -np.log(share))
        low, high = (np.exp(-np.exp(middle + side * half)) for side in (1, -1))
    known = (share > 0) & (share < 1)
    return Interval(*(np.where(known, end, np.nan) for end in (low, high)))


def _finite(values: Floats) -> Floats:
    return values[np.isfinite(values)]
