"""Regimes compared: their inputs, outputs, boundary, and the variance between them."""

from typing import Any

import numpy as np
import xarray as xr

from uq.assess.fact import Fact
from uq.assess.row_inputs import EVERYWHERE, independent_inputs
from uq.assess.statistic import Statistic
from uq.assess.statistics.moments import between_share
from uq.assess.summary import REGIME, category_shares
from uq.assess.summary_facts import estimate_fact
from uq.assess.targets import IndexTarget, category_targets, number_of
from uq.contract import Floats
from uq.errors import InputError
from uq.indices.index import RefusedError
from uq.indices.method import DesignSample
from uq.indices.methods import KS, METHODS
from uq.result.elements import flags
from uq.result.result import AnyResult, Result
from uq.sampling.truncation import cdf_within
from uq.stats.estimate import Estimate
from uq.stats.moments import moments
from uq.stats.order_statistics import is_within
from uq.stats.uncertainty_exponent import uncertainty_exponent
from uq.study.input_checks import laws_of
from uq.text.numbers import percent, percent_interval

MOST_ROWS = 50_000
"""Largest number of rows compared: of larger results the first rows are used, to save time."""

BOUNDARY = "boundary"
"""Its part of the JSON of a summary."""

EXPONENT = "uncertainty_exponent"

DEPENDENT = "the rows of a '{design}' design are not independent; use design 'monte-carlo'"


def boundary(result: Result) -> Statistic | None:
    """Estimate how intermingled the regimes are over the inputs.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    Statistic or None
        The uncertainty exponent of the boundary between the regimes, or the reason why there is
        none; of one row of each sample. None where the rows do not end in several regimes, or have
        weights.
    """
    if REGIME not in result.dataset or result.has_weights:
        return None
    rows = compared_rows(result)
    if len(np.unique(rows.dataset[REGIME])) < 2:
        return None
    if result.has_independent_samples:
        exponent = _exponent(rows)
    else:
        exponent = Estimate(reason=DEPENDENT.format(design=result.design_name))
    label = EXPONENT.replace("_", " ")
    return Statistic((BOUNDARY, EXPONENT), label, exponent, by=(uncertainty_exponent,))


def compared_rows(result: Result) -> Result:
    """Return the first `MOST_ROWS` of the independent rows, one of each sample, with a regime."""
    rows = result.independent.first_rows.take(slice(MOST_ROWS))
    return rows.take((rows.dataset[REGIME].values >= 0) & ~rows.failed)


def _exponent(rows: Result) -> Estimate:
    laws, values = laws_of(rows.dataset.attrs["study"]), independent_inputs(rows)
    shares = [cdf_within(law, values[name], EVERYWHERE) for name, law in laws.items()]
    listed = [law.discrete for law in laws.values()]
    if all(listed):
        return Estimate(reason="no input varies continuously")
    table = np.column_stack(shares)
    kinds = np.unique(table[:, listed], axis=0, return_inverse=True)[1] if any(listed) else None
    return uncertainty_exponent(table[:, ~np.array(listed)], rows.dataset[REGIME].values, kinds)


def boundary_facts(result: Result, statistic: Statistic | None) -> Fact:
    """Return the boundary of a result; empty without several regimes."""
    if statistic is None:
        return Fact({})
    exponent = Fact({EXPONENT: estimate_fact(statistic)}, rows=compared_rows(result))
    return Fact({BOUNDARY: exponent})


def still_uncertain(exponent: Estimate) -> Estimate:
    """Return the share of outcomes that remain uncertain with half the input uncertainty."""
    value, high, low = (2.0 ** -np.clip(exponent.numbers, 0.0, 1.0)).tolist()
    return Estimate(value, low, high)


def in_words(statistic: Statistic) -> str:
    """Return the meaning of an uncertainty exponent, in a clause."""
    value, high, low = (1 - end for end in still_uncertain(statistic.estimate).numbers)
    return (
        f"with half the uncertainty of all inputs, {percent(value)} ({percent_interval(low, high)})"
        " fewer outcomes are uncertain (50 % at a smooth boundary between regimes, 0 %"
        " where they are intermingled everywhere)"
    )


PROBABILITIES = (0.05, 0.25, 0.5, 0.75, 0.95)


def regimes(result: AnyResult) -> xr.Dataset:
    """Compare the regimes of a result.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of a model with regimes.

    Returns
    -------
    xarray.Dataset
        Of the independent rows, over ``regime``: ``count``, and ``share`` with ``share_low`` and
        ``share_high``. Over ``regime`` and ``parameter``: ``input_quantile``, at each
        ``probability``, of the inputs of the rows in it (NaN where they do not reach it);
        ``distance``, of Kolmogorov and Smirnov, between these and the inputs of all other rows, and
        ``distance_dummy``, the largest for inputs without effect; NaN where one side has too few
        rows. Over ``output`` and ``regime``: ``rows``, ``mean``, ``sd`` (NaN where the tail is too
        heavy). Over ``output``: ``between``, the share of its variance between
        regimes, with ``between_low`` and ``between_high``. Lifetimes are replaced by their
        logarithms, or by their ranks where rows never end or are censored. Without a dimension:
        ``uncertainty_exponent`` of the boundary between the regimes, with ``_low`` and ``_high``;
        its attribute ``reason`` explains a NaN.

    Raises
    ------
    InputError
        When the result has no regimes.
    """
    result = Result.of(result)
    if "regime" not in result.dataset:
        raise InputError("this result has no regimes to compare")
    result.refuse_if_weighted("a comparison of regimes")
    rows = result.independent
    shares = {
        name: statistic
        for name, statistic in category_shares(rows, REGIME).items()
        if statistic.facts["count"]
    }
    codes = {name: code for code, name in flags(rows.dataset["regime"]) if name in shares}
    members = [rows.dataset["regime"].values == code for code in codes.values()]
    inputs = {
        str(name): variable.values
        for name, variable in rows.dataset.data_vars.items()
        if variable.attrs.get("role") == "input"
    }
    plain = rows.first_rows
    columns = {name: plain.dataset[name].values for name in inputs}
    quantiles = [[_quantiles(x[hits]) for x in inputs.values()] for hits in members]
    far = {target.name: _distances(columns, target) for target in category_targets(plain, "regime")}
    unknown = [np.nan] * (len(inputs) + 1)
    distances = [far.get(f"P(regime={name})", unknown) for name in codes]
    targets = [
        target
        for element in rows.elements(rows.shown_outputs(rows.analysis))
        if not (target := number_of(element)).refused
    ]
    moments = [[_moments(target.values[hits]) for hits in members] for target in targets]
    split = [
        between_share(t.values, rows.dataset["regime"].values, rows.dependence) for t in targets
    ]

    sizes = (len(targets), len(members), len(inputs))
    distance = np.reshape(distances, (sizes[1], sizes[2] + 1))
    data: dict[str, Any] = {
        "input_quantile": (
            ("regime", "parameter", "probability"),
            np.reshape(quantiles, (*sizes[1:], len(PROBABILITIES))),
        ),
        "distance": (("regime", "parameter"), distance[:, :-1]),
        "distance_dummy": ("regime", distance[:, -1]),
        "between": ("output", [estimate.value for estimate in split]),
        "between_low": ("output", [estimate.low for estimate in split]),
        "between_high": ("output", [estimate.high for estimate in split]),
    }
    for i, name in enumerate(("rows", "mean", "sd")):
        data[name] = (("output", "regime"), np.reshape(moments, (*sizes[:2], 3))[..., i])
    estimates = [statistic.estimate for statistic in shares.values()]
    data["count"] = (
        "regime",
        np.array([statistic.facts["count"] for statistic in shares.values()], float),
    )
    for name, end in (("share", "value"), ("share_low", "low"), ("share_high", "high")):
        data[name] = ("regime", np.array([getattr(estimate, end) for estimate in estimates]))
    between = boundary(result)
    if between is not None:
        for end, value in zip(("", "_low", "_high"), between.estimate.numbers, strict=True):
            data[f"{EXPONENT}{end}"] = ((), value, {"reason": between.estimate.reason})
    coords = {"regime": list(codes), "parameter": list(inputs), "probability": list(PROBABILITIES)}
    return xr.Dataset(data, {**coords, "output": [target.name for target in targets]})


def _distances(inputs: dict[str, Floats], target: IndexTarget) -> list[float]:
    """Return the distance of each input, and the largest of inputs without effect."""
    try:
        indices = METHODS["regional"].indices(DesignSample.plain(target.values, inputs))
    except RefusedError:
        return [np.nan] * (len(inputs) + 1)
    return [*(index.value for index in indices.values[KS].values()), indices.nulls[KS].limit]


def _quantiles(values: Floats) -> Floats:
    reached = [is_within(probability, len(values)) for probability in PROBABILITIES]
    return np.where(reached, np.quantile(values, PROBABILITIES), np.nan)


def _moments(values: Floats) -> tuple[float, float, float]:
    kept = values[np.isfinite(values)]
    if not len(kept):
        return 0, np.nan, np.nan
    estimates = moments(kept)
    return len(kept), estimates.mean.value, estimates.sd.value
