"""Compare two studies of one model: their inputs, and the differences of their statistics."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from math import isnan

import numpy as np
import pandas as pd

from uq.assess.input_changes import ChangedEntry, OnlyChange, changes, only_change
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.pairing import Pair
from uq.assess.sample import SelectedRows, in_categories, value_and_censoring
from uq.assess.statistic import Reader, Statistic
from uq.assess.summary import REGIME, Shares, Summary, summarise
from uq.assess.weighted_mixture import as_sample
from uq.contract import Floats, Output
from uq.errors import InputError
from uq.result.element import Element
from uq.result.result import AnyResult, Result
from uq.stats.estimate import NOTHING, Estimate, difference
from uq.study.file import AnalysisTable
from uq.text.units import ReadableUnit, typical, unit_of


@dataclass(frozen=True)
class ComparedStatistic:
    """A statistic of two results.

    Attributes
    ----------
    first, second : Statistic
    difference : Estimate
        The second less the first.
    identical : bool
        Whether the rows are paired and both rows of each pair agree: then there is no interval.
    no_row_changes_sides : bool
        Whether the rows are paired and differ, but none is a hit in one result alone.
    ratio : Estimate, optional
        The second over the first, for a scale.
    """

    first: Statistic
    second: Statistic
    difference: Estimate
    identical: bool = False
    no_row_changes_sides: bool = False
    ratio: Estimate | None = None


@dataclass(frozen=True)
class ComparedOutput:
    """An element of an output: name in the table of statistics -> compared statistics."""

    declared: Output
    parts: Mapping[str, tuple[ComparedStatistic, ...]]

    @property
    def units(self) -> str:
        """CF unit string."""
        return self.declared.unit

    @property
    def readable_unit(self) -> ReadableUnit:
        """The unit in which its values are shown, from the size of its first quantiles."""
        quantiles = self.parts.get("quantiles", ())
        return unit_of(self.units, typical(pair.first.estimate.value for pair in quantiles))

    @property
    def statistics(self) -> tuple[ComparedStatistic, ...]:
        """All of them in order."""
        return tuple(chain.from_iterable(self.parts.values()))


def compared_shares(
    pair: Pair, summaries: list[Summary]
) -> dict[str, dict[str, ComparedStatistic]]:
    """Return category -> label -> compared share: all regimes, else the labels that occur."""
    names = [name for name in summaries[0].shares if name in summaries[1].shares]
    return {
        name: dict(_shares(pair, [summary.shares[name] for summary in summaries], name))
        for name in names
    }


def _shares(pair: Pair, shares: list[Shares], name: str) -> Iterator[tuple[str, ComparedStatistic]]:
    members = [in_categories(rows, name) for rows in pair.rows]
    for label in shares[0]:
        both = [of_labels[label] for of_labels in shares if label in of_labels]
        occurs = name == REGIME or any(statistic.facts["count"] for statistic in both)
        if len(both) > 1 and occurs:
            samples = [members_of_side[label] for members_of_side in members]
            yield label, _compared(pair, both, samples, pair.have_equal_outputs)


def compared_output(
    pair: Pair, elements: list[Element], summaries: list[Summary]
) -> ComparedOutput:
    """Compare all statistics of the same element of two results."""
    described = [summary.outputs[elements[0].name] for summary in summaries]
    parts = {
        name: tuple(
            _of_elements(pair, elements, [statistic, other])
            for statistic in statistics
            if statistic.is_read_by(Reader.COMPARED)
            and (other := described[1].find(*statistic.key)) is not None
        )
        for name, statistics in described[0].parts.items()
    }
    return ComparedOutput(elements[0].declared, parts)


def _of_elements(pair: Pair, elements: list[Element], both: list[Statistic]) -> ComparedStatistic:
    """Compare a statistic of the same element of two results."""
    estimator = both[0].estimator
    samples = [] if estimator is None else [estimator.sample(element) for element in elements]
    present = [sample for sample in samples if sample is not None]
    are_equal = pair.are_equal([value_and_censoring(element) for element in elements])
    return _compared(pair, [statistic.best for statistic in both], present, are_equal)


def _compared(
    pair: Pair, both: list[Statistic], samples: list[SelectedRows], are_equal: bool
) -> ComparedStatistic:
    """Compare two statistics of paired rows that are equal in both results, or of others."""
    estimator = both[0].estimator
    is_scale = estimator is not None and estimator.is_scale
    estimates = [statistic.estimate.finite for statistic in both]
    if any(isnan(estimate.value) for estimate in estimates):
        return ComparedStatistic(both[0], both[1], NOTHING, ratio=NOTHING if is_scale else None)
    if are_equal:
        ratio = Estimate(1.0) if is_scale else None
        return ComparedStatistic(both[0], both[1], Estimate(0.0), identical=True, ratio=ratio)
    if estimator is not None and estimator.counts_hits and pair.are_equal(samples):
        most = pair.most_that_change_sides(samples[0])
        apart = Estimate(0.0, -most, most)
        return ComparedStatistic(both[0], both[1], apart, no_row_changes_sides=True)
    if estimator is None or any(statistic.estimate.assumes for statistic in both):
        apart = difference(estimates[0], estimates[1], pair.unpaired)
    else:
        apart = pair.difference(estimator, samples, estimates)
    times = pair.ratio(samples, estimates) if is_scale else None
    if any(
        estimate.reason for estimate in estimates
    ):  # without an interval its difference has none
        apart, times = Estimate(apart.value), times and Estimate(times.value)
    return ComparedStatistic(both[0], both[1], apart.finite, ratio=times and times.finite)


@dataclass(frozen=True)
class Side:
    """One of two results: its title and the summary that both studies ask for."""

    title: str
    summary: Summary


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The comparison of two results.

    Attributes
    ----------
    first, second : Side
    changed : list of ChangedEntry
        Differences between the studies.
    only : OnlyChange, optional
        The input that differs, if nothing else does.
    pairing : str
        ``rows`` or ``replicates`` where these are paired by number, ``strangers`` where the samples
        are independent, else ``unknown``.
    shares : dict of str to dict
        Category, such as the regime -> label -> `ComparedStatistic`.
    outputs : dict of str to ComparedOutput
    notes : list of str
    curves : dict of str to SurvivalCurves
        Of each lifetime, where one result has lives from the field.
    """

    first: Side
    second: Side
    changed: list[ChangedEntry]
    only: OnlyChange | None
    pairing: str
    shares: Mapping[str, Mapping[str, ComparedStatistic]]
    outputs: Mapping[str, ComparedOutput]
    notes: list[str]
    curves: Mapping[str, "SurvivalCurves"]


@dataclass(frozen=True)
class SurvivalCurves:
    """Survival probabilities of one lifetime in two results, and their differences, at times."""

    time: Floats
    first: tuple[Estimate, ...]
    second: tuple[Estimate, ...]
    differences: tuple[Estimate, ...]


def compare(first: AnyResult, second: AnyResult, output: str | None = None) -> pd.DataFrame:
    """Compare the outputs of two studies of one model.

    Parameters
    ----------
    first, second : Result, xarray.Dataset or path
        Results.
    output : str, optional
        Where one result has lives from the field: the lifetime of the other to compare them with,
        such as ``first_time_to_depth[depth=0.00025]``; by default the one of the same name, or the
        only one.

    Returns
    -------
    pandas.DataFrame
        Index: ``output`` (its element, or a category such as ``regime``), ``estimate`` (``mean``,
        ``sd``, ``quantile 0.5``, ``B10``, ``P(>t)``, ``P(<t)``, or a label). Columns:
        ``first`` and ``second``, the estimates; ``difference``, the second less the first, with
        its 95 % interval ``low``, ``high``. NaN where there is none.

    Raises
    ------
    InputError
        When the two are not of one model, or have nothing to compare.
    """
    first = Result.of(first)
    second = Result.of(second)
    compared = comparison(first, second, output)
    pairs = {
        (name, label): statistic
        for name, statistics in compared.shares.items()
        for label, statistic in statistics.items()
    }
    for name, of_output in compared.outputs.items():
        pairs |= {(name, statistic.first.label): statistic for statistic in of_output.statistics}
    lines = [
        [
            *(side.estimate.finite.value for side in (statistic.first, statistic.second)),
            *statistic.difference.numbers,
        ]
        for statistic in pairs.values()
    ]
    columns = ["first", "second", "difference", "low", "high"]
    index = pd.MultiIndex.from_tuples(list(pairs), names=["output", "estimate"])
    return pd.DataFrame(lines, index, columns, dtype=float)


def comparison(first: Result, second: Result, output: str | None = None) -> Comparison:
    """Return the differences of `compare` and the changes of the study."""
    is_record = first.is_field_record, second.is_field_record
    if is_record == (True, False):
        first = _named_as(first, second, output)
    elif is_record == (False, True):
        second = _named_as(second, first, output)
    elif output is not None:
        raise InputError("--output: only where one result has lives from the field; leave it out")
    _refuse(first, second)
    results = (first, second)
    analyses = [result.analysis for result in results]
    outputs = _outputs(results, analyses)
    asked = _asked(analyses, outputs)
    summaries = [summarise(result, asked) for result in results]
    pair = Pair(first, second)
    elements = [
        {element.name: element for element in elements_with_laws(rows, outputs)}
        for rows in pair.rows
    ]
    changed = [] if any(is_record) else changes(*results)
    only = None if any(is_record) else only_change(first, second, changed)
    lives = [name for name, element in elements[0].items() if element.is_lifetime]
    return Comparison(
        first=Side(str(first.dataset.attrs["title"]), summaries[0]),
        second=Side(str(second.dataset.attrs["title"]), summaries[1]),
        changed=changed,
        only=only,
        pairing=pair.pairing.name.lower().partition("_")[0],
        shares=compared_shares(pair, summaries),
        outputs={
            name: compared_output(pair, [by_name[name] for by_name in elements], summaries)
            for name in elements[0]
            if name in elements[1]
        },
        notes=list(_notes(pair, summaries, elements)),
        curves={
            name: _curves(pair, [by_name[name] for by_name in elements])
            for name in lives
            if any(is_record) and name in elements[1]
        },
    )


def _curves(pair: Pair, elements: list[Element]) -> SurvivalCurves:
    """Return both survival curves at the times of either, up to the last time of both."""
    samples = [
        as_sample(element, rows.dependence)
        for element, rows in zip(elements, pair.rows, strict=True)
    ]
    times = [sample.times for sample in samples]
    every = np.unique(np.concatenate(times))
    last = min((of_one.max() for of_one in times if len(of_one)), default=0.0)
    every = every[(every > 0) & (every <= last)]
    if len(every) > _MOST_TIMES:
        every = every[np.linspace(0, len(every) - 1, _MOST_TIMES).round().astype(int)]
    both = [
        tuple(
            Estimate(float(value), float(low), float(high))
            for value, low, high in zip(*sample.survival(every), strict=True)
        )
        for sample in samples
    ]
    apart = tuple(
        difference(first, second, pair.unpaired) for first, second in zip(*both, strict=True)
    )
    return SurvivalCurves(every, both[0], both[1], apart)


def _named_as(record: Result, other: Result, output: str | None) -> Result:
    """Return lives from the field under the name and place of a lifetime of a simulated study."""
    mine, element = record.recorded_life.name, other.lifetime_like(record, output, "--output")
    ds = record.dataset
    companions = {name: name.replace(mine, element.output, 1) for name in map(str, ds.data_vars)}
    renamed = {
        name: new
        for name, new in companions.items()
        if name == mine or (name.startswith(f"{mine}_") and ds[name].attrs.get("role") != "input")
    }
    taken = [name for name in renamed.values() if name in ds and name not in renamed]
    ds = ds.drop_vars(taken).rename(renamed)
    for name in renamed.values():
        for i, (dim, label) in enumerate(element.place.items()):
            ds[name] = ds[name].expand_dims({dim: [label]}, axis=i + 1)
    declared = other.dataset[element.output].attrs
    for key in ("long_name", "success"):
        if key in declared:
            ds[element.output].attrs[key] = declared[key]
    return Result(ds)


_MOST_TIMES = 40  # of compared survival curves


def _refuse(first: Result, second: Result) -> None:
    names = [result.dataset.attrs["model"] for result in (first, second)]
    if names[0] != names[1] and not (first.is_field_record or second.is_field_record):
        raise InputError(
            f"the first is of model '{names[0]}', the second of '{names[1]}': only studies of the"
            " same model can be compared"
        )
    for which, result in zip(("first", "second"), (first, second), strict=True):
        if why := result.why_no_statistics:
            raise InputError(
                f"the rows of the {which}, a '{result.design_name}' design, {why}: compare studies"
                " with another design; 'uq sensitivity' shows its indices"
            )


def _outputs(results: tuple[Result, ...], analyses: list[AnalysisTable]) -> list[str]:
    wanted = dict.fromkeys(
        name
        for result, analysis in zip(results, analyses, strict=True)
        for name in result.shown_outputs(analysis)
    )
    outputs = [name for name in wanted if all(name in result.outputs for result in results)]
    if not outputs:
        raise InputError(
            "the results have no output in common; name one in [analysis] outputs of both studies"
        )
    return outputs


def _asked(analyses: list[AnalysisTable], outputs: list[str]) -> AnalysisTable:
    """Return the union of the analyses of both studies."""

    def both(*parts: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(sorted({number for part in parts for number in part}))

    thresholds = {
        name: both(*(analysis.thresholds.get(name, ()) for analysis in analyses))
        for name in outputs
        if any(name in analysis.thresholds for analysis in analyses)
    }
    quantiles = both(*(analysis.quantiles for analysis in analyses))
    asked = {"outputs": tuple(outputs), "quantiles": quantiles, "thresholds": thresholds}
    return AnalysisTable().model_copy(update=asked)


def _notes(
    pair: Pair, summaries: list[Summary], elements: list[dict[str, Element]]
) -> Iterator[str]:
    yield pair.pairing.value
    for which, summary in zip("AB", summaries, strict=True):
        yield from (f"{which}: {note}" for note in summary.notes)
    if any(summary.most_failed for summary in summaries):
        yield "Differences are between the valid rows."
    for which, mine, other in zip("AB", elements, elements[::-1], strict=True):
        if alone := [name for name in mine if name not in other]:
            yield f"Only {which} has {', '.join(alone)}."
