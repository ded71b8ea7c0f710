"""The answer as the command line prints it with ``--json``: for each sentence, its numbers."""

from collections.abc import Iterator
from math import isnan
from typing import Any

from uq.assess.answer.contributions import AverageEffect, Contribution, Ranking
from uq.assess.answer.earliest import Earliest
from uq.assess.answer.facts import Answer
from uq.assess.answer.levels import VarianceComponents
from uq.assess.answer.limits import Limit
from uq.assess.answer.parts import Event, Quantity
from uq.assess.answer.regime_mixing import Intermingled
from uq.assess.answer.remedies import Advice, TighterTolerance
from uq.assess.answer.repeat_interval import PredictionInterval
from uq.assess.answer.solver_error import OwnError
from uq.assess.answer.sufficiency import Enough
from uq.assess.answer.tolerance_bound import Range, ToleranceBound
from uq.assess.event_curve import EventCurve
from uq.stats import estimate_json


def answer_json(answer: Answer) -> dict[str, Any]:
    """Return the answer in plain data, in the units of the outputs.

    Returns
    -------
    dict
        ``rows``, ``failed``; ``quantities``: name of the element -> ``words``, ``promise``,
        ``range``, ``own_error`` (the promise if every value were wrong by the error that it
        states), ``events`` (target -> event), ``earliest`` (of lives), ``another_seed`` and
        ``ranking``; ``regimes``: label -> event; ``assumptions``, in sentences; ``enough``, whether
        the rows are: what is not settled besides (``others``), what another seed would find of a
        share (``expected``), and the errors of what the study is about where that of the rows is
        the larger; ``intermingled``, where the regimes are: the ``uncertainty_exponent`` of their
        boundary, and how many uncertain outcomes are ``left`` with inputs known twice as well;
        ``levels``: the ``shares`` of the variance, and the probability of ``another_regime``;
        ``advice``: rule -> ``text``, ``inputs``, ``rows``, and the ``tolerances`` that were
        compared: what half the scatter of their ``inputs`` would make ``after`` of the number
        ``what``. The numbers of a sentence stand side by side, with the sentence, under a key of
        their own. A promise has the places of its bounds among the rows in order
        (``lower_is_row``), and the share of rows that have the last value, where that bounds
        nothing (``share_at_largest``). An event has its ``share``, what it is ``decided_by``, its
        probability in ``parts`` of the range of the input ``over``, and the ``limit`` of this
        input: from ``at`` to ``end`` its unwanted side is rare on average, with the probability in
        the part next to ``at``. A ranking has
        ``contributions``: ``inputs`` -> index, ``effects`` -> change with a ``step`` of the input,
        in a ``unit`` or, where that is "", in that of the output; and, of shares that inputs
        explain alone, what is ``unexplained`` by any single one, with the ``totals`` of an
        expansion where interactions could change the order. The earliest rows have ``lives``
        (row -> life), and the ``inputs`` that distinguish them and the ``regimes`` of most of them.
    """
    return {
        "rows": answer.rows,
        "failed": answer.failed,
        "quantities": {quantity.name: _quantity(quantity) for quantity in answer.quantities},
        "regimes": {regime.predicate: _event(regime) for regime in answer.regimes},
        "assumptions": list(answer.assumptions),
        "enough": _enough(answer.enough),
        **_mixing(answer.mixing),
        "levels": None if answer.levels is None else _levels(answer.levels),
        "advice": {advice.rule: _advice(advice) for advice in answer.advice},
    }


def _enough(enough: Enough) -> dict[str, Any]:
    entry: dict[str, Any] = {"sentence": enough.sentence, "others": list(enough.others)}
    if enough.again.is_share and enough.again.subject:
        entry["expected"] = _repeated(enough.again)["expected"]
    if enough.errors is not None:
        entry |= {"own_error": enough.errors.numerical, "sampling_error": enough.errors.sampling}
    return entry


def _mixing(mixing: Intermingled) -> dict[str, Any]:
    if not mixing.sentence:
        return {}
    numbers = {
        f"{name}{end}": value
        for name, estimate in (("uncertainty_exponent", mixing.exponent), ("left", mixing.left))
        for end, value in zip(("", "_low", "_high"), estimate.numbers, strict=True)
    }
    return {"intermingled": {"sentence": mixing.sentence} | numbers}


def _levels(components: VarianceComponents) -> dict[str, Any]:
    return {
        "sentence": components.sentence,
        "target": components.target,
        "shares": {
            component.name: estimate_json.numbers(component.share)
            for component in components.levels
        },
        "another_regime": None
        if components.another is None
        else estimate_json.numbers(components.another),
    }


def _quantity(quantity: Quantity) -> dict[str, Any]:
    entry: dict[str, Any] = {"words": quantity.words}
    entry |= {} if quantity.promise is None else {"promise": _promise(quantity.promise)}
    entry |= {} if quantity.range is None else {"range": _range(quantity.range)}
    entry |= {} if quantity.own_error is None else {"own_error": _own_error(quantity.own_error)}
    entry["events"] = {event.name: _event(event) for event in quantity.events}
    entry |= {} if quantity.earliest is None else {"earliest": _earliest(quantity.earliest)}
    if quantity.repeated.sentence:
        entry["another_seed"] = _repeated(quantity.repeated)
    return entry | _of_ranking(quantity.ranking)


def _earliest(earliest: Earliest) -> dict[str, Any]:
    return {
        "sentence": earliest.sentence,
        "first": earliest.first,
        "command": earliest.command,
        "lives": {str(row): life for row, life in zip(earliest.rows, earliest.lives, strict=True)},
        "size": earliest.size,
        "of": earliest.total,
        "inputs": {
            distinct.name: {
                "direction": distinct.direction,
                "outwards": distinct.outwards,
                "median": distinct.median,
                "median_of_others": distinct.others,
                "rank": distinct.rank.value,
                "rank_low": estimate_json.number(distinct.rank.low),
                "rank_high": estimate_json.number(distinct.rank.high),
            }
            for distinct in earliest.inputs or ()
        },
        "regimes": {
            regime_share.label: estimate_json.numbers(regime_share.share)
            | {"overall": regime_share.overall, "is_more_frequent": regime_share.is_more_frequent}
            for regime_share in earliest.regimes
        },
    }


def _promise(promise: ToleranceBound) -> dict[str, Any]:
    low, high = promise.quantiles
    numbers = {
        "coverage": promise.coverage,
        "confidence": promise.confidence,
        "lower": promise.lower,
        "upper": promise.upper,
        "lower_quantile": low.value,
        "lower_quantile_low": low.low,
        "upper_quantile": high.value,
        "upper_quantile_high": high.high,
    }
    plain = {name: estimate_json.number(value) for name, value in numbers.items()}
    joint = {"joint": list(promise.joint)} if promise.joint else {}
    ends = (("lower", promise.ranks[0]), ("upper", promise.ranks[1]))
    places = {f"{side}_is_row": rank for side, rank in ends if rank}
    piled = {
        f"share_at_{'largest' if atom.upper else 'smallest'}": atom.share for atom in promise.piled
    }
    return {"sentence": promise.sentence, "reason": promise.reason} | plain | places | piled | joint


def _own_error(error: OwnError) -> dict[str, Any]:
    worse = dict(zip(("lower", "upper"), map(estimate_json.number, error.worse), strict=True))
    numbers = {
        "share_of_variance": error.share,
        "accuracy": error.asked,
        "rows_missing_it": error.missed,
    }
    plain = {name: estimate_json.number(value) for name, value in numbers.items()}
    return {"sentence": error.sentence} | worse | plain | {"rows_stating_none": error.unstated}


def _range(likely_range: Range) -> dict[str, Any]:
    entry: dict[str, Any] = {"sentence": likely_range.sentence}
    for name in ("low", "median", "high"):
        estimate = getattr(likely_range, name)
        entry[name] = estimate_json.number(estimate.value)
        entry |= estimate_json.flag(f"{name}_", estimate, "value")
    if not isnan(likely_range.never.value):
        ends = {
            f"never_{name}": end for name, end in estimate_json.ends(likely_range.never).items()
        }
        entry |= {"never": likely_range.never.value} | ends
    return entry


def _repeated(interval: PredictionInterval) -> dict[str, Any]:
    ends = {"low": estimate_json.number(interval.low), "high": estimate_json.number(interval.high)}
    return {"sentence": interval.sentence} | ({"expected": ends} if interval.subject else {})


def _event(event: Event) -> dict[str, Any]:
    entry: dict[str, Any] = {"said": event.predicate}
    entry["share"] = (
        {"sentence": event.sentence}
        | estimate_json.whole(event.share)
        | estimate_json.failed(event.failed)
    )
    entry["share"] |= {"undefined": event.undefined}
    entry["decided_by"] = {"sentence": event.decided_by}
    if event.curve is not None:
        parts = [*_parts(event.curve)]
        for name, place in (("least", event.curve.least), ("most", event.curve.most)):
            low, high = event.curve.around(place)
            entry["decided_by"] |= {
                name: parts[place]["value"],
                f"{name}_above": low,
                f"{name}_below": high,
            }
        entry |= {"over": event.over, "parts": parts}
    if event.limit is not None:
        entry["limit"] = _limit(event.limit)
    return entry | _of_ranking(event.ranking)


def _limit(limit: Limit) -> dict[str, Any]:
    ends = {name: estimate_json.number(getattr(limit, name)) for name in ("at", "end")}
    return (
        {"sentence": limit.sentence, "is_lower": limit.is_lower}
        | ends
        | estimate_json.numbers(limit.share)
    )


def _parts(curve: EventCurve) -> Iterator[dict[str, Any]]:
    """Yield the parts of an input, each with the probability of the event there."""
    edges = [float(edge) for edge in curve.edges]
    for low, high, share in zip(edges[:-1], edges[1:], curve.shares, strict=True):
        yield {"above": low, "below": high} | estimate_json.numbers(share)


def _of_ranking(ranking: Ranking | None) -> dict[str, Any]:
    if ranking is None:
        return {}
    entry: dict[str, Any] = {
        "sentence": ranking.sentence,
        "target": ranking.target,
        "method": ranking.method,
        "index": ranking.kind,
        "reason": ranking.reason,
        "rows_factor": estimate_json.number(ranking.rows_factor),
        "contributions": [_contribution(contribution) for contribution in ranking.contributions],
    }
    if not isnan(ranking.unexplained.value):
        entry["unexplained"] = estimate_json.numbers(ranking.unexplained)
        entry["totals"] = dict(ranking.totals)
    return {"ranking": entry}


def _contribution(contribution: Contribution) -> dict[str, Any]:
    changes = zip(contribution.inputs, contribution.changes, strict=False)
    return {
        "inputs": {
            name: estimate_json.numbers(index)
            for name, index in zip(contribution.inputs, contribution.indices, strict=True)
        },
        "effects": {name: _change(change, name) for name, change in changes},
    }


def _change(effect: AverageEffect, name: str) -> dict[str, Any]:
    return {
        "sentence": effect.sentence(name),
        "direction": effect.direction,
        "step": effect.step,
        "unit": effect.unit.name if effect.step and effect.unit.per == 1.0 else "",
    } | estimate_json.numbers(effect.by)


def _advice(advice: Advice) -> dict[str, Any]:
    entry: dict[str, Any] = {"text": advice.text, "inputs": list(advice.inputs)}
    if advice.rows is not None:
        entry["rows"] = advice.rows
    if advice.tolerances:
        entry["tolerances"] = [_tightened(tolerance) for tolerance in advice.tolerances]
    return entry


def _tightened(tolerance: TighterTolerance) -> dict[str, Any]:
    return {
        "inputs": list(tolerance.inputs),
        "law": tolerance.law,
        "what": tolerance.statistic,
        "before": estimate_json.numbers(tolerance.before),
        "after": estimate_json.numbers(tolerance.after),
        "promised": tolerance.promised,
        "key": tolerance.key,
    }
