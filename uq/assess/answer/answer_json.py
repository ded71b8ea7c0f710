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


def answer_json(found: Answer) -> dict[str, Any]:
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
        "rows": found.rows,
        "failed": found.failed,
        "quantities": {one.name: _quantity(one) for one in found.quantities},
        "regimes": {one.said: _event(one) for one in found.regimes},
        "assumptions": list(found.assumptions),
        "enough": _enough(found.enough),
        **_mixing(found.mixing),
        "levels": None if found.levels is None else _levels(found.levels),
        "advice": {one.rule: _advice(one) for one in found.advice},
    }


def _enough(one: Enough) -> dict[str, Any]:
    known: dict[str, Any] = {"sentence": one.sentence, "others": list(one.others)}
    if one.again.is_share and one.again.what:
        known["expected"] = _repeated(one.again)["expected"]
    if one.errors is not None:
        known |= {"own_error": one.errors.own, "sampling_error": one.errors.sampling}
    return known


def _mixing(one: Intermingled) -> dict[str, Any]:
    if not one.sentence:
        return {}
    numbers = {
        f"{name}{end}": value
        for name, known in (("uncertainty_exponent", one.exponent), ("left", one.left))
        for end, value in zip(("", "_low", "_high"), known.numbers, strict=True)
    }
    return {"intermingled": {"sentence": one.sentence} | numbers}


def _levels(one: VarianceComponents) -> dict[str, Any]:
    return {
        "sentence": one.sentence,
        "target": one.target,
        "shares": {
            component.name: estimate_json.numbers(component.share) for component in one.levels
        },
        "another_regime": None if one.another is None else estimate_json.numbers(one.another),
    }


def _quantity(one: Quantity) -> dict[str, Any]:
    found: dict[str, Any] = {"words": one.words}
    found |= {} if one.promise is None else {"promise": _promise(one.promise)}
    found |= {} if one.range is None else {"range": _range(one.range)}
    found |= {} if one.own_error is None else {"own_error": _own_error(one.own_error)}
    found["events"] = {event.name: _event(event) for event in one.events}
    found |= {} if one.earliest is None else {"earliest": _earliest(one.earliest)}
    if one.repeated.sentence:
        found["another_seed"] = _repeated(one.repeated)
    return found | _of_ranking(one.ranking)


def _earliest(one: Earliest) -> dict[str, Any]:
    return {
        "sentence": one.sentence,
        "first": one.first,
        "command": one.command,
        "lives": {str(row): life for row, life in zip(one.rows, one.lives, strict=True)},
        "size": one.size,
        "of": one.of,
        "inputs": {
            each.name: {
                "direction": each.direction,
                "outwards": each.outwards,
                "median": each.median,
                "median_of_others": each.others,
                "rank": each.rank.value,
                "rank_low": estimate_json.number(each.rank.low),
                "rank_high": estimate_json.number(each.rank.high),
            }
            for each in one.inputs or ()
        },
        "regimes": {
            each.label: estimate_json.numbers(each.share)
            | {"overall": each.overall, "is_more_frequent": each.is_more_frequent}
            for each in one.regimes
        },
    }


def _promise(one: ToleranceBound) -> dict[str, Any]:
    low, high = one.quantiles
    numbers = {
        "coverage": one.coverage,
        "confidence": one.confidence,
        "lower": one.lower,
        "upper": one.upper,
        "lower_quantile": low.value,
        "lower_quantile_low": low.low,
        "upper_quantile": high.value,
        "upper_quantile_high": high.high,
    }
    plain = {name: estimate_json.number(value) for name, value in numbers.items()}
    joint = {"joint": list(one.joint)} if one.joint else {}
    ends = (("lower", one.ranks[0]), ("upper", one.ranks[1]))
    places = {f"{side}_is_row": rank for side, rank in ends if rank}
    piled = {
        f"share_at_{'largest' if each.upper else 'smallest'}": each.share for each in one.piled
    }
    return {"sentence": one.sentence, "reason": one.reason} | plain | places | piled | joint


def _own_error(one: OwnError) -> dict[str, Any]:
    worse = dict(zip(("lower", "upper"), map(estimate_json.number, one.worse), strict=True))
    known = {"share_of_variance": one.share, "accuracy": one.asked, "rows_missing_it": one.missed}
    plain = {name: estimate_json.number(value) for name, value in known.items()}
    return {"sentence": one.sentence} | worse | plain | {"rows_stating_none": one.unstated}


def _range(one: Range) -> dict[str, Any]:
    found: dict[str, Any] = {"sentence": one.sentence}
    for name in ("low", "median", "high"):
        estimate = getattr(one, name)
        found[name] = estimate_json.number(estimate.value)
        found |= estimate_json.flag(f"{name}_", estimate, "value")
    if not isnan(one.never.value):
        ends = {f"never_{name}": end for name, end in estimate_json.ends(one.never).items()}
        found |= {"never": one.never.value} | ends
    return found


def _repeated(one: PredictionInterval) -> dict[str, Any]:
    ends = {"low": estimate_json.number(one.low), "high": estimate_json.number(one.high)}
    return {"sentence": one.sentence} | ({"expected": ends} if one.what else {})


def _event(one: Event) -> dict[str, Any]:
    found: dict[str, Any] = {"said": one.said}
    found["share"] = (
        {"sentence": one.sentence}
        | estimate_json.whole(one.share)
        | estimate_json.failed(one.failed)
    )
    found["share"] |= {"undefined": one.undefined}
    found["decided_by"] = {"sentence": one.decided_by}
    if one.curve is not None:
        parts = [*_parts(one.curve)]
        for name, place in (("least", one.curve.least), ("most", one.curve.most)):
            low, high = one.curve.around(place)
            found["decided_by"] |= {
                name: parts[place]["value"],
                f"{name}_above": low,
                f"{name}_below": high,
            }
        found |= {"over": one.over, "parts": parts}
    if one.limit is not None:
        found["limit"] = _limit(one.limit)
    return found | _of_ranking(one.ranking)


def _limit(one: Limit) -> dict[str, Any]:
    ends = {name: estimate_json.number(getattr(one, name)) for name in ("at", "end")}
    return (
        {"sentence": one.sentence, "is_lower": one.is_lower}
        | ends
        | estimate_json.numbers(one.share)
    )


def _parts(curve: EventCurve) -> Iterator[dict[str, Any]]:
    """Yield the parts of an input, each with the probability of the event there."""
    edges = [float(edge) for edge in curve.edges]
    for low, high, share in zip(edges[:-1], edges[1:], curve.shares, strict=True):
        yield {"above": low, "below": high} | estimate_json.numbers(share)


def _of_ranking(one: Ranking | None) -> dict[str, Any]:
    if one is None:
        return {}
    found: dict[str, Any] = {
        "sentence": one.sentence,
        "target": one.target,
        "method": one.method,
        "index": one.kind,
        "reason": one.reason,
        "rows_factor": estimate_json.number(one.rows_factor),
        "contributions": [_contribution(each) for each in one.contributions],
    }
    if not isnan(one.unexplained.value):
        found["unexplained"] = estimate_json.numbers(one.unexplained)
        found["totals"] = dict(one.totals)
    return {"ranking": found}


def _contribution(one: Contribution) -> dict[str, Any]:
    changes = zip(one.inputs, one.changes, strict=False)
    return {
        "inputs": {
            name: estimate_json.numbers(index)
            for name, index in zip(one.inputs, one.indices, strict=True)
        },
        "effects": {name: _change(change, name) for name, change in changes},
    }


def _change(one: AverageEffect, name: str) -> dict[str, Any]:
    return {
        "sentence": one.sentence(name),
        "direction": one.direction,
        "step": one.step,
        "unit": one.unit.name if one.step and one.unit.per == 1.0 else "",
    } | estimate_json.numbers(one.by)


def _advice(one: Advice) -> dict[str, Any]:
    found: dict[str, Any] = {"text": one.text, "inputs": list(one.inputs)}
    if one.rows is not None:
        found["rows"] = one.rows
    if one.tolerances:
        found["tolerances"] = [_tightened(each) for each in one.tolerances]
    return found


def _tightened(one: TighterTolerance) -> dict[str, Any]:
    return {
        "inputs": list(one.inputs),
        "law": one.law,
        "what": one.what,
        "before": estimate_json.numbers(one.before),
        "after": estimate_json.numbers(one.after),
        "promised": one.promised,
        "key": one.key,
    }
