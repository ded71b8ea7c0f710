"""Survival curve of a life, with pointwise intervals and a simultaneous band."""

from typing import Any

import numpy as np
import xarray as xr

from uq.assess.failed_rows import outer, with_failed_at
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.sample import Sample
from uq.assess.weighted_mixture import as_sample
from uq.contract import Floats
from uq.result.result import AnyResult, Result
from uq.stats.intervals import Ends
from uq.stats.survival_curves import simultaneous_band


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
    whole = elements_with_laws(rows, [output.partition("[")[0]], plain=plain)
    chosen = [element for element in whole if element.name in wanted]
    samples = [as_sample(element, rows.dependence) for element in chosen]
    time = _times(samples)
    lost = any(element.failed.any() for element in chosen)
    curves = [_variables(sample, time, lost) for sample in samples]

    of = rows.dataset[chosen[0].output]
    places = {dim: of[dim] for dim in of.dims if dim != "row"}
    dims = tuple(places) if output == of.name else ()
    shape = tuple(of.sizes[dim] for dim in dims)
    data = {}
    for name in curves[0]:
        values = np.stack([curve[name] for curve in curves])
        along = ("time",) if values.ndim > 1 else ()
        attrs = {"long_name": _MEANINGS[name], "units": "1"}
        data[name] = ((*dims, *along), values.reshape(shape + values.shape[1:]), attrs)
    coords = places if dims else chosen[0].place
    axis = ("time", time, {"long_name": "time", "units": chosen[0].declared.unit})
    attrs = {"output": output, "long_name": of.attrs["long_name"]}
    attrs["band"] = _why_no_band(samples[0]) or BAND
    if chosen[0].law is not None:
        attrs["integrated"] = " ".join(chosen[0].law.inputs)
    return xr.Dataset(data, {**coords, "time": axis}, attrs)


BAND = (
    "covers the entire curve with 95 % confidence: beta quantiles with the same tail probability at"
    " all times, exact without censored rows"
)
NO_BAND = "none: a simultaneous band needs independent rows"
NO_INSPECTED_BAND = "none: lives are known within intervals, or rows entered late"
NO_WEIGHTED_BAND = "none: a simultaneous band needs rows of equal weight"


def _why_no_band(sample: Sample) -> str:
    if sample.element.has_intervals_or_entries:
        return NO_INSPECTED_BAND
    if sample.is_simple_random:
        return ""
    return NO_BAND if sample.effective_rows is None else NO_WEIGHTED_BAND


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
    "failed": "number of invalid rows",
    "failed_low": "lower end of the pointwise 95 % interval if the invalid rows had ended at once",
    "failed_high": "upper end of the pointwise 95 % interval if the invalid rows never ended",
}


def _times(samples: list[Sample]) -> Floats:
    """Return the times of all samples, or some of these for laws of lives."""
    time = np.unique(np.concatenate([sample.times for sample in samples]))
    most = min(sample.most_times for sample in samples)
    if len(time) <= most:
        return time
    return time[np.linspace(0, len(time) - 1, int(most)).round().astype(int)]


def _variables(sample: Sample, time: Floats, with_failed: bool) -> dict[str, Any]:
    """Return every variable of `survival` for one element, named and ordered as there."""
    element, curve = sample.element, sample.survival(time)
    kept = element.present
    rows = int(kept.sum())
    worth = None if element.weights is None else element.weights[kept]
    never = np.average(element.never[kept], weights=worth) if rows else np.nan
    variables = curve._asdict() | dict(
        zip(("band_low", "band_high"), _band(sample, time), strict=True)
    )
    variables |= {"never": never, "rows": rows}
    variables |= {
        name: getattr(element, name).sum() for name in ("censored", "undefined", "failed")
    }
    if with_failed:
        for end, life in (("low", 0.0), ("high", np.inf)):
            other = as_sample(with_failed_at(element, life), sample.dependence).survival(time)
            alone = np.isnan(other.low).all() and np.isnan(other.high).all()
            bound = other.survival if alone else getattr(other, end)
            variables[f"failed_{end}"] = outer(end, bound, getattr(curve, end))
    return variables


def _band(sample: Sample, time: Floats) -> Ends:
    """Return the simultaneous 95 % band of lives as computed; NaN without one."""
    element = sample.element
    values, censored = element.at_least, element.censored[element.present]
    if len(values) == 0 or _why_no_band(sample):
        return np.full(len(time), np.nan), np.full(len(time), np.nan)
    known_at_once = element.declared.never_known_at_once
    return simultaneous_band(values, censored, time, known_at_once=known_at_once)
