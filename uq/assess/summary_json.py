"""Summaries and comparisons as JSON."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from math import isfinite
from typing import TYPE_CHECKING, Any

from uq.assess.input_changes import InputMoments, OnlyChange
from uq.assess.life_fit import Fit
from uq.assess.statistic import Reader, Statistic
from uq.assess.statistics.table import EMPTY, JSON_ORDER
from uq.assess.summary import REGIME, Described, Shares, Summary, share_json
from uq.stats import estimate_json
from uq.stats.importance_weights import Smoothed, quality

if TYPE_CHECKING:
    from uq.assess.comparison import Comparison, Side
    from uq.assess.differences import ComparedOutput, ComparedStatistic
    from uq.assess.level_shares import ByLevel
    from uq.assess.running_estimates import Converging
    from uq.assess.two_fidelities import Sharpened, TwoFidelities
    from uq.assess.variance_by_level import LevelShares


def summary_json(summary: Summary) -> dict[str, Any]:
    """Return a summary in plain data.

    Returns
    -------
    dict
        ``samples`` and ``status`` count all rows. Everything else describes the ``rows_used``, the
        independent ones: ``regime`` (label -> count and share with interval), ``categories`` (the
        same of other categories, such as the period, where they occur), ``outputs`` (name of
        element -> its statistics, each under its key) and ``notes``, sentences on what is missing.
        A number that does not exist or is not finite is None; beside it ``never``,
        ``low_censored`` and the like state why. Where rows failed, ``failed_low`` and
        ``failed_high`` bound an estimate (`uq.assess.failed_rows`). ``fits``, if asked for: the
        laws fitted to a lifetime. Where inspections have weighted the rows: ``effective_rows`` and
        ``pareto_k``.
    """
    return quality_json(summary.weights) | {
        "samples": summary.samples,
        "rows_used": summary.rows_used,
        "status": summary.status,
        "regime": _labels(summary.regimes),
        "categories": {name: _labels(shares) for name, shares in summary.categories.items()},
        "outputs": {name: _described(described) for name, described in summary.outputs.items()},
        "notes": summary.notes,
    }


def _labels(shares: Shares) -> dict[str, Any]:
    return {label: share_json(statistic) for label, statistic in shares.items()}


def quality_json(weights: Smoothed | None) -> dict[str, Any]:
    """Return effective sample size and tail shape of weights in plain data."""
    return {name: estimate_json.number(number) for name, number in quality(weights).items()}


def _described(described: Described) -> dict[str, Any]:
    document: dict[str, Any] = {"units": described.units}
    for name in dict.fromkeys((*JSON_ORDER, *described.parts)):
        statistics = [s for s in described.parts[name] if s.is_read_by(Reader.JSON)]
        if name in EMPTY:
            document[name] = {} if statistics else EMPTY[name]
        for parent, _, entry in written(statistics):
            put(document, parent, entry)
    fits = {law: _fit(fit) for law, fit in described.fits.items()}
    return document | ({"fits": fits} if fits else {})


def written(
    statistics: Iterable[Statistic],
) -> Iterator[tuple[tuple[str, ...], list[Statistic], dict[str, Any]]]:
    """Yield path, statistics and JSON of each group of statistics with one entry."""
    for (parent, _), group in groupby(statistics, lambda s: (s.key[:-1], s.kind.write)):
        members = list(group)
        yield parent, members, members[0].kind.write(members)


def _fit(fit: Fit) -> dict[str, Any]:
    entry: dict[str, Any] = {"rows": fit.rows}
    if isfinite(fit.p_value):
        entry["p_value"] = fit.p_value
    if fit.refused:
        return entry | {"refused": fit.refused}
    entry["parameters"] = {
        name: estimate_json.numbers(estimate) for name, estimate in fit.parameters.items()
    }
    entry["assumes"] = fit.assumes
    for name, estimate in fit.b_lives.items():
        entry[name] = estimate_json.numbers(estimate) | {"extrapolated": name in fit.extrapolated}
    return entry


def put(document: dict[str, Any], path: Iterable[str], entry: dict[str, Any]) -> None:
    """Merge an entry into JSON at a path, creating the path if absent."""
    for part in path:
        document = document.setdefault(part, {})
    document |= entry


def comparison_json(comparison: "Comparison") -> dict[str, Any]:
    """Return a comparison in plain data.

    Returns
    -------
    dict
        ``a`` and ``b``: title, samples, rows_used and status of each. ``changed``: kind, name, a
        and b of each entry that differs. ``only``: the one input that differs, if it is the only
        thing: name, units, and mean and sd of each; else None. ``pairing``: see
        `Comparison`. ``regime``: label -> estimate; ``categories``: the same of others, such as
        the period; ``outputs``: element -> its statistics under their keys in a summary, each with
        ``a`` and ``b``, as `summary_json` has them, and ``difference``: ``value``, ``low``,
        ``high`` of b less a, with ``identical`` where the rows are paired and agree: then there is
        no interval. ``no_row_changes_sides``: where they differ, but none is a hit in one result
        alone; the ends are the largest share that may change sides. A scale also has ``ratio``.
        ``notes``: sentences.
    """
    shares = {
        name: {label: _compared(statistic) for label, statistic in statistics.items()}
        for name, statistics in comparison.shares.items()
    }
    return {
        "a": _about(comparison.first),
        "b": _about(comparison.second),
        "changed": [
            {"kind": change.kind, "name": change.name, "a": change.first, "b": change.second}
            for change in comparison.changed
        ],
        "only": None if comparison.only is None else _only(comparison.only),
        "pairing": comparison.pairing,
        "regime": shares.pop(REGIME, {}),
        "categories": shares,
        "outputs": {name: _output(output) for name, output in comparison.outputs.items()},
        "notes": comparison.notes,
    }


def _about(side: "Side") -> dict[str, Any]:
    facts = {name: getattr(side.summary, name) for name in ("samples", "rows_used", "status")}
    return {"title": side.title} | facts


def _only(change: OnlyChange) -> dict[str, Any]:
    moments = {
        key: {"a": getattr(change.first, key), "b": getattr(change.second, key)}
        for key in InputMoments._fields
    }
    return {"name": change.name, "units": change.units} | moments


def _output(output: "ComparedOutput") -> dict[str, Any]:
    document: dict[str, Any] = {"units": output.units}
    for name, pairs in output.parts.items():
        if EMPTY.get(name) == {}:
            document[name] = {}
        for pair in pairs:
            *parent, last = pair.first.key
            put(document, parent, {last: _compared(pair)})
    return document


def _compared(statistic: "ComparedStatistic") -> dict[str, Any]:
    same = {"identical": True} if statistic.identical else {}
    if statistic.no_row_changes_sides:
        same = {"no_row_changes_sides": True}
    entry = {
        "a": statistic.first.kind.entry(statistic.first),
        "b": statistic.second.kind.entry(statistic.second),
    }
    entry["difference"] = estimate_json.numbers(statistic.difference) | same
    if statistic.ratio is not None:
        entry["ratio"] = estimate_json.numbers(statistic.ratio) | same
    return entry


def levels_json(levels: "ByLevel") -> dict[str, Any]:
    """Return shares of the variance in plain data."""
    whole: dict[str, Any] = quality_json(levels.weights) | {
        "samples": levels.samples,
        "units": levels.units,
        "repeats": levels.repeats,
        "inputs": dict(levels.inputs),
        "outputs": {name: _shares(target) for name, target in levels.outputs.items()},
    }
    if levels.another_regime is not None:
        whole["regime"] = {"another": estimate_json.whole(levels.another_regime)}
    return whole


def _shares(target: "LevelShares") -> dict[str, Any]:
    shares = {name: estimate_json.whole(share) for name, share in target.shares.items()}
    more = {"variance": estimate_json.number(target.variance), "samples_left_out": target.left_out}
    return shares | more | {"integrated": list(target.integrated), "notes": list(target.notes)}


def twin_json(two_fidelities: "TwoFidelities") -> dict[str, Any]:
    """Return estimates with a twin in plain data."""
    outputs = {
        name: {label: _sharpened(sharpened) for label, sharpened in estimates.items()}
        for name, estimates in two_fidelities.outputs.items()
    }
    return vars(two_fidelities) | {"outputs": outputs}


def _sharpened(sharpened: "Sharpened") -> dict[str, Any]:
    plain = {"plain": estimate_json.numbers(sharpened.plain), "reduction": sharpened.reduction}
    note = {"note": sharpened.note} if sharpened.note else {}
    return (
        estimate_json.numbers(sharpened.estimate)
        | plain
        | estimate_json.failed(sharpened.failed)
        | note
    )


def convergence_json(running: "Mapping[str, Converging]") -> dict[str, Any]:
    """Return running estimates in plain data."""
    return {"outputs": {name: _converging(converging) for name, converging in running.items()}}


def _converging(converging: "Converging") -> dict[str, Any]:
    entry: dict[str, Any] = {
        "estimates": {
            label: [
                {"samples": samples} | estimate_json.numbers(estimate)
                for samples, estimate in sizes
            ]
            for label, sizes in converging.estimates.items()
        }
    }
    return entry | errors_json(converging.errors)


def errors_json(errors: Mapping[Any, Any] | None) -> dict[str, Any]:
    """Return a line of `uq.enough` in plain data."""
    if not errors:
        return {}
    return {
        "sampling_error": estimate_json.number(errors["sampling"]),
        "own_error": estimate_json.number(errors["own"]),
        "warning": errors["warning"],
    }
