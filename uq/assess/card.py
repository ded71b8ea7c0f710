"""The card of a result: the few numbers, causes, checks and next steps that fit on a screen."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple

import numpy as np

from uq.assess.answer.answer import conclude
from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.contributions import Contribution
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.rankings import Ranking
from uq.assess.answer.sufficiency import rounded_size
from uq.assess.answer.tightening import halvings, tightened
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.answer.wording import (
    ASSUMED,
    CHOSEN,
    called,
    called_together,
    cause_warning,
    few_values,
    mark_of,
    scale_warning,
    tied_to,
    without_source,
)
from uq.assess.card_numbers import Headline, bound_name, headlines
from uq.assess.findings import Findings
from uq.assess.summary import REGIME
from uq.contract import Status
from uq.result.result import Result
from uq.sampling.designs import DESIGNS, PLAIN
from uq.sampling.levels import CHANCE
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.study.file import Tied
from uq.text.numbers import capitalized, counted, grouped, percent, rows_in_words
from uq.text.units import readable

MOST_CAUSES = 4
MOST_NAMED = 2
"""Of more fixed values without a source, their number is given."""
STUDY = "study"
"""Begins the advice on the number of rows."""
DEPENDENT = "are not independent"
"""Ends the reason for no bound of dependent rows."""


class LeadingInput(NamedTuple):
    """Inputs that contribute alike to the scatter of the subject of a study.

    Attributes
    ----------
    contribution : Contribution
    tightened : TighterTolerance or None
        A number of the subject with half the scatter of the inputs; None if unknown.
    """

    contribution: Contribution
    tightened: TighterTolerance | None

    def json(self, share_of: str) -> Iterator[dict[str, Any]]:
        """Yield the numbers of each input."""
        effects = dict(zip(self.contribution.inputs, self.contribution.changes, strict=False))
        tightened = None if self.tightened is None else self.tightened.fact.json
        indices = self.contribution.indices
        for name, index in zip(self.contribution.inputs, indices, strict=True):
            numbers = [estimate_json.number(number) for number in index.numbers]
            shares = dict(zip(("share", "low", "high"), numbers, strict=True))
            effect = effects[name].fact("").json if name in effects else None
            about = {"of": share_of, "effect": effect, "tightened": tightened}
            yield {"input": name} | shares | about


@dataclass(frozen=True)
class Card:
    """The answer of a study on one screen.

    Attributes
    ----------
    name, title, subject : str
        Name and description of the study; the output that it is about.
    besides : str
        The output of the numbers after those of the regimes, if the regimes come first.
    model, design : str
    rows, failed : int
    row_name : tuple of str
        Singular and plural of what a row represents.
    size : str
        Number of these, and of rows where they differ: ``2 048 rods in 13 312 rows``, or ``300
        rods, 2 runs each``.
    more_rows : str
        Why they differ, or "".
    no_bound : str
        Reason why there is a quantile in place of a bound, or "".
    headline : tuple of Headline
    assumed : tuple of str
        Assumed inputs to which every life is proportional.
    assumptions : str
        How many laws are assumed, and which of the causes; "" for none.
    assumed_causes : tuple of str
        Assumed inputs among those that contribute most.
    sources : str
        Laws of few values, and fixed values without a source; "" for none.
    causes : tuple of LeadingInput
    levels : tuple of tuple
        Of a study of regimes that chance decides: what varies between runs, and between machines,
        in words, with its share of the variance.
    index : str
        Key of the index of the causes: ``S1``.
    share_of : str
        What the index is a share of: ``log life``, ``variance``, ``P(periodic)``; "" of others.
    indices_first : bool
        Whether the design serves sensitivity indices, so that the causes come first.
    no_causes : str
        Reason why no input leads, or "".
    not_halved : str
        Reason why no number under half the scatter of a cause is known, or "".
    checks, next : tuple of str
        Clauses.
    """

    name: str
    title: str
    subject: str
    besides: str
    model: str
    design: str
    rows: int
    failed: int
    row_name: tuple[str, str]
    size: str = ""
    more_rows: str = ""
    no_bound: str = ""
    headline: tuple[Headline, ...] = ()
    assumed: tuple[str, ...] = ()
    assumptions: str = ""
    assumed_causes: tuple[str, ...] = ()
    sources: str = ""
    causes: tuple[LeadingInput, ...] = ()
    levels: tuple[tuple[str, Estimate], ...] = ()
    index: str = ""
    share_of: str = ""
    indices_first: bool = False
    no_causes: str = ""
    not_halved: str = ""
    checks: tuple[str, ...] = ()
    next: tuple[str, ...] = ()

    @property
    def warning(self) -> str:
        """Clause on assumed inputs that set the scale of a life or contribute most, or ""."""
        causes = () if self.besides else self.assumed_causes  # no single input decides a regime
        return scale_warning(self.assumed) or cause_warning(causes)

    @property
    def json(self) -> dict[str, Any]:
        """The card in plain data; numbers in the units of the outputs."""
        causes = (entry for cause in self.causes for entry in cause.json(self.share_of))
        warnings = filter(None, (self.warning, self.assumptions, self.sources))
        return {
            "title": self.title,
            "rows": self.rows,
            "failed": self.failed,
            "headline": [line.json for line in self.headline],
            "assumed": list(self.assumed),
            "causes": list(causes),
            "checks": [*self.checks, *warnings],
            "next": list(self.next),
        }


def card_of(findings: Findings, answer: Answer | None = None) -> Card:
    """Return the card of a result, from its answer if that is known."""
    result, answer = findings.result, answer or conclude(findings)
    attrs, lead = result.dataset.attrs, answer.lead
    ranking = _ranking(answer)
    causes = tuple(_causes(result, answer, ranking))
    leading = [name for cause in causes[:1] for name in cause.contribution.sure]
    assumed_causes = tuple(name for name in leading if mark_of(result, name) == ASSUMED)
    no_causes = ""
    if ranking is not None and not causes:
        no_causes = ranking.reason or "no input contributes measurably"
    return Card(
        result.study.study.name,
        str(attrs["title"]),
        _subject(findings, answer),
        capitalized(lead.words) if answer.regimes_first and lead is not None else "",
        str(attrs["source"]),
        result.design_name,
        answer.rows,
        answer.failed,
        result.row_name,
        _size(result),
        "" if (no_bound := _why_no_bound(result, lead)) else _why_more_rows(result),
        no_bound,
        tuple(headlines(findings, answer)),
        () if lead is None else lead.scaled_by,
        _assumptions(result, assumed_causes),
        assumed_causes,
        _sources(result),
        causes,
        _levels(answer),
        "" if ranking is None else ranking.kind,
        "" if ranking is None else _share_of(ranking, lead is not None and lead.is_life),
        DESIGNS[result.design_name].layout is not PLAIN,
        no_causes,
        _why_not_halved(result, answer, causes),
        tuple(_checks(findings, answer, no_causes)),
        tuple(_next(result, answer)),
    )


def _subject(findings: Findings, answer: Answer) -> str:
    if answer.regimes_first:
        return capitalized(readable(str(findings.result.dataset[REGIME].attrs["long_name"])))
    return "" if answer.lead is None else capitalized(answer.lead.words)


def _counts(result: Result) -> tuple[int, int, int]:
    """Return the numbers of what rows represent, of runs of each, and of rows that are no copy."""
    repeats = result.nesting.repeats
    drawn = len(result.independent) if result.design.crossed else len(result)
    return drawn // repeats, repeats, drawn


def _size(result: Result) -> str:
    """Return the number of what rows represent, and of rows where they differ."""
    count, repeats, drawn = _counts(result)
    rows, names = len(result), counted(count, *result.row_name)
    if count in (0, rows):
        return counted(rows, *result.row_name)
    each = f", {repeats} runs each" if repeats > 1 else ""
    return f"{names}{each}" + (drawn < rows) * f" in {counted(rows, 'row')}"


def _why_more_rows(result: Result) -> str:
    """Return why a crossed design has more rows than what they represent; "" for others."""
    count, _, drawn = _counts(result)
    if count == 0 or drawn == len(result):
        return ""
    names = counted(count, *result.row_name)
    return f"{grouped(len(result))} rows: {names}, copies with other values of some inputs"


def _why_no_bound(result: Result, lead: Quantity | None) -> str:
    """Return why there is a quantile in place of a bound; "" with a bound, or if none is asked."""
    if lead is None or lead.tolerance_bound is None or not lead.tolerance_bound.reason:
        return ""
    if result.analysis.outputs[:1] == (REGIME,):
        return ""
    if lead.events and not lead.is_life and result.analysis.tolerance is None:
        return ""
    reason, (count, repeats, drawn) = lead.tolerance_bound.reason, _counts(result)
    if reason.endswith(DEPENDENT) and drawn < len(result):
        names = counted(count, *result.row_name)
        reason = f"'{result.design_name}' rows ({names} and copies) are dependent"
    elif reason.endswith(DEPENDENT) and repeats > 1:
        reason = f"the {repeats} runs of each {result.row_name[0]} {DEPENDENT}"
    return f"no {bound_name(result, lead, lead.tolerance_bound)}: {reason}"


def _share_of(ranking: Ranking, is_life: bool) -> str:
    if not any(entry.share_of_variance for entry in ranking.contributions):
        return ""
    if ranking.of_event:
        return ranking.target.replace("regime=", "")
    if "logarithm" in ranking.share_of:
        return "log life" if is_life else "logarithm"
    return "rank" if "rank" in ranking.share_of else "variance"


def _assumptions(result: Result, assumed_causes: Sequence[str]) -> str:
    laws = [
        name
        for name, law in result.study.uncertain.items()
        if name in result.dataset.variables and not isinstance(law, Tied)
    ]
    assumed = [name for name in laws if mark_of(result, name) == ASSUMED]
    if not assumed:
        return ""
    among = called_together(assumed_causes)
    text = f"{len(assumed)} of {counted(len(laws), 'law')} assumed"
    return f"{text}, {among} among them" if among and 1 < len(assumed) < len(laws) else text


def _sources(result: Result) -> str:
    """Return what the laws and fixed values rest on, as far as that is little."""
    clauses = [
        f"the law of {called(name)} rests on {counted(count, 'value')}"
        for name, count in few_values(result).items()
    ]
    given = without_source(result)
    if given:
        named = called_together(given) if len(given) <= MOST_NAMED else counted(len(given), "value")
        clauses.append(f"{named} fixed without a source")
    return "; ".join(clauses)


def _ranking(answer: Answer) -> Ranking | None:
    """Return the ranking of the subject of the study."""
    if answer.regimes_first:
        about = answer.regimes[:1] if _levels(answer) else answer.regime_causes
        causes = (regime.ranking for regime in about)
        return next((ranking for ranking in causes if ranking is not None), None)
    return None if answer.lead is None else answer.lead.ranking


def _levels(answer: Answer) -> tuple[tuple[str, Estimate], ...]:
    """Return the variance components of the most frequent regime, if chance leads."""
    leader = None if answer.levels is None else answer.levels.leader
    if answer.levels is None or leader is None or leader.name != CHANCE or not answer.regimes_first:
        return ()
    return tuple((f"{level.words}, in all", level.share) for level in answer.levels.levels)


def _causes(result: Result, answer: Answer, ranking: Ranking | None) -> Iterator[LeadingInput]:
    """Yield the leading causes, each with the same number under half its scatter."""
    if ranking is None or ranking.leader is None:
        return
    lead = None if answer.regimes_first else answer.lead
    compared = [entry for advice in answer.advice for entry in advice.tolerances]
    statistic = ""
    for contribution in ranking.contributions[:MOST_CAUSES]:
        same = [entry for entry in compared if set(entry.inputs) == set(contribution.inputs)]
        if lead is not None and not same and not _are_chosen(result, contribution):
            same = [*tightened(result, lead, contribution.inputs)]
        usable = [entry for entry in same if not entry.reason]
        if lead is not None and usable and not statistic:
            wanted = [entry for entry in compared or usable if entry.is_share != lead.is_life]
            statistic = (wanted or compared or usable)[0].statistic
        shown = (entry for entry in usable if entry.statistic == statistic)
        yield LeadingInput(contribution, next(shown, None) if lead is not None else None)


def _are_chosen(result: Result, contribution: Contribution) -> bool:
    return any(mark_of(result, name) == CHOSEN for name in contribution.inputs)


def _why_not_halved(result: Result, answer: Answer, causes: Sequence[LeadingInput]) -> str:
    """Return why no number under half the scatter of a cause is known; "" if one is."""
    if not causes or any(cause.tightened is not None for cause in causes):
        return ""
    first = causes[0].contribution
    if answer.regimes_first or answer.lead is None:
        return "not estimated for regimes"
    if _are_chosen(result, first):
        are = "is a design choice" if len(first.inputs) == 1 else "are design choices"
        return f"none, {called_together(first.inputs)} {are}"
    if not halvings(result, first.inputs):
        return f"none, the law of {called_together(first.inputs)} has no width to halve"
    if not DESIGNS[result.design_name].follows_laws:
        return f"not estimated from a '{result.design_name}' design"
    reasons = (entry.reason for entry in tightened(result, answer.lead, first.inputs))
    return next(filter(None, reasons), "no number of the study to compare")


def _checks(findings: Findings, answer: Answer, no_causes: str) -> Iterator[str]:
    result, enough, lead = findings.result, answer.enough, answer.lead
    _, plural = result.row_name
    if answer.failed:
        share = percent(answer.failed / max(answer.rows, 1))
        codes = np.unique(result.dataset["status"].values[result.failed])
        kinds = ", ".join(Status(code).label for code in codes)
        yield f"{share} of the {plural} are invalid ({kinds}) and left out"
    if findings.summary.why_ended:
        yield findings.summary.why_ended
    if enough.unknown:
        yield f"sample size cannot be judged: {enough.unknown}"
    elif enough.question:
        clause = enough.question[0][0]
        clause = clause.partition(":")[0] if clause == no_causes else clause
        yield f"not settled: {clause}" if enough.errors else f"too few {plural}: {clause}"
    else:
        yield f"enough {plural}" + " but for the invalid ones" * bool(answer.failed)
    if enough.errors is not None:
        numerical = enough.unit.text(enough.errors.numerical, inf)
        yield (
            f"numerical error of the {enough.errors.estimate}, up to {numerical}, exceeds its"
            " sampling error"
        )
    error = {} if lead is None or lead.own_error is None else lead.own_error.members
    if error.get("rows_missing_it"):
        share, accuracy = percent(error["rows_missing_it"]), 100 * error["accuracy"]
        yield f"{share} have numerical errors above {accuracy:g} %"
    if answer.regimes and not answer.regimes_first:
        first = answer.regimes[0]
        yield f"{percent(first.share.value)} of responses are {first.predicate}"


def _next(result: Result, answer: Answer) -> Iterator[str]:
    """Yield each piece of advice in a few words, the most urgent first, more rows second."""
    advice = answer.advice
    first, others = [*advice[:1]], [*advice[1:]]
    for entry in first + sorted(others, key=lambda entry: entry.rule != "rows"):
        words = called_together(entry.inputs) if entry.inputs else ""
        match entry.rule:
            case "measure":
                yield f"measure {words}"
            case "tighten" if entry.tightened is not None and not entry.tightened.reason:
                yield f"tighten {words}{_with_tied(result, entry.inputs)}"
            case "chance":
                yield f"expect little of tolerances: {_chance(answer)}"
            case "source":
                verb = "is" if len(entry.inputs) == 1 else "are"
                yield f"state in 'source' how {words} {verb} known"
            case "rows" if entry.rows is not None:
                yield _more_rows(result, entry.rows)
            case "failed":
                again = f"uq rerun {result.file} --failed{result.model_option}"
                yield f"fix the invalid rows, then {again}"
            case "finer":
                finer = answer.enough.setting or "use finer settings"
                yield f"{finer}, not more {result.row_name[1]}"
            case "keep":
                place = entry.place.replace("between ", "in ").replace(" and ", " to ")
                there = re.sub(r" \([^)]*\)| in magnitude", "", entry.there)
                yield f"keep {words} {place}: there {there}"
            case "nothing" if len(advice) == 1:
                yield "nothing: the question is settled"


def _with_tied(result: Result, inputs: Sequence[str]) -> str:
    """Return the inputs that equal one of these in every row, in words after it; or ""."""
    tied = [*tied_to(result, inputs)]
    return f" (with {called_together(tied)}, which equals it)" if tied else ""


def _chance(answer: Answer) -> str:
    """Return the share of the variance that chance explains, or the starts, and of what."""
    leader = None if answer.levels is None else answer.levels.leader
    if answer.levels is None or leader is None:
        return "chance decides"
    if answer.regimes_first:  # the card has the shares
        others = " and ".join(level.words for level in answer.levels.levels[1:])
        return f"{leader.words} matter{'s' * leader.explains.endswith('s')} more than {others}"
    share = f"{percent(leader.share.value)} of {answer.levels.variance}"
    return f"{leader.words} {leader.explains} {share}"


def _more_rows(result: Result, rows: int) -> str:
    """Return the advice on a number of rows, with the samples of a design of several rows each."""
    rows, samples = rounded_size(rows, result)
    if samples == rows:
        return f"{STUDY} about {rows_in_words(rows)} {result.row_name[1]} in all"
    return f"{STUDY} {grouped(rows)} rows in all (set samples = {samples})"


def statistic_name(tolerance: TighterTolerance) -> str:
    """Return the number that a tolerance changes, in a few words."""
    event = tolerance.statistic.removeprefix("the ").removeprefix("share of rows that ")
    return event.replace("exceed", "beyond").removeprefix("fail ").removesuffix(" in magnitude")
