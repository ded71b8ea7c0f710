"""The answer as JSON: the numbers behind each sentence, in CF units, and the sentence."""

from typing import Any

from uq.analysis.event_curve import EventCurve
from uq.conclusions.contributions import Change, Contribution, Ranking
from uq.conclusions.parts import Advice, Answer, Event, Quantity
from uq.conclusions.promises import Promise, Range
from uq.json_form import failed, number, numbers


def answer_json(found: Answer) -> dict[str, Any]:
    """Return an answer in plain data.

    Parameters
    ----------
    found : Answer

    Returns
    -------
    dict
        ``sentences``: the answer as `uq.answer` prints it. Of what the study is about: ``output``,
        its element; ``promise``; ``range``; ``events``, what the thresholds ask; ``ranking`` of the
        inputs. ``others``: element -> the same of the other elements. ``regimes``: as ``events``,
        of the regimes. ``advice``: what to do, the most urgent first. Numbers are in the CF unit
        of the output, changes of a ranking in their own ``unit``; each part has its ``sentence``.
    """
    lead = {} if found.lead is None else {"output": found.lead.name} | _quantity(found.lead)
    return {
        "sentences": found.lines,
        **lead,
        "others": {one.name: _quantity(one) for one in found.quantities[1:]},
        "regimes": [_event(one) for one in found.regimes],
        "advice": [_advice(one) for one in found.advice],
    }


def _quantity(one: Quantity) -> dict[str, Any]:
    return {
        "words": one.words,
        "promise": None if one.promise is None else _promise(one.promise),
        "range": None if one.range is None else _range(one.range),
        "events": [_event(event) for event in one.events],
        "ranking": None if one.ranking is None else _ranking(one.ranking),
    }


def _promise(one: Promise) -> dict[str, Any]:
    ends = (round(1 - one.coverage, 12), one.coverage)
    return {
        "coverage": one.coverage,
        "confidence": one.confidence,
        "lower": number(one.lower),
        "upper": number(one.upper),
        "quantiles": {repr(p): numbers(q) for p, q in zip(ends, one.quantiles, strict=True)},
        "reason": one.reason,
        "sentence": one.sentence,
    }


def _range(one: Range) -> dict[str, Any]:
    ends = {name: numbers(getattr(one, name)) for name in ("low", "median", "high")}
    return ends | {"sentence": one.sentence}


def _event(one: Event) -> dict[str, Any]:
    return {
        "name": one.name,
        **numbers(one.share),
        **failed(one.failed),
        "undefined": number(one.undefined),
        "sentence": one.with_cause,
        "ranking": None if one.ranking is None else _ranking(one.ranking),
        "over": one.over,
        "curve": None if one.curve is None else _curve(one.curve),
    }


def _curve(one: EventCurve) -> dict[str, Any]:
    return {"edges": one.edges.tolist(), "shares": [numbers(share) for share in one.shares]}


def _ranking(one: Ranking) -> dict[str, Any]:
    return {
        "target": one.target,
        "method": one.method,
        "index": one.kind,
        "contributions": [_contribution(each) for each in one.contributions],
        "reason": one.reason,
        "rows_factor": number(one.rows_factor),
        "sentence": one.with_effect,
    }


def _contribution(one: Contribution) -> dict[str, Any]:
    indices = zip(one.inputs, one.indices, strict=True)
    changes = zip(one.inputs, one.changes, strict=False)  # not known for all, or for none
    return {
        "inputs": list(one.inputs),
        "indices": {name: numbers(index) for name, index in indices},
        "changes": {name: _change(change) for name, change in changes},
        "sentence": one.effect,
    }


def _change(one: Change) -> dict[str, Any]:
    relative = one.unit.name in ("%", "percentage points")
    return {
        "direction": one.direction,
        "step": one.step,
        **numbers(one.by),
        "unit": one.unit.name if relative else "output",
    }


def _advice(one: Advice) -> dict[str, Any]:
    return {
        "rule": one.rule,
        "inputs": list(one.inputs),
        "rows": one.rows,
        "sentence": one.text,
    }
