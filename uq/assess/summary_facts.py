"""The numbers of summaries, comparisons and levels as trees of facts."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import chain, groupby
from math import isfinite
from typing import TYPE_CHECKING, Any

from uq.assess.components_by_level import ByLevel, switching
from uq.assess.fact import Fact, Functions
from uq.assess.input_changes import InputMoments, OnlyChange
from uq.assess.life_fit import Fit, fits_of
from uq.assess.nested_table import LevelShares
from uq.assess.statistic import Reader, Statistic, place_of
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import REGIME, Described, Summary, status_counts
from uq.result.elements import independent_rows
from uq.result.nesting import nesting_of
from uq.stats import estimate_json
from uq.stats.importance_weights import ImportanceWeights, effective_rows, quality, tail_shape
from uq.stats.variance_components import nested_shares

if TYPE_CHECKING:
    from uq.assess.comparison import ComparedOutput, ComparedStatistic, Comparison, Side


_QUALITY = {"effective_rows": effective_rows, "pareto_k": tail_shape}
"""Quality of weighted rows -> its estimator."""


def summary_facts(summary: Summary, *, of_reports: bool = False) -> Fact:
    """Return the numbers of a summary.

    Parameters
    ----------
    summary : Summary
    of_reports : bool
        Whether the statistics that only a report shows are among them.

    Returns
    -------
    Fact
        ``samples`` and ``status`` count all rows. Everything else describes the ``rows_used``, the
        independent ones: ``regime`` (label -> count and share with interval), ``categories`` (the
        same of other categories, such as the period, where they occur), ``outputs`` (name of
        element -> its statistics, each under its key) and ``notes``, sentences on missing results.
        A number that does not exist or is not finite is None; beside it ``never``,
        ``low_censored`` and the like state why. Where rows failed, ``failed_low`` and
        ``failed_high`` bound an estimate (`uq.assess.failed_rows`). ``fits``, if asked for: the
        laws fitted to a lifetime. Where inspections have weighted the rows: ``effective_rows`` and
        ``pareto_k``.
    """
    rows = summary.rows if summary.rows_used else summary.result
    shares = {name: _labels(by_label) for name, by_label in summary.categories.items()}
    described = {name: _described(output, of_reports) for name, output in summary.outputs.items()}
    outputs = Fact(described, rows=rows)
    if not summary.rows_used:  # the notes say why
        notes = tuple(summary.notes)
        outputs = outputs.each(lambda fact: replace(fact, notes=notes))
    members = {
        name: replace(fact, rows=rows) for name, fact in quality_facts(summary.weights).items()
    }
    return Fact(
        members
        | {
            "samples": summary.samples,
            "rows_used": Fact(summary.rows_used, (independent_rows,), rows=rows),
            "status": summary.status,
            "regime": Fact(_labels(summary.regimes), rows=rows),
            "categories": Fact(shares, rows=rows),
            "outputs": outputs,
            "notes": summary.notes,
        },
        (status_counts,),
        rows=summary.result,
    )


def quality_facts(weights: ImportanceWeights | None) -> dict[str, Fact]:
    """Return the effective sample size and the tail shape of weights; nothing without weights."""
    return {
        name: Fact(estimate_json.number(number), (_QUALITY[name],))
        for name, number in quality(weights).items()
    }


def _labels(shares: Mapping[str, Statistic]) -> dict[str, Fact]:
    return {label: Fact(_share(statistic), statistic.by) for label, statistic in shares.items()}


def _described(described: Described, of_reports: bool) -> Fact:
    """Return the statistics of an element, each under its key."""
    members: dict[str, Any] = {"units": described.units}
    by: dict[str, Functions] = {}
    for name in sorted(described.parts, key=lambda name: place_of(STATISTICS[name]).json):
        statistics = [s for s in described.parts[name] if of_reports or s.is_read_by(Reader.JSON)]
        if (absent := place_of(STATISTICS[name]).absent) == "null" and not statistics:
            members[name] = Fact(None, (STATISTICS[name],))
        elif absent:
            members[name] = {}
        for (parent, form), same in groupby(statistics, lambda s: (s.key[:-1], s.kind.form)):
            group = list(same)
            _put(members, parent, _FORMS[form](group))
            by.setdefault(parent[0] if parent else "", group[0].by)
    members |= {name: Fact(members[name], by[name]) for name in members if name in by}
    fits = {law: _fit(fit) for law, fit in described.fits.items()}
    return Fact(members | ({"fits": Fact(fits, (fits_of,))} if fits else {}))


def _put(members: dict[str, Any], path: Iterable[str], entry: Mapping[str, Any]) -> None:
    """Merge an entry into members at a path, creating the path if absent."""
    for part in path:
        members = members.setdefault(part, {})
    members |= entry


def estimate_fact(statistic: Statistic) -> Fact:
    """Return a statistic with its interval, and why any of them is missing."""
    members: dict[str, Any] = estimate_json.whole(statistic.estimate)
    if statistic.rows_needed is not None:
        members["rows_needed"] = statistic.rows_needed
    if statistic.of:
        members["of"] = statistic.of
    if statistic.otherwise is not None:
        members["kaplan_meier"] = estimate_fact(statistic.otherwise)
    return Fact(members | estimate_json.failed(statistic.failed), statistic.by)


def _moments(group: list[Statistic]) -> dict[str, Fact]:
    members = {}
    for statistic in group:
        name, estimate = statistic.key[-1], statistic.estimate
        members[name] = Fact(estimate_json.number(estimate.value), statistic.by)
        members[f"{name}_interval"] = Fact(estimate_json.ends(estimate), statistic.by)
    return members


def _bounds(group: list[Statistic]) -> dict[str, Any]:
    members: dict[str, Any] = _numbers(group)
    for statistic in group:
        members |= estimate_json.flag(f"{statistic.key[-1]}_", statistic.estimate, "value")
    return members


def _numbers(group: list[Statistic]) -> dict[str, Fact]:
    return {
        statistic.key[-1]: Fact(estimate_json.number(statistic.estimate.value), statistic.by)
        for statistic in group
    }


def _counts(group: list[Statistic]) -> dict[str, Fact]:
    """Return numbers of rows; None where no number will do."""
    members = {}
    for statistic in group:
        count = statistic.estimate.value
        members[statistic.key[-1]] = Fact(int(count) if isfinite(count) else None, statistic.by)
    return members


def _sides(group: list[Statistic]) -> dict[str, Any]:
    """Return both sides of a threshold."""
    both = tuple(dict.fromkeys(chain.from_iterable(statistic.by for statistic in group)))
    members: dict[str, Any] = {statistic.key[-1]: _side(statistic) for statistic in group}
    members |= {name: Fact(number, both) for name, number in group[0].facts.items()}
    guesses = {statistic.key[-1]: statistic.otherwise for statistic in group if statistic.otherwise}
    if reason := group[0].estimate.reason:
        members["reason"] = reason
    if guesses:
        assumes = group[0].best.estimate.assumes
        sides = {side: _side(guess) for side, guess in guesses.items()}
        members["kaplan_meier"] = sides | {"assumes": assumes}
    return members


def _side(statistic: Statistic) -> Fact:
    reason = statistic.estimate.reason if statistic.estimate.assumes else ""
    bare = replace(statistic.estimate, assumes="", reason=reason)
    return estimate_fact(replace(statistic, estimate=bare, otherwise=None))


def _share(statistic: Statistic) -> dict[str, Any]:
    """Return count and share of a category."""
    share = {
        "count": statistic.facts["count"],
        "share": estimate_json.number(statistic.estimate.value),
    }
    return share | estimate_json.ends(statistic.estimate) | estimate_json.failed(statistic.failed)


_FORMS: dict[str, Callable[[list[Statistic]], Mapping[str, Any]]] = {
    "": lambda group: {},
    "estimate": lambda group: {statistic.key[-1]: estimate_fact(statistic) for statistic in group},
    "moment": _moments,
    "bound": _bounds,
    "side": _sides,
    "count": _counts,
    "number": _numbers,
    "facts": lambda group: {
        name: Fact(fact, statistic.by)
        for statistic in group
        for name, fact in statistic.facts.items()
    },
}
"""Form of the JSON of a kind -> members from the statistics whose keys differ in the last part."""


def _fit(fit: Fit) -> dict[str, Any]:
    entry: dict[str, Any] = {"rows": fit.rows}
    if isfinite(fit.p_value):
        entry["p_value"] = fit.p_value
    if fit.refused:
        return entry | {"refused": fit.refused}
    entry["parameters"] = {
        name: estimate_json.numbers(estimate) for name, estimate in fit.parameters.items()
    }
    if isfinite(fit.log_likelihood):
        entry |= {"log_likelihood": fit.log_likelihood, "aic": fit.aic}
    entry["assumes"] = fit.assumes
    for name, estimate in fit.b_lives.items():
        entry[name] = estimate_json.numbers(estimate) | {"extrapolated": name in fit.extrapolated}
    return entry


def comparison_facts(comparison: "Comparison") -> Fact:
    """Return the numbers of a comparison.

    Returns
    -------
    Fact
        ``a`` and ``b``: title, samples, rows_used and status of each. ``changed``: kind, name, a
        and b of each entry that differs. ``only``: the one input that differs, if it is the only
        thing: name, units, and mean and sd of each; else None. ``pairing``: see
        `Comparison`. ``regime``: label -> estimate; ``categories``: the same of others, such as
        the period; ``outputs``: element -> its statistics under their keys in a summary, each with
        ``a`` and ``b``, as `summary_facts` has them, and ``difference``: ``value``, ``low``,
        ``high`` of b less a, with ``identical`` where the rows are paired and agree: then there is
        no interval. ``no_row_changes_sides``: where they differ, but none is a hit in one result
        alone; the ends are the largest share that may change sides. A scale also has ``ratio``.
        ``curves``, with lives from the field: survival probabilities of a and b at each ``time``,
        and their ``difference`` with its interval.
        ``notes``: sentences.
    """
    shares = {
        name: {label: _compared(statistic) for label, statistic in statistics.items()}
        for name, statistics in comparison.shares.items()
    }
    return Fact(
        {
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
        | ({"curves": _curves(comparison)} if comparison.curves else {}),
    )


def _curves(comparison: "Comparison") -> dict[str, Any]:
    """Return survival probabilities of both results and their differences at each time."""
    return {
        name: {
            "time": curves.time.tolist(),
            "a": [estimate_json.numbers(estimate) for estimate in curves.first],
            "b": [estimate_json.numbers(estimate) for estimate in curves.second],
            "difference": [estimate_json.numbers(estimate) for estimate in curves.differences],
        }
        for name, curves in comparison.curves.items()
    }


def _about(side: "Side") -> dict[str, Any]:
    counts = {name: getattr(side.summary, name) for name in ("samples", "rows_used", "status")}
    return {"title": side.title} | counts


def _only(change: OnlyChange) -> dict[str, Any]:
    moments = {
        key: {"a": getattr(change.first, key), "b": getattr(change.second, key)}
        for key in InputMoments._fields
    }
    return {"name": change.name, "units": change.units} | moments


def _output(output: "ComparedOutput") -> dict[str, Any]:
    members: dict[str, Any] = {"units": output.units}
    for name, pairs in output.parts.items():
        if place_of(STATISTICS[name]).absent == "{}":
            members[name] = {}
        for pair in pairs:
            *parent, last = pair.first.key
            _put(members, parent, {last: _compared(pair)})
    return members


def _compared(statistic: "ComparedStatistic") -> dict[str, Any]:
    same = {"identical": True} if statistic.identical else {}
    if statistic.no_row_changes_sides:
        same = {"no_row_changes_sides": True}
    members: dict[str, Any] = {"a": _alone(statistic.first), "b": _alone(statistic.second)}
    members["difference"] = estimate_json.numbers(statistic.difference) | same
    if statistic.ratio is not None:
        members["ratio"] = estimate_json.numbers(statistic.ratio) | same
    return members


def _alone(statistic: Statistic) -> Fact:
    """Return a statistic of one of two results."""
    estimate = statistic.estimate
    if statistic.kind.form == "moment":
        return Fact(estimate_json.numbers(estimate), statistic.by)
    if statistic.kind.form == "share":
        value = {"value": estimate_json.number(estimate.value)}
        return Fact(_share(statistic) | value, statistic.by)
    if statistic.kind.form == "side":
        side, assumes = _side(statistic), {"assumes": estimate.assumes} if estimate.assumes else {}
        return replace(side, members=side.members | assumes)
    return estimate_fact(statistic)


def levels_facts(levels: ByLevel) -> Fact:
    """Return the shares of the variance by level."""
    members: dict[str, Any] = quality_facts(levels.weights) | {
        "samples": levels.samples,
        "units": levels.units,
        "repeats": levels.repeats,
        "inputs": dict(levels.inputs),
        "outputs": {name: _shares(target) for name, target in levels.outputs.items()},
    }
    if levels.another_regime is not None:
        another = estimate_json.whole(levels.another_regime)
        members["regime"] = Fact({"another": another}, (switching,))
    return Fact(members, (nesting_of,))


def _shares(target: LevelShares) -> Fact:
    shares = {name: estimate_json.whole(share) for name, share in target.shares.items()}
    more = {"variance": estimate_json.number(target.variance), "samples_left_out": target.left_out}
    words = {"integrated": list(target.integrated), "notes": list(target.notes)}
    return Fact(shares | more | words, (nested_shares,))
