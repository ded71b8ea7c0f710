"""Two studies of one model: what was changed, and how far their outputs lie apart."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from uq import json_form, two_samples
from uq.analysis.b_lives import B_LIVES
from uq.analysis.input_changes import changes, only_change, spread
from uq.analysis.pairing import MEAN, SD, SHARE, Estimator, Pair, Sample, quantile
from uq.analysis.statistics import event, summarise
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

Entry = dict[str, Any]
_ENDS = ("value", "low", "high")


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
    entries = {("regime", label): entry for label, entry in found["regime"].items()}
    for name, output in found["outputs"].items():
        entries |= {(name, label): entry for label, entry in estimates_of(output)}
    lines = [
        [entry["a"]["value"], entry["b"]["value"], *(entry["difference"][end] for end in _ENDS)]
        for entry in entries.values()
    ]
    columns = ["first", "second", "difference", "low", "high"]
    index = pd.MultiIndex.from_tuples(list(entries), names=["output", "estimate"])
    return pd.DataFrame(lines, index, columns, dtype=float)


def estimates_of(output: Mapping[str, Any]) -> Iterator[tuple[str, Entry]]:
    """Yield label and entry of every estimate of one output of `comparison`."""
    yield "mean", output["mean"]
    yield "sd", output["sd"]
    for probability, entry in output["quantiles"].items():
        yield f"quantile {probability}", entry
    yield from output["b_lives"].items()
    for threshold, sides in output["thresholds"].items():
        yield f"P(>{threshold})", sides["above"]
        yield f"P(<{threshold})", sides["below"]


def comparison(first: xr.Dataset, second: xr.Dataset) -> dict[str, Any]:
    """Return what `compare` finds, and what was changed, in plain data, ready for JSON.

    Returns
    -------
    dict
        ``a`` and ``b``: title, samples, rows_used and status of each. ``changed``: kind, name, a
        and b of each entry that differs. ``only``: the one input that differs, if it is the only
        thing: name, units, and mean and sd of each; else None. ``pairing``: ``rows``,
        ``replicates``, ``strangers`` or ``unknown``. ``regime``: label -> estimate; ``outputs``:
        element -> ``mean``, ``sd``, ``quantiles``, ``b_lives``, ``thresholds``, where an estimate
        is ``a`` and ``b``, as `uq.analysis.statistics.summarise` has them, and ``difference``:
        ``value``, ``low``, ``high`` of b less a, and ``identical`` where the rows are pairs and
        both of each say the same: then there is no interval; that of sd also has ``ratio``.
        ``notes``: sentences.
    """
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
    common = [name for name in elements[0] if name in elements[1]]
    changed = changes(*results)
    name = only_change(changed)
    return {
        **{
            key: {"title": str(ds.attrs["title"])}
            | {part: one[part] for part in ("samples", "rows_used", "status")}
            for key, ds, one in zip("ab", results, found, strict=True)
        },
        "changed": [
            {"kind": one.kind, "name": one.name, "a": one.first, "b": one.second} for one in changed
        ],
        "only": None if name is None else _only(results, name),
        "pairing": pair.kinship.name.lower().removesuffix("_imported"),
        "regime": dict(_regimes(pair, [one["regime"] for one in found])),
        "outputs": {
            name: _compared(
                pair, [one[name] for one in elements], [one["outputs"][name] for one in found]
            )
            for name in common
        },
        "notes": list(_notes(pair, found, elements)),
    }


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


def _only(results: tuple[xr.Dataset, ...], name: str) -> Entry:
    spreads = [spread(ds, name) for ds in results]
    means, sds = zip(*spreads, strict=True)
    return {
        "name": name,
        "units": results[0][name].attrs["units"],
        "mean": dict(zip("ab", means, strict=True)),
        "sd": dict(zip("ab", sds, strict=True)),
    }


def _regimes(pair: Pair, shares: list[dict[str, Entry]]) -> Iterator[tuple[str, Entry]]:
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
            entries = [{**one[label], "value": one[label]["share"]} for one in shares]
            yield label, _estimate(pair, SHARE, samples, entries)


def _compared(pair: Pair, elements: list[Element], entries: list[Entry]) -> Entry:
    present = [
        Sample(element.present, np.where(element.censored, np.inf, element.values))
        for element in elements
    ]
    whole = _whole(elements)
    means = [{"value": entry["mean"], **entry["mean_interval"]} for entry in entries]

    def each(part: str, estimator_of: Callable[[str], Estimator]) -> Entry:
        return {
            key: _estimate(
                pair, estimator_of(key), present, [entry[part][key] for entry in entries], whole
            )
            for key in entries[0][part]
        }

    return {
        "units": elements[0].units,
        "mean": _without_refused(_estimate(pair, MEAN, present, means), "mean", entries),
        "sd": _without_refused(_sds(pair, present, entries), "sd", entries),
        "quantiles": each("quantiles", lambda probability: quantile(float(probability))),
        "b_lives": each("b_lives", lambda name: quantile(B_LIVES[name])),
        "thresholds": {
            threshold: _sides(
                pair, elements, float(threshold), [one["thresholds"][threshold] for one in entries]
            )
            for threshold in entries[0]["thresholds"]
        },
    }


def _without_refused(found: Entry, moment: str, entries: list[Entry]) -> Entry:
    """Take out the intervals of what the tail of one of the two forbids."""
    if any(f"{moment}_interval" in entry["reasons"] for entry in entries):
        for key in found.keys() - {"a", "b"}:
            found[key] = found[key] | {"low": None, "high": None}
    return found


def _sds(pair: Pair, samples: list[Sample], entries: list[Entry]) -> Entry:
    sds = [{"value": entry["sd"], **entry["sd_interval"]} for entry in entries]
    sides = dict(zip("ab", sds, strict=True))
    if any(entry["sd"] is None for entry in entries):
        nothing = dict.fromkeys(_ENDS)
        return {**sides, "difference": nothing, "ratio": nothing}
    known = [_known(entry) for entry in sds]
    if pair.identical(samples):
        same = {"low": None, "high": None, "identical": True}
        return {**sides, "difference": {"value": 0.0} | same, "ratio": {"value": 1.0} | same}
    return {
        **sides,
        "difference": json_form.numbers(pair.difference(SD, samples, known)),
        "ratio": json_form.numbers(pair.ratio(samples, known)),
    }


def _sides(pair: Pair, elements: list[Element], threshold: float, entries: list[Entry]) -> Entry:
    found = {}
    events = [event(element, threshold) for element in elements]
    for i, side in enumerate(("above", "below")):
        samples = [
            Sample(~element.failed, sides[i].astype(float))
            for element, sides in zip(elements, events, strict=True)
            if sides is not None
        ]
        told = [_side(entry, side) for entry in entries]
        rows = _whole(elements) if len(samples) < len(elements) else samples
        found[side] = _estimate(pair, SHARE, samples, told, rows)
    return found


def _side(entry: Entry, side: str) -> Entry:
    """Return the share on one side of a threshold, after Kaplan and Meier where that is all."""
    if "kaplan_meier" not in entry:
        return dict(entry[side])
    found = entry["kaplan_meier"]
    return found[side] | {"assumes": found["assumes"]}


def _whole(elements: list[Element]) -> list[Sample]:
    """Return all that is known of each row: its value, and whether it is only a lower bound."""
    return [
        Sample(element.present, np.column_stack([element.values, element.censored]))
        for element in elements
    ]


def _estimate(
    pair: Pair,
    estimator: Estimator,
    samples: list[Sample],
    entries: list[Entry],
    rows: list[Sample] | None = None,
) -> Entry:
    """Compare two estimates; `rows` say whether the pairs are identical, if not the samples."""
    known = [_known(entry) for entry in entries]
    if pair.identical(samples if rows is None else rows) and not np.isnan(known[0].value):
        difference = {"value": 0.0, "low": None, "high": None, "identical": True}
        return {**dict(zip("ab", entries, strict=True)), "difference": difference}
    if any(np.isnan(one.value) for one in known):
        apart = NOTHING
    elif any("assumes" in entry for entry in entries):  # not a plain quantile of the rows
        apart = two_samples.difference(known[0], known[1], pair.unpaired)
    else:
        apart = pair.difference(estimator, samples, known)
    return {**dict(zip("ab", entries, strict=True)), "difference": json_form.numbers(apart)}


def _known(entry: Entry) -> Estimate:
    value, low, high = (np.nan if entry[end] is None else entry[end] for end in _ENDS)
    return Estimate(value, low, high)


def _notes(
    pair: Pair, found: list[dict[str, Any]], elements: list[dict[str, Element]]
) -> Iterator[str]:
    yield pair.kinship.value
    for which, one in zip("AB", found, strict=True):
        yield from (f"{which}: {note}" for note in one["notes"])
    if any(output["failed"] for one in found for output in one["outputs"].values()):
        yield "differences are of the rows that did not fail"
    of_a, of_b = elements
    for which, mine, other in (("A", of_a, of_b), ("B", of_b, of_a)):
        if alone := [name for name in mine if name not in other]:
            yield f"only {which} has {', '.join(alone)}"
