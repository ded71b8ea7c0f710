"""Lifetimes: the share of rows that outlives each time."""

import warnings
from typing import Any

import numpy as np
import xarray as xr
from scipy import stats

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
        last seen. ``survival``: the estimate of Kaplan and Meier. ``low``, ``high``: its pointwise
        95 % interval, for independent rows by the exponential Greenwood formula [1]_, else from
        the replicates; NaN where nothing can be said. ``never``: the share of rows known never to
        end. Counts: ``rows``, ``censored``, and ``undefined`` and ``failed``, which take no part.

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

    whole = rows[chosen[0].output]
    places = {dim: whole[dim] for dim in whole.dims if dim != "sample"}
    dims = tuple(places) if output == whole.name else ()
    shape = tuple(whole.sizes[dim] for dim in dims)
    data = {}
    for name, meaning in _VARIABLES.items():
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


def curve(element: Element, time: Floats, replicate: Replicates) -> dict[str, Any]:
    """Return every variable of `survival` for one element, at times [s] that ascend."""
    values, censored = element.at_least, element.censored[element.present]
    counts = {name: getattr(element, name).sum() for name in ("censored", "undefined", "failed")}
    counts["rows"] = len(values)
    if len(values) == 0:
        unknown = np.full(len(time), np.nan)
        return counts | {"never": np.nan} | dict.fromkeys(("survival", "low", "high"), unknown)
    estimate = _kaplan_meier(values, censored, time)
    share = estimate.evaluate(time)
    if replicate is None:
        interval = _greenwood(estimate, time)
    else:
        of = replicate[element.present]
        estimates = [
            _kaplan_meier(values[of == r], censored[of == r], time).evaluate(time)
            for r in np.unique(of)
        ]
        interval = scattered_share_interval(share, np.array(estimates))
    never = element.never.sum() / len(values)
    return counts | {"never": never, "survival": share} | interval._asdict()


def _kaplan_meier(values: Floats, censored: Mask, time: Floats) -> Any:
    """Return scipy's estimate; it takes no infinities: what never ends leaves at the end."""
    never = np.isposinf(values)
    ended = ~never & ~censored
    left = np.where(never, time.max(initial=0.0), values)[~ended]
    return stats.ecdf(stats.CensoredData(uncensored=values[ended], right=left)).sf


def _greenwood(estimate: Any, time: Floats) -> Interval:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # says that some ends are not defined
        interval = estimate.confidence_interval(CONFIDENCE, method="log-log")
    return Interval(interval.low.evaluate(time), interval.high.evaluate(time))


def _finite(values: Floats) -> Floats:
    return values[np.isfinite(values)]
