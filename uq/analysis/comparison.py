"""Two studies of one model: what was changed, and how far their outputs lie apart."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from math import isnan

import pandas as pd
import xarray as xr

from uq import two_samples
from uq.analysis import estimators
from uq.analysis.estimators import Sample
from uq.analysis.input_changes import Change, Spread, changes, only_change, spread
from uq.analysis.pairing import Pair
from uq.analysis.statistics.statistic import COMPARED, Statistic
from uq.analysis.summary import Summary, summarise
from uq.contract import Status
from uq.errors import InputError
from uq.estimate import NOTHING, Estimate
from uq.rows.elements import (
    Element,
    analysis_of,
    elements_of,
    flags,
    output_names,
    shown_outputs,
    why_no_statistics,
)
from uq.study.file import AnalysisTable


@dataclass(frozen=True)
class Side:
    """One of two results: its title, and its summary of what either study asks for."""

    title: str
    summary: Summary


@dataclass(frozen=True)
class OnlyChange:
    """The one input that two studies have different, with its spread in each."""

    name: str
    units: str
    first: Spread
    second: Spread


@dataclass(frozen=True)
class Compared:
    """A statistic of two results.

    Attributes
    ----------
    first, second : Statistic
    difference : Estimate
        The second less the first.
    identical : bool
        Whether the rows are pairs, and both of each say the same: then there is no interval.
    ratio : Estimate, optional
        The second over the first, of a scale.
    """

    first: Statistic
    second: Statistic
    difference: Estimate
    identical: bool = False
    ratio: Estimate | None = None


@dataclass(frozen=True)
class ComparedOutput:
    """An element of an output: name in the table of statistics -> what is compared of it."""

    units: str
    parts: Mapping[str, tuple[Compared, ...]]

    @property
    def statistics(self) -> tuple[Compared, ...]:
        """All of them in order."""
        return tuple(chain.from_iterable(self.parts.values()))


@dataclass(frozen=True)
class Comparison:
    """Two results held against each other.

    Attributes
    ----------
    first, second : Side
    changed : list of Change
        What the studies have different.
    only : OnlyChange, optional
        The one input that differs, if it is the only thing.
    pairing : str
        ``rows``, ``replicates``, ``strangers`` or ``unknown``.
    regimes : dict of str to Compared
    outputs : dict of str to ComparedOutput
    notes : list of str
    """

    first: Side
    second: Side
    changed: list[Change]
    only: OnlyChange | None
    pairing: str
    regimes: Mapping[str, Compared]
    outputs: Mapping[str, ComparedOutput]
    notes: list[str]


def compare(first: xr.Dataset, second: xr.Dataset) -> pd.DataFrame:
    """Compare the outputs of two studies of one model.

    Parameters
    ----------
    first, second : xarray.Dataset
        Results.

    Returns
    -------
    pandas.DataFrame
        Index: ``output`` (its element, or ``regime``), ``estimate`` (``mean``, ``sd``,
        ``quantile 0.5``, ``B10``, ``P(>t)``, ``P(<t)``, or the label of a regime). Columns:
        ``first`` and ``second``, the estimates; ``difference``, the second less the first, with
        its 95 % interval ``low``, ``high``. NaN where there is none.

    Raises
    ------
    InputError
        When the two are not of one model, or have nothing to compare.
    """
    found = comparison(first, second)
    pairs = {("regime", label): one for label, one in found.regimes.items()}
    for name, output in found.outputs.items():
        pairs |= {(name, one.first.label): one for one in output.statistics}
    lines = [
        [*(side.estimate.finite.value for side in (one.first, one.second)), *one.difference.numbers]
        for one in pairs.values()
    ]
    columns = ["first", "second", "difference", "low", "high"]
    index = pd.MultiIndex.from_tuples(list(pairs), names=["output", "estimate"])
    return pd.DataFrame(lines, index, columns, dtype=float)


def comparison(first: xr.Dataset, second: xr.Dataset) -> Comparison:
    """Return what `compare` finds, and what was changed."""
    _refuse(first, second)
    results = (first, second)
    analyses = [analysis_of(ds) for ds in results]
    outputs = _outputs(results, analyses)
    asked = _asked(analyses, outputs)
    found = [summarise(ds, asked) for ds in results]
    pair = Pair(first, second)
    elements = [
        {element.name: element for element in elements_of(rows, outputs)} for rows in pair.rows
    ]
    changed = changes(*results)
    return Comparison(
        Side(str(first.attrs["title"]), found[0]),
        Side(str(second.attrs["title"]), found[1]),
        changed,
        _only(results, only_change(changed)),
        pair.kinship.name.lower().removesuffix("_imported"),
        dict(_regimes(pair, found)),
        {
            name: _output(pair, [one[name] for one in elements], found)
            for name in elements[0]
            if name in elements[1]
        },
        list(_notes(pair, found, elements)),
    )


def _refuse(first: xr.Dataset, second: xr.Dataset) -> None:
    names = [ds.attrs["model"] for ds in (first, second)]
    if names[0] != names[1]:
        raise InputError(
            f"the first is of model '{names[0]}', the second of '{names[1]}': only studies of one"
            " model can be compared"
        )
    for which, ds in zip(("first", "second"), (first, second), strict=True):
        if why := why_no_statistics(ds):
            raise InputError(
                f"the rows of the {which}, a '{ds.attrs['design']}' design, {why}: compare studies"
                " of another design; 'uq sensitivity' shows its indices"
            )


def _outputs(results: tuple[xr.Dataset, ...], analyses: list[AnalysisTable]) -> list[str]:
    wanted = dict.fromkeys(
        name for ds, one in zip(results, analyses, strict=True) for name in shown_outputs(ds, one)
    )
    outputs = [name for name in wanted if all(name in output_names(ds) for ds in results)]
    if not outputs:
        raise InputError(
            "the two results have no output in common; name one in [analysis] outputs of both"
        )
    return outputs


def _asked(analyses: list[AnalysisTable], outputs: list[str]) -> AnalysisTable:
    """Return what either of two studies asks for."""

    def both(*parts: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(sorted({number for part in parts for number in part}))

    thresholds = {
        name: both(*(one.thresholds.get(name, ()) for one in analyses))
        for name in outputs
        if any(name in one.thresholds for one in analyses)
    }
    quantiles = both(*(one.quantiles for one in analyses))
    asked = {"outputs": tuple(outputs), "quantiles": quantiles, "thresholds": thresholds}
    return AnalysisTable().model_copy(update=asked)


def _only(results: tuple[xr.Dataset, ...], name: str | None) -> OnlyChange | None:
    if name is None:
        return None
    units = str(results[0][name].attrs["units"])
    return OnlyChange(name, units, *(spread(ds, name) for ds in results))


def _regimes(pair: Pair, found: list[Summary]) -> Iterator[tuple[str, Compared]]:
    shares = [one.regimes for one in found]
    if not all(shares):
        return
    codes = [rows["regime"].values for rows in pair.rows]
    kept = [
        (code >= 0) | (rows["status"].values == Status.OK)
        for code, rows in zip(codes, pair.rows, strict=True)
    ]
    numbers = [{label: n for n, label in flags(rows["regime"])} for rows in pair.rows]
    for label in shares[0]:
        if label in shares[1]:
            samples = [
                Sample(mask, (code == number[label]).astype(float))
                for mask, code, number in zip(kept, codes, numbers, strict=True)
            ]
            both = [replace(one[label], estimator=estimators.share()) for one in shares]
            yield label, _compared(pair, both, samples, samples)


def _output(pair: Pair, elements: list[Element], found: list[Summary]) -> ComparedOutput:
    described = [one.outputs[elements[0].name] for one in found]
    parts = {
        name: tuple(
            _of_elements(pair, elements, [one, other])
            for one in statistics
            if one.is_read_by(COMPARED) and (other := described[1].find(*one.key)) is not None
        )
        for name, statistics in described[0].parts.items()
    }
    return ComparedOutput(elements[0].units, parts)


def _of_elements(pair: Pair, elements: list[Element], both: list[Statistic]) -> Compared:
    """Compare a statistic of the same element of two results."""
    estimator = both[0].estimator
    samples = [] if estimator is None else [estimator.sample(element) for element in elements]
    known = [one for one in samples if one is not None]
    told_by_rows = estimator is not None and estimator.counts_hits and len(known) == 2
    rows = known if told_by_rows else [estimators.whole(element) for element in elements]
    return _compared(pair, [one.best for one in both], known, rows)


def _compared(
    pair: Pair, both: list[Statistic], samples: list[Sample], rows: list[Sample]
) -> Compared:
    """Compare two statistics; `rows` say whether the pairs are identical."""
    estimator = both[0].estimator
    is_scale = estimator is not None and estimator.is_scale
    known = [one.estimate.finite for one in both]
    if any(isnan(one.value) for one in known):
        return Compared(both[0], both[1], NOTHING, ratio=NOTHING if is_scale else None)
    if pair.identical(rows):
        return Compared(both[0], both[1], Estimate(0.0), True, Estimate(1.0) if is_scale else None)
    if estimator is None or any(one.estimate.assumes for one in both):
        apart = two_samples.difference(known[0], known[1], pair.unpaired)
    else:
        apart = pair.difference(estimator, samples, known)
    times = pair.ratio(samples, known) if is_scale else None
    if any(one.reason for one in known):  # what has no interval has none for its difference
        apart, times = Estimate(apart.value), times and Estimate(times.value)
    return Compared(both[0], both[1], apart.finite, ratio=times and times.finite)


def _notes(pair: Pair, found: list[Summary], elements: list[dict[str, Element]]) -> Iterator[str]:
    yield pair.kinship.value
    for which, one in zip("AB", found, strict=True):
        yield from (f"{which}: {note}" for note in one.notes)
    if any(one.most_failed for one in found):
        yield "differences are of the rows that did not fail"
    of_a, of_b = elements
    for which, mine, other in (("A", of_a, of_b), ("B", of_b, of_a)):
        if alone := [name for name in mine if name not in other]:
            yield f"only {which} has {', '.join(alone)}"
