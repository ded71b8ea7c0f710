"""The answer of a study, computed once from its assessments, and the verdict on its rows."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite
from weakref import WeakKeyDictionary

from uq.assess.answer.advice import advise
from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.events import Event, event
from uq.assess.answer.leading_level import VarianceComponents, levels_of, mixing, starts_alike
from uq.assess.answer.quantities import only_ranked, quantities
from uq.assess.answer.sufficiency import enough_of, settled
from uq.assess.answer.wording import assumptions, called, sentence, tied_to
from uq.assess.findings import Findings
from uq.assess.summary import REGIME
from uq.result.result import AnyResult, Result
from uq.text.numbers import capitalized


def answer(result: AnyResult) -> Answer:
    """Return the answer of a study: tolerance bounds, main drivers, and advice.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.

    Returns
    -------
    Answer
        Displays itself; its parts hold the numbers behind each sentence.

    Examples
    --------
    >>> found = uq.answer(uq.run("studies/exponential-wear.toml"))
    >>> found.lead.tolerance_bound.lower < found.lead.range.low.value  # a cautious bound
    True
    """
    result = Result.of(result)
    return conclude(Findings(result))


_ANSWERS: WeakKeyDictionary[Findings, Answer] = WeakKeyDictionary()


def conclude(findings: Findings) -> Answer:
    """Return the answer of a result, computed once."""
    if findings not in _ANSWERS:
        draft = without_advice(findings)
        _ANSWERS[findings] = replace(draft, advice=tuple(advise(findings, draft)))
    return _ANSWERS[findings]


def without_advice(findings: Findings) -> Answer:
    """Return the answer without advice, which would take reweighted rows."""
    result = findings.result
    answered = tuple((quantities if len(findings.rows) else only_ranked)(findings))
    regimes = tuple(regimes_of(findings))
    plain = Answer(
        str(result.dataset.attrs["title"]),
        len(result),
        int(result.failed.sum()),
        answered,
        regimes,
        (),
        tuple(findings.summary.notes),
        regimes_first=bool(regimes) and result.analysis.outputs[:1] == (REGIME,),
        result=result,
        starts_alike=starts_alike(result) if regimes else "",
        unmeasured=assumptions(result),
    )
    with_levels = beside_levels(plain, _levels(findings, plain))
    about = with_levels.main_regimes if with_levels.regimes_first else ()
    return replace(
        with_levels,
        enough=enough_of(findings, with_levels.quantities, about),
        ties=ties_of(result, with_levels),
        mixing=mixing(findings) if with_levels.regimes_first else with_levels.mixing,
    )


def beside_levels(draft: Answer, levels: VarianceComponents | None) -> Answer:
    """Return an answer with its variance components; events note if their leader is elsewhere."""
    leader = None if levels is None else levels.leader
    if leader is None:
        return replace(draft, levels=levels)

    def beside(event: Event) -> Event:
        first = None if event.ranking is None else event.ranking.leader
        other = first is not None and not set(first.inputs) <= set(leader.inputs)
        return replace(event, is_of_single=other)

    regimes = draft.regimes
    quantities = draft.quantities
    if draft.regimes_first:
        regimes = tuple(beside(regime) for regime in regimes)
    else:
        events = tuple(beside(event) for event in quantities[0].events)
        quantities = (replace(quantities[0], events=events), *quantities[1:])
    return replace(draft, levels=levels, regimes=regimes, quantities=quantities)


def _levels(findings: Findings, draft: Answer) -> VarianceComponents | None:
    """Return the variance components of the subject of the study; None if unknown."""
    if draft.regimes_first:
        (first, *_) = draft.regimes
        return levels_of(findings, first.name, f"whether it is {first.predicate}", first.ranking)
    lead = draft.lead
    return None if lead is None else levels_of(findings, lead.name, ranking=lead.ranking)


def ties_of(result: Result, draft: Answer) -> str:
    """Return a sentence on inputs tied to a leading input, or ""."""
    lead_rankings = [] if draft.lead is None else [draft.lead.ranking]
    rankings = [*(event.ranking for event in draft.asked_events), *lead_rankings]
    leading = {
        name
        for ranking in rankings
        if ranking is not None and ranking.leader is not None
        for name in ranking.leader.inputs
    }
    tied = tied_to(result, leading).items()
    same = (f"{called(name)} equals {called(other)}" for name, other in tied)
    text = ", and ".join(same)
    return f"{capitalized(text)} in every row." if text else ""


def regimes_of(findings: Findings) -> Iterator[Event]:
    """Yield the regimes that occur, the most frequent first; none if there is only one."""
    shares = [
        statistic for statistic in findings.summary.regimes.values() if statistic.facts["count"]
    ]
    for statistic in sorted(shares, key=lambda statistic: -statistic.facts["count"]) * (
        len(shares) > 1
    ):
        yield event(findings, f"P(regime={statistic.label})", statistic.label, statistic)


def verdict(findings: Findings, output: str | None = None) -> list[str]:
    """Return the verdict on the sample size in sentences, the least settled first.

    Parameters
    ----------
    findings : Findings
    output : str, optional
        Only for this output, or this element of one.
    """
    result = findings.result
    if output is None:
        answer = without_advice(findings)
        asked, enough = answer.quantities, answer.enough
    else:
        asked = tuple(
            quantity
            for quantity in quantities(findings)
            if output in (quantity.name, quantity.output)
        )
        enough = enough_of(findings, asked)
    if not len(result):
        return []
    if enough.unknown:
        return [f"Whether the sample size is sufficient cannot be assessed: {enough.unknown}."]
    if not enough.every:
        return ["Sample size is sufficient for all results of the study."] if asked else []
    lines = [
        f"More rows needed: {settled(clause, factor, result)}"
        if isfinite(factor)
        else f"{sentence(clause)} More rows would not help."
        for clause, factor in enough.every
    ]
    sufficient = "Sample size is sufficient for the main question of the study."
    return lines if enough.question else [sufficient, *lines]
