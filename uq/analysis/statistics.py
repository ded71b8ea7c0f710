"""What a result says: counts, moments, quantiles and probabilities, each with its interval."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq import intervals, json_form, order_statistics
from uq.analysis.accuracy import accuracy_missed
from uq.analysis.b_lives import b_lives, ended_by, entry, life_quantiles, quantile_entry
from uq.analysis.failed_rows import failed_note, failed_share_bounds, with_failed_bounds
from uq.analysis.life_fit import fits_of
from uq.analysis.regime_split import between_share
from uq.contract import Status
from uq.designs.registry import DESIGNS
from uq.estimate import NOTHING
from uq.indices.targets import number_of
from uq.intervals import Replicates
from uq.moments import Moments, moments
from uq.rows import stopping
from uq.rows.elements import (
    Element,
    Mask,
    analysis_of,
    are_independent,
    elements_of,
    flags,
    independent_rows,
    output_names,
    replicates_of,
    shown_outputs,
    study_file_of,
    why_no_statistics,
)
from uq.rows.in_regime import within_regime
from uq.study.file import AnalysisTable

NO_INTERVALS = (
    "no intervals: the rows of a '{design}' design are not independent, and with replicates = 1"
    " nothing shows how far its estimates scatter; set replicates = 8"
)

NOT_STATED = (
    "no intervals: nothing is known of how imported rows came about; if they are independent draws"
    " of the laws, set independent = true in [design]"
)

NO_STATISTICS = "no statistics: the rows of a '{design}' design {why}; see 'uq sensitivity'"


def summarise(
    ds: xr.Dataset,
    analysis: AnalysisTable | None = None,
    regime: str | None = None,
    fits: bool = False,
) -> dict[str, Any]:
    """Describe a result in plain data, ready for JSON.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    analysis : AnalysisTable, optional
        What to show; by default what the result's own study asks for.
    regime : str, optional
        Describe the rows in this regime only; those that failed without one count as failed.
    fits : bool
        Whether each lifetime also has ``fits``, as `uq.life_fits` returns them.

    Returns
    -------
    dict
        ``samples`` and ``status`` count all rows. Everything else is about the ``rows_used``, the
        independent ones: ``regime`` (label -> count and share with interval), ``outputs`` (name of
        element -> mean, sd, their intervals, ``tail``: the shape k of its heavier tail with its
        interval, the number of values it was fitted to and their side, ``reasons``: why the tail
        forbids any of these four, quantiles, tolerance, thresholds, ``b_lives`` of lifetimes,
        ``between_regimes``: the share of the variance of the number named ``of``, itself or the
        logarithm or rank of a lifetime, that lies between them,
        ``accuracy``: how many rows state an error beyond the accuracy asked for, if one was,
        counts of never, censored, undefined and failed rows) and ``notes``, sentences on what could
        not be given. A number that does not exist or is not finite is None; beside it ``never``,
        ``low_censored`` and the like say why. Where rows failed, each probability, quantile and
        B-life has ``failed_low`` and ``failed_high`` (`uq.analysis.failed_rows`).
    """
    analysis = analysis or analysis_of(ds)
    notes = _notes(ds)
    if regime is not None:
        ds = within_regime(ds, regime)
    rows = independent_rows(ds)
    replicate = replicates_of(rows)
    outputs = shown_outputs(ds, analysis)
    codes = rows["regime"].values if "regime" in output_names(ds) else None
    described = {
        element.name: _describe(element, replicate, analysis)
        | _between(element, codes, replicate)
        | accuracy_missed(rows, element)
        | ({"fits": fits_of(element, replicate is None)} if _fitted(element, fits) else {})
        for element in elements_of(rows, outputs)
    }
    return {
        "samples": ds.sizes["sample"],
        "rows_used": rows.sizes["sample"],
        "status": status_counts(ds),
        "regime": {} if codes is None else regime_shares(rows),
        "outputs": described,
        "notes": notes + failed_note(described.values(), rows.sizes["sample"]),
    }


def status_counts(ds: xr.Dataset) -> dict[str, int]:
    """Return how many rows ended how, all rows, for each status that occurs and ``ok``."""
    codes = ds["status"].values
    counts = {label: int((codes == code).sum()) for code, label in flags(ds["status"])}
    return {label: count for label, count in counts.items() if count or label == "ok"}


def regime_shares(rows: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return count and share of each regime among the rows that did not fail.

    Parameters
    ----------
    rows : xarray.Dataset
        Independent rows of a result.

    Returns
    -------
    dict
        Label -> ``count``, ``share``, ``low``, ``high``, where rows failed ``failed_low`` and
        ``failed_high``; also for regimes that do not occur.
    """
    codes = rows["regime"].values
    kept = (codes >= 0) | (rows["status"].values == Status.OK)
    replicate = _of(replicates_of(rows), kept)
    shares = {}
    for code, label in flags(rows["regime"]):
        if code >= 0:
            hits = codes[kept] == code
            estimate = _share(hits, replicate)
            estimate |= failed_share_bounds(codes == code, ~kept, replicates_of(rows))
            shares[label] = {"count": int(hits.sum()), "share": estimate.pop("value")} | estimate
    return shares


COUNTS = ("never", "censored", "undefined", "failed")
"""Kinds of rows without a number, counted for each element."""


def _describe(element: Element, replicate: Replicates, analysis: AnalysisTable) -> dict[str, Any]:
    within = _of(replicate, element.present)
    return {
        "units": element.units,
        **_moments(element, within),
        "tolerance": _tolerance(element, replicate, analysis),
        **with_failed_bounds(element, lambda one: _points(one, replicate, analysis)),
    } | {count: int(getattr(element, count).sum()) for count in COUNTS}


def _points(
    element: Element, replicate: Replicates, analysis: AnalysisTable
) -> dict[str, dict[str, Any]]:
    """Return the quantiles, B-lives and probabilities of an element."""
    asked = {repr(probability): probability for probability in analysis.quantiles}
    return {
        "quantiles": _quantiles(element, asked, replicate),
        "thresholds": {
            repr(threshold): _threshold(element, threshold, replicate)
            for threshold in analysis.thresholds.get(element.output, ())
        },
        "b_lives": b_lives(element, replicate) if element.is_lifetime else {},
    }


def _quantiles(
    element: Element, asked: dict[str, float], replicate: Replicates
) -> dict[str, dict[str, Any]]:
    """Return quantiles, and beside those that censored rows leave open Kaplan and Meier's."""
    within = _of(replicate, element.present)
    found = {name: quantile_entry(element, p, within) for name, p in asked.items()}
    if element.is_lifetime:
        for name, guess in life_quantiles(element, asked, replicate).items():
            if "assumes" in guess:
                found[name]["kaplan_meier"] = guess
    return found


def _moments(element: Element, within: Replicates) -> dict[str, Any]:
    values = element.at_least
    if not len(values) or element.never.any() or element.censored.any():
        nothing = json_form.ends(NOTHING)
        numbers = {"mean": None, "mean_interval": nothing, "sd": None, "sd_interval": nothing}
        return numbers | {"tail": None, "reasons": {}, "caution": None}
    found = moments(values, within)
    return {
        "mean": _plain(found.mean.value),
        "mean_interval": json_form.ends(found.mean),
        "sd": _plain(found.sd.value),
        "sd_interval": json_form.ends(found.sd),
        "tail": found.tail and found.tail._asdict(),
        "reasons": _reasons(found),
        "caution": found.caution,
    }


def _reasons(found: Moments) -> dict[str, str]:
    reasons = {"sd_interval": found.sd.reason, "mean_interval": found.mean.reason}
    for name, one in (("sd", found.sd), ("mean", found.mean)):
        if np.isnan(one.value):
            reasons[name] = one.reason
    return {name: reason for name, reason in reasons.items() if reason}


def _tolerance(
    element: Element, replicate: Replicates, analysis: AnalysisTable
) -> dict[str, Any] | None:
    if analysis.tolerance is None or replicate is not None:
        return None
    failed = int(element.failed.sum())
    early = order_statistics.tolerance_bounds(element.at_least, failed, *analysis.tolerance)
    late = order_statistics.tolerance_bounds(element.at_most, failed, *analysis.tolerance)
    bounds = entry(lower=(early[0], early[0]), upper=(early[1], late[1]))
    return bounds | {"rows_needed": order_statistics.rows_needed(*analysis.tolerance, failed)}


def _fitted(element: Element, fits: bool) -> bool:
    return fits and element.is_lifetime


def _between(
    element: Element, codes: NDArray[np.integer] | None, replicate: Replicates
) -> dict[str, Any]:
    target = number_of(element)
    if codes is None or target.refused:
        return {}
    split = between_share(target.values, codes, replicate)
    if not np.isfinite(split.value):
        return {}
    return {"between_regimes": json_form.numbers(split) | {"of": target.name}}


def _threshold(element: Element, threshold: float, replicate: Replicates) -> dict[str, Any]:
    kept = ~element.failed
    undefined = {"undefined": _plain(element.undefined[kept].mean()) if kept.any() else None}
    sides = event(element, threshold)
    if sides is None:
        unknown = int((element.censored & (element.values < threshold)).sum())
        nothing = dict.fromkeys(("value", "low", "high"))
        reason = f"{unknown} of {len(kept)} rows were censored before then"
        guess = {"kaplan_meier": ended_by(element, threshold, replicate)}
        return {"above": nothing, "below": nothing} | undefined | {"reason": reason} | guess
    within = _of(replicate, kept)
    above, below = (_share(side[kept], within) for side in sides)
    return {"above": above, "below": below} | undefined


def event(element: Element, threshold: float) -> tuple[Mask, Mask] | None:
    """Return which rows lie above and which below a threshold, by magnitude for an angle.

    Parameters
    ----------
    element : Element
    threshold : float

    Returns
    -------
    tuple of ndarray of bool, or None
        Rows without a value lie on neither side. None where rows were censored before the
        threshold, so that nobody knows.
    """
    values, censored = element.values, element.censored
    if (censored & (values < threshold)).any():
        return None
    values = element.for_thresholds
    above = (values > threshold) | (censored & (values == threshold))
    return above, (values < threshold) & ~censored


def _share(hits: Mask, replicate: Replicates) -> dict[str, Any]:
    low, high = intervals.share_interval(hits, replicate)
    value = hits.mean() if len(hits) else np.nan
    return {"value": _plain(value), "low": _plain(low), "high": _plain(high)}


def _of(replicate: Replicates, rows: Mask) -> Replicates:
    return None if replicate is None else replicate[rows]


def _plain(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None


def _notes(ds: xr.Dataset) -> list[str]:
    if why := why_no_statistics(ds):
        return [NO_STATISTICS.format(design=ds.attrs["design"], why=why)]
    design = study_file_of(ds).design
    notes = []
    if design.until is not None:
        notes.append(stopping.sentence(design, ds))
    if not are_independent(ds) and ds.attrs["replicates"] == 1:
        reason = NOT_STATED if DESIGNS[ds.attrs["design"]].imported else NO_INTERVALS
        notes.append(reason.format(design=ds.attrs["design"]))
    return notes
