"""Variance components of outputs: shared by units, own to each unit, due to chance."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.assess.chosen_targets import FEWEST_HITS, few_hits, targets_of
from uq.assess.integrated_inputs import Scales, scales_by_level
from uq.assess.nested_table import SOLVER, SOURCES, LevelShares, shares_of
from uq.assess.statistics.counts import stated_error
from uq.assess.targets import IndexTarget, split_name, transformed_if_heavy
from uq.contract import Floats
from uq.errors import InputError
from uq.indices.index import RefusedError
from uq.result.nesting import Nesting, size_in_words
from uq.result.result import AnyResult, Result
from uq.result.variables import is_error
from uq.sampling.designs import several
from uq.sampling.levels import CHANCE, OWN
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import (
    ImportanceWeights,
    largest_share,
    of_samples,
    quality,
    too_large,
)
from uq.stats.intervals import scattered_share_interval
from uq.stats.tails import lacks_variance
from uq.stats.weighted_means import weighted_share

ONE_REPEAT = "one repeat per unit cannot show switching between regimes; {}"


def switching(
    rows: Result, place: Nesting, varying: Collection[str], weights: Floats | None = None
) -> tuple[Estimate, Floats]:
    """Estimate the probability that a repeat ends in another regime.

    Parameters
    ----------
    rows : Result
        Rows of a result with regimes.
    place : Nesting
        Nesting of these rows.
    varying : collection of str
        The levels on which something varies.
    weights : ndarray, shape (samples,), optional
        Of samples.

    Returns
    -------
    mean : Estimate
        Over all rows; its interval rests on samples. Zero where nothing is random.
    each : ndarray, shape (n,)
        Of each row: the share of the other repeats of its unit that end in another regime. NaN
        without a regime, or another repeat. Where nothing is own to a unit, units are repeats.
    """
    codes = rows.dataset["regime"].values
    if CHANCE not in varying:
        return Estimate(0.0, 0.0, 0.0), np.where(codes >= 0, 0.0, np.nan)
    unit = place.sample * place.units + place.unit if OWN in varying else place.sample
    elsewhere = _elsewhere(unit, codes)
    defined = np.isfinite(elsewhere)
    if not defined.any():
        return Estimate(reason=ONE_REPEAT.format(several("repeats", rows.design_name))), elsewhere
    value, dependence = float(elsewhere[defined].mean()), rows.dependence
    if dependence.samples is None:
        dependence = Dependence(place.sample, samples=place.samples, are_samples=True)
    if weights is not None:
        return weighted_share(
            elsewhere[defined], weights[place.sample[defined]], dependence[defined]
        ), elsewhere
    means = dependence[defined].part_means(elsewhere[defined])
    low, high = scattered_share_interval(
        value, means, rows=int(defined.sum()), samples=dependence.samples
    )
    return Estimate(value, float(low), float(high)), elsewhere


def _elsewhere(unit: NDArray[np.integer], codes: NDArray[np.integer]) -> Floats:
    """Return for each row the share of the other rows of its unit with another code."""
    probabilities = np.full(len(codes), np.nan)
    kept = codes >= 0
    _, place = np.unique(unit[kept], return_inverse=True)
    pairs = place * (int(codes.max(initial=0)) + 1) + codes[kept]
    _, same = np.unique(pairs, return_inverse=True)
    others = np.bincount(place)[place] - 1
    alike = np.bincount(same)[same] - 1
    share = np.divide(others - alike, others, out=np.full(len(place), np.nan), where=others > 0)
    probabilities[kept] = share
    return probabilities


SHARES_OF = "shares are of the variance of the {form}"
NO_ERROR = "the model states no numerical error for it"
NO_ERROR_OF = "the numerical error refers to the output, not to its {form}"


@dataclass(frozen=True)
class ByLevel:
    """Variance components of the targets of a result.

    Attributes
    ----------
    samples, units, repeats : int
    inputs : dict of str to str
        Level of each input.
    outputs : dict of str to LevelShares
        By name of the target: the output, ``log(life)``, ``P(life<t)``.
    another_regime : Estimate or None
        Probability that a repeat ends in another regime; None without regimes.
    switching : ndarray, shape (n,)
        The same probability for each row; NaN if unknown.
    weights : ImportanceWeights or None
        Of samples, where inspections have weighted them.
    """

    samples: int
    units: int
    repeats: int
    inputs: Mapping[str, str]
    outputs: Mapping[str, LevelShares]
    another_regime: Estimate | None
    switching: Floats
    weights: ImportanceWeights | None = None

    @property
    def size(self) -> str:
        """Samples, units and repeats in words."""
        return size_in_words(self.samples, self.units, self.repeats)

    def inputs_on(self, level: str) -> list[str]:
        """Return the inputs on a level."""
        return [name for name, input_level in self.inputs.items() if input_level == level]


def by_level(result: Result, output: str | None = None, *, plain: bool = False) -> ByLevel:
    """Estimate the shares of the variance by level.

    Parameters
    ----------
    result : Result
        A result, or a posterior of `uq.update`.
    output : str, optional
        Only this output, or this element of one; by default those that the study shows. Of a
        category, such as the regime, the targets are ``P(regime=label)``.
    plain : bool
        Whether lives are taken as computed, and nothing that only scales them is integrated.

    Returns
    -------
    ByLevel

    Raises
    ------
    InputError
        When the rows do not follow the laws of the inputs, or there is no such output.
    """
    if why := result.why_no_statistics:
        raise InputError(f"no shares: the rows of a '{result.design_name}' design {why}")
    rows = result.independent
    place, varying = rows.nesting, rows.levels_that_vary()
    worth = rows.sample_weights("shares of levels")
    weights = None if worth is None else of_samples(worth)
    replicate = None if rows.has_independent_samples else place.replicate
    output_names = rows.output_names
    shown = [name for name in rows.shown_outputs(rows.analysis) if not is_error(name, output_names)]
    shares = {}
    for name in shown if output is None else [output]:
        for target in targets_of(rows, name):
            light = target if target.event else transformed_if_heavy(target, SHARES_OF)
            scales = Scales({}) if plain else _scales(rows, light)
            shares[light.name] = _shares(rows, light, place, scales, replicate, weights)
    switches = "regime" in output_names and output is None
    mean, switches_of_samples = (
        switching(rows, place, varying, worth) if switches else (None, np.empty(0))
    )
    size = place.samples, place.units, place.repeats
    return ByLevel(*size, rows.levels, shares, mean, switches_of_samples, weights)


def _scales(rows: Result, target: IndexTarget) -> Scales:
    """Return the inputs integrated exactly: for logarithms of lives, those that only scale them."""
    element = target.element
    if element is None or target.event or target.refused or not element.declared.exponents:
        return Scales({})
    scales = scales_by_level(rows, element)
    if split_name(target.name)[0] == "log" or not scales.inputs:
        return scales
    names = " and ".join(scales.inputs)
    why = f"{names} not integrated: the lives are replaced by their ranks"
    return Scales({}, why, scales.idle)


def _shares(
    rows: Result,
    target: IndexTarget,
    place: Nesting,
    scales: Scales,
    replicate: Any,
    weights: ImportanceWeights | None,
) -> LevelShares:
    reason = target.refused or _why_not_weighted(weights)
    values = scales.mean_logarithms(target.values)
    if not reason and not target.event and lacks_variance(values):
        reason = "the tail is too heavy for a variance to apportion"
    reason, few = _few(rows, target) if target.event and not reason else (reason, ())
    if target.event and not reason:
        reason = _too_few_effective(target.values, place, weights)
    if reason:
        return LevelShares({name: Estimate(reason=reason) for name in SOURCES}, notes=target.notes)
    errors, why_none = _errors(rows, target)
    table = place.table(np.where(np.isfinite(values), values, np.nan))
    error_table = None if errors is None else place.table(errors)
    varying = rows.levels_that_vary((*scales.inputs, *scales.idle))
    variances = {level: place.table(variance) for level, variance in scales.variances.items()}
    worth = None if weights is None else weights.weights
    shares = shares_of(table, varying, error_table, replicate, variances, rows.design_name, worth)
    if errors is None:
        shares = replace(shares, shares={**shares.shares, SOLVER: Estimate(reason=why_none)})
    notes = (*target.notes, *few, *filter(None, [scales.why_not_more]))
    return replace(shares, notes=notes, integrated=scales.inputs)


def _why_not_weighted(weights: ImportanceWeights | None) -> str:
    """Return why weights allow no shares, as they allow no standard deviation, or ""."""
    if weights is None or weights.k == -inf:
        return ""
    return weights.refusal or too_large(largest_share(weights.weights), weights.rows)


def _few(rows: Result, event: IndexTarget) -> tuple[str, tuple[str, ...]]:
    """Return why an event has too few hits for shares, or the warning that it has few."""
    try:
        return "", few_hits(rows, event)
    except RefusedError as refusal:
        return str(refusal), ()


def _too_few_effective(hits: Floats, place: Nesting, weights: ImportanceWeights | None) -> str:
    """Return why an event has too few hits in rows of equal weight, or ""."""
    if weights is None:
        return ""
    defined = np.isfinite(hits)
    share = float(np.average(hits[defined], weights=weights.weights[place.sample[defined]]))
    rows = defined.sum() * weights.effective / weights.rows
    rarer = min(share, 1 - share) * rows
    if not 0 < rarer < FEWEST_HITS:
        return ""  # without any, no two rows differ
    side = "hits" if share < 0.5 else "misses"
    return f"the rows are worth {rarer:.2g} {side} of equal weight, and {FEWEST_HITS} are needed"


def _errors(rows: Result, target: IndexTarget) -> tuple[Floats | None, str]:
    """Return the numerical error of each row, of a logarithm the relative one; or why none."""
    stated = None if target.element is None else stated_error(rows, target.element)
    if stated is None or target.element is None:
        return None, NO_ERROR
    form = split_name(target.name)[0]
    if form == "log":
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.abs(stated.values / target.element.values), ""
    if form:
        return None, NO_ERROR_OF.format(form={"P": "event"}.get(form, form))
    return np.abs(stated.values), ""


def levels(result: AnyResult, output: str | None = None, *, plain: bool = False) -> xr.Dataset:
    """Return the variance components: shared by units, of each unit, of chance and of the solver.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result, or a posterior of `uq.update`, of units never inspected.
    output : str, optional
        Only this output, or this element of one; by default those that the study shows.
    plain : bool, optional
        Whether to take lives as computed; by default what only scales a life is integrated: its
        part of the variance is known exactly, and only that of everything else is estimated.

    Returns
    -------
    xarray.Dataset
        Over ``output`` and ``level`` (``shared``, ``own``, ``chance``, ``solver``): ``share`` of
        the variance, with its 95 % interval ``share_low`` and ``share_high``, and ``reason``, why
        one of them is NaN; ``assumes`` where a share contains another. Over ``output``:
        ``variance`` (the sum of the three components), ``samples_left_out`` and ``integrated``,
        names of inputs separated by spaces. The share of the solver, from ``<output>_error``, is
        contained in the others. Lifetimes are replaced by their logarithms, or by their ranks where
        rows never end or are censored, as is a value with a heavy tail. Of a model with regimes:
        over ``sample``, ``another_regime``, the share of the other repeats of its unit that end in
        another regime; ``another_regime_mean``, with ``_low`` and ``_high``, their mean.

    Raises
    ------
    InputError
        When the rows do not follow the laws of the inputs, or there is no such output.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> float(uq.levels(ds)["share"].sel(level="own")[0])  # every input is a unit's own
    1.0
    """
    result = Result.of(result)
    decomposition = by_level(result, output, plain=plain)
    data: dict[str, Any] = {}
    for name, end in (("share", "value"), ("share_low", "low"), ("share_high", "high")):
        data[name] = _over(decomposition.outputs.values(), end, float)
    for name in ("reason", "assumes"):
        data[name] = _over(decomposition.outputs.values(), name, str)
    data["variance"] = ("output", [target.variance for target in decomposition.outputs.values()])
    data["samples_left_out"] = (
        "output",
        [target.left_out for target in decomposition.outputs.values()],
    )
    integrated = [" ".join(target.integrated) for target in decomposition.outputs.values()]
    data["integrated"] = ("output", np.array(integrated, dtype=str))
    if decomposition.another_regime is not None:
        data["another_regime"] = ("sample", decomposition.switching)
        for end, value in zip(
            ("mean", "low", "high"), decomposition.another_regime.numbers, strict=True
        ):
            data["another_regime_mean" + f"_{end}" * (end != "mean")] = value
    attrs: dict[str, Any] = {
        "samples": decomposition.samples,
        "units_per_sample": decomposition.units,
        "repeats": decomposition.repeats,
    }
    attrs |= quality(decomposition.weights)
    coords = {"output": list(decomposition.outputs), "level": list(SOURCES)}
    return xr.Dataset(data, coords, attrs)


def _over(outputs: Any, name: str, kind: type) -> tuple[tuple[str, str], Any]:
    cells = [[getattr(target.shares[source], name) for source in SOURCES] for target in outputs]
    return ("output", "level"), np.array(cells, dtype=kind).reshape(-1, len(SOURCES))
