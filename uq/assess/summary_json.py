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
        "categories": {name: _labels(one) for name, one in summary.categories.items()},
        "outputs": {name: _described(one) for name, one in summary.outputs.items()},
        "notes": summary.notes,
    }


def _labels(shares: Shares) -> dict[str, Any]:
    return {label: share_json(one) for label, one in shares.items()}


def quality_json(weights: Smoothed | None) -> dict[str, Any]:
    """Return how many rows of equal weight rows are worth, and the shape of their weights."""
    return {name: estimate_json.number(one) for name, one in quality(weights).items()}


def _described(one: Described) -> dict[str, Any]:
    found: dict[str, Any] = {"units": one.units}
    for name in dict.fromkeys((*JSON_ORDER, *one.parts)):
        statistics = [s for s in one.parts[name] if s.is_read_by(Reader.JSON)]
        if name in EMPTY:
            found[name] = {} if statistics else EMPTY[name]
        for parent, _, entry in written(statistics):
            put(found, parent, entry)
    fits = {law: _fit(fit) for law, fit in one.fits.items()}
    return found | ({"fits": fits} if fits else {})


def written(
    statistics: Iterable[Statistic],
) -> Iterator[tuple[tuple[str, ...], list[Statistic], dict[str, Any]]]:
    """Yield path, statistics and JSON of those that are written together."""
    for (parent, _), group in groupby(statistics, lambda s: (s.key[:-1], s.kind.write)):
        members = list(group)
        yield parent, members, members[0].kind.write(members)


def _fit(fit: Fit) -> dict[str, Any]:
    found: dict[str, Any] = {"rows": fit.rows}
    if isfinite(fit.p_value):
        found["p_value"] = fit.p_value
    if fit.refused:
        return found | {"refused": fit.refused}
    found["parameters"] = {name: estimate_json.numbers(one) for name, one in fit.parameters.items()}
    found["assumes"] = fit.assumes
    for name, one in fit.b_lives.items():
        found[name] = estimate_json.numbers(one) | {"extrapolated": name in fit.extrapolated}
    return found


def put(found: dict[str, Any], path: Iterable[str], entry: dict[str, Any]) -> None:
    """Add an entry to JSON at a path, which is made if it is not there."""
    for part in path:
        found = found.setdefault(part, {})
    found |= entry


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
        name: {label: _compared(one) for label, one in of.items()}
        for name, of in comparison.shares.items()
    }
    return {
        "a": _about(comparison.first),
        "b": _about(comparison.second),
        "changed": [
            {"kind": one.kind, "name": one.name, "a": one.first, "b": one.second}
            for one in comparison.changed
        ],
        "only": None if comparison.only is None else _only(comparison.only),
        "pairing": comparison.pairing,
        "regime": shares.pop(REGIME, {}),
        "categories": shares,
        "outputs": {name: _output(one) for name, one in comparison.outputs.items()},
        "notes": comparison.notes,
    }


def _about(one: "Side") -> dict[str, Any]:
    facts = {name: getattr(one.summary, name) for name in ("samples", "rows_used", "status")}
    return {"title": one.title} | facts


def _only(one: OnlyChange) -> dict[str, Any]:
    found = {
        key: {"a": getattr(one.first, key), "b": getattr(one.second, key)}
        for key in InputMoments._fields
    }
    return {"name": one.name, "units": one.units} | found


def _output(one: "ComparedOutput") -> dict[str, Any]:
    found: dict[str, Any] = {"units": one.units}
    for name, pairs in one.parts.items():
        if EMPTY.get(name) == {}:
            found[name] = {}
        for pair in pairs:
            *parent, last = pair.first.key
            put(found, parent, {last: _compared(pair)})
    return found


def _compared(one: "ComparedStatistic") -> dict[str, Any]:
    same = {"identical": True} if one.identical else {}
    if one.no_row_changes_sides:
        same = {"no_row_changes_sides": True}
    found = {"a": one.first.kind.entry(one.first), "b": one.second.kind.entry(one.second)}
    found["difference"] = estimate_json.numbers(one.difference) | same
    if one.ratio is not None:
        found["ratio"] = estimate_json.numbers(one.ratio) | same
    return found


def levels_json(found: "ByLevel") -> dict[str, Any]:
    """Return shares of the variance in plain data."""
    whole: dict[str, Any] = quality_json(found.weights) | {
        "samples": found.samples,
        "units": found.units,
        "repeats": found.repeats,
        "inputs": dict(found.inputs),
        "outputs": {name: _shares(one) for name, one in found.outputs.items()},
    }
    if found.another_regime is not None:
        whole["regime"] = {"another": estimate_json.whole(found.another_regime)}
    return whole


def _shares(one: "LevelShares") -> dict[str, Any]:
    shares = {name: estimate_json.whole(share) for name, share in one.shares.items()}
    more = {"variance": estimate_json.number(one.variance), "samples_left_out": one.left_out}
    return shares | more | {"integrated": list(one.integrated), "notes": list(one.notes)}


def twin_json(found: "TwoFidelities") -> dict[str, Any]:
    """Return estimates with a twin in plain data."""
    outputs = {
        name: {label: _sharpened(one) for label, one in estimates.items()}
        for name, estimates in found.outputs.items()
    }
    return vars(found) | {"outputs": outputs}


def _sharpened(one: "Sharpened") -> dict[str, Any]:
    plain = {"plain": estimate_json.numbers(one.plain), "reduction": one.reduction}
    note = {"note": one.note} if one.note else {}
    return estimate_json.numbers(one.estimate) | plain | estimate_json.failed(one.failed) | note


def convergence_json(found: "Mapping[str, Converging]") -> dict[str, Any]:
    """Return running estimates in plain data."""
    return {"outputs": {name: _converging(one) for name, one in found.items()}}


def _converging(one: "Converging") -> dict[str, Any]:
    found: dict[str, Any] = {
        "estimates": {
            label: [{"samples": samples} | estimate_json.numbers(each) for samples, each in sizes]
            for label, sizes in one.estimates.items()
        }
    }
    return found | errors_json(one.errors)


def errors_json(errors: Mapping[Any, Any] | None) -> dict[str, Any]:
    """Return a line of `uq.enough` in plain data."""
    if not errors:
        return {}
    return {
        "sampling_error": estimate_json.number(errors["sampling"]),
        "own_error": estimate_json.number(errors["own"]),
        "warning": errors["warning"],
    }
