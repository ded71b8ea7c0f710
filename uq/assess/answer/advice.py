"""Advice by rules: mend, add rows, measure, tighten, or nothing."""

from collections.abc import Iterator, Sequence
from math import isfinite, isinf, isnan

from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.contributions import Contribution
from uq.assess.answer.events import Event
from uq.assess.answer.leading_level import VarianceComponents
from uq.assess.answer.piece_of_advice import Advice
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.sufficiency import SampleSizeAssessment, bounds_unsettled, needed, size_for
from uq.assess.answer.tightening import tighten
from uq.assess.answer.wording import ASSUMED, CHOSEN, called, called_together, mark_of, share_text
from uq.assess.findings import Findings
from uq.result.result import Result
from uq.sampling.levels import CHANCE
from uq.text.keys import key_of
from uq.text.numbers import counted, grouped

_AS_SETTLED = ("known", "source", "tighten", "keep", "chance")
"""Rules of advice that is given even if everything is settled."""


def advise(findings: Findings, answer: Answer) -> Iterator[Advice]:
    """Yield advice, the most urgent first; none where inspections have weighted the rows.

    Parameters
    ----------
    findings : Findings
    answer : Answer
        Without advice.
    """
    if findings.result.has_weights:
        return
    enough = answer.enough
    advice = [
        *_mend(findings, answer.quantities),
        *([Advice("finer", enough.finer)] if enough.finer else []),
        *_unknown(answer),
        *_leave_to_chance(answer.levels),
        *_measure(findings, answer),
        *(
            []
            if answer.regimes_first
            else [*_tighten(findings, answer)] or _keep(findings.result, answer)
        ),
        *(_add_rows(findings.result, enough) if answer.quantities else ()),
    ]
    answered = answer.quantities
    if answered and not enough.question and all(entry.rule in _AS_SETTLED for entry in advice):
        laws_measured = any(entry.rule == "known" for entry in advice)
        advice = [entry for entry in advice if entry.rule != "known"]  # `settled` states it
        nothing = "Nothing else is needed" if advice else "Nothing is needed"
        noisy = any(
            (error := quantity.own_error) is not None
            and (error.members["share_of_variance"] or 0.0) >= 1
            for quantity in answered
        )
        some_open = enough.besides or noisy
        settled = f"{'the main question' if some_open else 'all questions'} of the study"
        settled += " is settled" if some_open else " are settled"
        settled += ", and no influential law is assumed" * laws_measured
        advice.append(Advice("nothing", f"{nothing}: {settled}."))
    yield from advice


def _leave_to_chance(levels: VarianceComponents | None) -> Iterator[Advice]:
    """Yield the advice that tolerances help little, where chance is the main driver."""
    leader = None if levels is None else levels.leader
    if levels is not None and leader is not None and leader.name == CHANCE:
        yield Advice(
            "chance",
            f"Tighter tolerances would help little: {leader.words} {leader.explains} most of"
            f" {levels.variance}, and every repeat of one machine differs.",
            leader.inputs,
        )


def _mend(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    result = findings.result
    lost, rows = int(result.failed.sum()), len(result)
    most = result.analysis.max_failed
    why = [f"the study allows {100 * most:g} % invalid rows"] * (rows > 0 and lost > most * rows)
    why += [clause for clause, factor in bounds_unsettled(findings, answered) if isinf(factor)]
    if why:
        yield Advice(
            "failed",
            f"Fix the {counted(lost, 'invalid row')} first: {why[0]};"
            f" 'uq rerun {result.file} --failed{result.model_option}' recomputes them, with other"
            " settings if necessary.",
        )


def _unknown(answer: Answer) -> Iterator[Advice]:
    """Yield the advice that no sample size settles an event that cannot be estimated."""
    unknown = [event.sentence for event in answer.asked_events if isnan(event.share.value)]
    for text in [text for text in unknown if text][:1]:
        yield Advice("unknown", f"More rows would not help: {text[:1].lower()}{text[1:]}")


def _leading(answer: Answer) -> tuple[Contribution | None, Event | None]:
    """Return the leading contribution to the subject of the study, and the event that it drives."""
    about = [(event.ranking, event) for event in answer.asked_events]
    lead_ranking = None if answer.lead is None or answer.regimes_first else answer.lead.ranking
    for ranking, event in (*about, (lead_ranking, None)):
        if ranking is not None and ranking.leads:
            return ranking.leader, event
    return None, None


def _measure(findings: Findings, answer: Answer) -> Iterator[Advice]:
    leader, event = _leading(answer)
    if leader is None:
        return
    marks = {name: mark_of(findings.result, name) for name in leader.sure}
    levels = findings.result.levels
    to_what = f" for the share that {event.clause}" if event else ""
    starts = {name for name in marks if "initial" in findings.result.dataset[name].attrs}
    lasting = [
        name
        for name, how in marks.items()
        if how != CHOSEN and levels[name] != CHANCE and name not in starts
    ]
    assumed = tuple(name for name in lasting if marks[name] == ASSUMED)
    unstated = tuple(name for name in lasting if not marks[name])
    if not assumed and unstated:
        is_single = len(unstated) == 1
        yield Advice(
            "source",
            f"State in 'source' how {called_together(unstated)}"
            f" {'is' if is_single else 'are'} known"
            " (given, measured, inferred, fitted, assumed or chosen):"
            f" {'it matters' if is_single else 'they matter'} most{to_what}.",
            unstated,
        )
    elif not assumed and lasting:
        is_single = len(lasting) == 1
        yield Advice(
            "known",
            f"No measurement is needed first: {'the law' if is_single else 'the laws'} of"
            f" {called_together(lasting)}, which {'matters' if is_single else 'matter'}"
            f" most{to_what}, {'is' if is_single else 'are'} not assumed.",
            tuple(lasting),
        )
    if not assumed:
        return
    is_single = len(assumed) == 1
    words = called_together(assumed)
    matters = "it matters" if is_single else "they matter"
    if leader.doubtful:
        matters = f"{'it' if is_single else 'they'} may matter"
    single = event is not None and event.is_of_single
    measure = "Among single inputs, measure" if single else "Measure"
    yield Advice(
        "measure",
        f"{measure} {words} first: {matters} most{to_what}, and"
        f" {'its law is' if is_single else 'their laws are'} assumed.",
        assumed,
    )


def _tighten(findings: Findings, answer: Answer) -> Iterator[Advice]:
    leader, _ = _leading(answer)
    if leader is not None and any(
        mark_of(findings.result, name) != CHOSEN for name in leader.inputs
    ):
        yield from tighten(findings.result, answer.quantities[0], leader)


def _keep(result: Result, answer: Answer) -> Iterator[Advice]:
    """Yield the range to keep the leading input in, if the event differs significantly there."""
    _, event = _leading(answer)
    lead = answer.lead
    if event is None or event.curve is None or lead is None or (more := lead.wants_more) is None:
        return
    place = event.curve.most if more else event.curve.least
    local, overall = event.curve.shares[place], event.share
    if mark_of(result, event.over) == ASSUMED:  # an assumed quantity cannot be adjusted
        return
    if local.low > overall.high if more else local.high < overall.low:
        kept, key_name = event.part(place), "decided_by"
        few, averaged = share_text(local), ""
        if event.limit is not None and not event.limit.why:
            limit, key_name = event.limit, "limit"
            kept, few, averaged = limit.place, limit.few, limit.averaged
        yield Advice(
            "keep",
            f"To {'increase' if more else 'reduce'} the share that {event.clause}, keep"
            f" {called(event.over)} {kept}: {few} do there{averaged}.",
            (event.over,),
            key=key_of("quantities", lead.name, "events", event.name, key_name, verb="answer"),
            place=kept,
            there=f"{few} {event.clause}{averaged}",
        )


def _add_rows(result: Result, enough: SampleSizeAssessment) -> Iterator[Advice]:
    """Yield the required sample size, or the reason for missing intervals."""
    rows = len(result)
    if enough.unknown:
        wanted = "obtain a bound" if result.why_no_statistics else "obtain intervals"
        yield Advice("rows", f"To {wanted}: {enough.unknown}.")
    shortfalls = [shortfall for shortfall in enough.question if isfinite(shortfall[1])]
    if not shortfalls or not rows or enough.errors is not None:
        return
    (clause, factor), others, more = shortfalls[0], len(enough.every) - 1, ""
    if others:
        are, them = ("is", "it") if others == 1 else ("are", "them")
        listed = f"'uq convergence {result.file}' lists {them}"
        more = f"; {others} more {are} not settled ({listed})"
    yield Advice(
        "rows",
        f"Compute {needed(factor, result)} instead of {grouped(rows)}: {clause}{more}.",
        rows=size_for(factor, result),
    )
