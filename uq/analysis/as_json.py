"""Summaries and comparisons as the command line prints them with ``--json``."""

from collections.abc import Iterable
from itertools import groupby
from math import isfinite
from typing import Any

from uq import json_form
from uq.analysis.comparison import Comparison, Side
from uq.analysis.differences import Compared, ComparedOutput
from uq.analysis.input_changes import OnlyChange, Spread
from uq.analysis.life_fit import Fit
from uq.analysis.statistics.statistic import Reader
from uq.analysis.statistics.table import EMPTY, JSON_ORDER
from uq.analysis.summary import Described, Summary, regime_json


def summary_json(summary: Summary) -> dict[str, Any]:
    """Return a summary in plain data.

    Returns
    -------
    dict
        ``samples`` and ``status`` count all rows. Everything else describes the ``rows_used``, the
        independent ones: ``regime`` (label -> count and share with interval), ``outputs`` (name of
        element -> its statistics, each under its key) and ``notes``, sentences on what is missing.
        A number that does not exist or is not finite is None; beside it ``never``,
        ``low_censored`` and the like state why. Where rows failed, ``failed_low`` and
        ``failed_high`` bound an estimate (`uq.analysis.failed_rows`). ``fits``, if asked for: the
        laws fitted to a lifetime.
    """
    return {
        "samples": summary.samples,
        "rows_used": summary.rows_used,
        "status": summary.status,
        "regime": {label: regime_json(one) for label, one in summary.regimes.items()},
        "outputs": {name: _described(one) for name, one in summary.outputs.items()},
        "notes": summary.notes,
    }


def _described(one: Described) -> dict[str, Any]:
    found: dict[str, Any] = {"units": one.units}
    for name in dict.fromkeys((*JSON_ORDER, *one.parts)):
        statistics = [s for s in one.parts[name] if s.is_read_by(Reader.JSON)]
        if name in EMPTY:
            found[name] = {} if statistics else EMPTY[name]
        for (parent, _), group in groupby(statistics, lambda s: (s.key[:-1], s.kind.write)):
            members = list(group)
            _put(found, parent, members[0].kind.write(members))
    fits = {law: _fit(fit) for law, fit in one.fits.items()}
    return found | ({"fits": fits} if fits else {})


def _fit(fit: Fit) -> dict[str, Any]:
    found: dict[str, Any] = {"rows": fit.rows}
    if isfinite(fit.p_value):
        found["p_value"] = fit.p_value
    if fit.refused:
        return found | {"refused": fit.refused}
    found["parameters"] = {name: json_form.numbers(one) for name, one in fit.parameters.items()}
    found["assumes"] = fit.assumes
    for name, one in fit.b_lives.items():
        found[name] = json_form.numbers(one) | {"extrapolated": name in fit.extrapolated}
    return found


def _put(found: dict[str, Any], path: Iterable[str], entry: dict[str, Any]) -> None:
    for part in path:
        found = found.setdefault(part, {})
    found |= entry


def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """Return a comparison in plain data.

    Returns
    -------
    dict
        ``a`` and ``b``: title, samples, rows_used and status of each. ``changed``: kind, name, a
        and b of each entry that differs. ``only``: the one input that differs, if it is the only
        thing: name, units, and mean and sd of each; else None. ``pairing``: see
        `Comparison`. ``regime``: label -> estimate; ``outputs``: element -> its statistics under
        their keys in a summary, each with ``a`` and ``b``, as `summary_json` has them, and
        ``difference``: ``value``, ``low``, ``high`` of b less a, and ``identical`` where the rows
        are paired and agree: then there is no interval. A scale also has ``ratio``. ``notes``:
        sentences.
    """
    return {
        "a": _about(comparison.first),
        "b": _about(comparison.second),
        "changed": [
            {"kind": one.kind, "name": one.name, "a": one.first, "b": one.second}
            for one in comparison.changed
        ],
        "only": None if comparison.only is None else _only(comparison.only),
        "pairing": comparison.pairing,
        "regime": {label: _compared(one) for label, one in comparison.regimes.items()},
        "outputs": {name: _output(one) for name, one in comparison.outputs.items()},
        "notes": comparison.notes,
    }


def _about(one: Side) -> dict[str, Any]:
    facts = {name: getattr(one.summary, name) for name in ("samples", "rows_used", "status")}
    return {"title": one.title} | facts


def _only(one: OnlyChange) -> dict[str, Any]:
    found = {
        key: {"a": getattr(one.first, key), "b": getattr(one.second, key)} for key in Spread._fields
    }
    return {"name": one.name, "units": one.units} | found


def _output(one: ComparedOutput) -> dict[str, Any]:
    found: dict[str, Any] = {"units": one.units}
    for name, pairs in one.parts.items():
        if EMPTY.get(name) == {}:
            found[name] = {}
        for pair in pairs:
            *parent, last = pair.first.key
            _put(found, parent, {last: _compared(pair)})
    return found


def _compared(one: Compared) -> dict[str, Any]:
    same = {"identical": True} if one.identical else {}
    found = {"a": one.first.kind.entry(one.first), "b": one.second.kind.entry(one.second)}
    found["difference"] = json_form.numbers(one.difference) | same
    if one.ratio is not None:
        found["ratio"] = json_form.numbers(one.ratio) | same
    return found
