"""The numbers of the answer and their origins."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from uq.assess.answer.answer import conclude, regimes_of, without_advice
from uq.assess.answer.answer_json import answer_json
from uq.assess.answer.facts import Answer
from uq.assess.answer.limits import limit_of
from uq.assess.answer.promised_bounds import piles
from uq.assess.answer.quantities import LOW, quantities, with_bounds
from uq.assess.answer.repeat_interval import found_again
from uq.assess.answer.sample_size import unsettled
from uq.assess.convergence import compared
from uq.assess.earliest import inputs_apart
from uq.assess.effects import effects
from uq.assess.event_curve import event_curve
from uq.assess.fact import Fact, Functions
from uq.assess.findings import Findings
from uq.assess.joint_bounds import SIDES
from uq.assess.population import Population
from uq.assess.regime_boundary import compared_rows
from uq.assess.regime_switching import switching
from uq.assess.solver_error import error_share, off_by_error, stating_none
from uq.assess.statistics.counts import accuracy, never_ending
from uq.assess.summary import status_counts, summarise
from uq.assess.summary_json import summary_facts
from uq.assess.targets import split_name
from uq.assess.what_if import what_if
from uq.indices.methods import indices_of
from uq.result.result import Result
from uq.stats.intervals import share_interval
from uq.stats.uncertainty_exponent import uncertainty_exponent
from uq.stats.variance_components import nested_shares
from uq.text.keys import Json, Options, Path, value_at
from uq.text.numbers import grouped

_ERROR_ESTIMATORS: dict[str, tuple[Callable[..., Any], ...]] = {
    "lower": (off_by_error,),
    "upper": (off_by_error,),
    "share_of_variance": (error_share,),
    "accuracy": (accuracy,),
    "rows_missing_it": (accuracy,),
    "rows_stating_none": (stating_none,),
}


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the answer: of the quantity or the part alone that a path names."""
    findings = Findings(result)
    part, *names = path or ("",)
    alone = not result.is_nested  # variance components change the sentences on regimes
    if part == "quantities" and names and alone:
        answered = tuple(quantities(findings, names[0]))
        return answer_json(Answer("", 0, 0, answered, (), ()))
    if part == "regimes" and alone:
        return answer_json(Answer("", 0, 0, (), tuple(regimes_of(findings)), ()))
    if part in ("rows", "failed"):
        return answer_json(Answer("", len(result), int(result.failed.sum()), (), (), ()))
    whole = conclude if part in ("", "advice") else without_advice
    return answer_json(whole(findings))


def facts(result: Result, options: Options, path: Path) -> Fact:
    """Return the facts of the answer: of the quantity or the part alone that a path names."""
    document = json_of(result, options, path)
    by, rows, notes = _origin(result, path, document) if path else ((), None, ())
    return Fact(document, by, rows=rows, notes=notes)


def _origin(
    result: Result, path: Path, document: Json
) -> tuple[Functions, Result | None, tuple[str, ...]]:
    """Return functions, rows (None for all) and notes of a number of the answer."""
    part, *names = path
    if part in ("rows", "failed"):
        return (status_counts,), None, ()
    if part == "intermingled":
        return (uncertainty_exponent,), compared_rows(result), ()
    if part == "levels":
        return (switching if "another_regime" in names else nested_shares,), None, ()
    if part == "enough":
        if "error" in names[-1]:
            return (compared,), result.independent, ()
        return (found_again, share_interval), None, ()
    if part == "advice":
        return (what_if if "tolerances" in names else unsettled,), None, ()
    if "ranking" in names:
        ranking = value_at(document, path[: path.index("ranking") + 1])
        if "effects" in names:
            return (effects,), None, ()
        return (
            (partial(indices_of, ranking["method"], ranking["index"]),),
            None,
            tuple(_notes(result)),
        )
    if "earliest" in names:
        return (inputs_apart,), None, ()
    if "limit" in names:
        return (limit_of, event_curve, share_interval), None, ()
    if "parts" in names or "decided_by" in names:
        return (event_curve, share_interval), None, ()
    rows = result.independent
    if part == "regimes":
        statistic = summarise(result, result.analysis).regimes[names[0]]
        return statistic.by, rows, ()
    by = tuple(dict.fromkeys(_estimators(result, document["quantities"][names[0]], *names)))
    return by, rows, ()


def _notes(result: Result) -> Iterator[str]:
    """Yield the note that an index rests on one row per sample, where samples have several rows."""
    if result.is_nested:
        used = len(result.first_rows)
        yield f"the index rests on {grouped(used)} of these rows, the first of each sample"


def _estimators(
    result: Result, entry: Json, name: str, part: str, *rest: str
) -> Iterator[Callable[..., Any]]:
    """Yield the estimators of a number of a promise, range, event or prediction interval."""
    asked = with_bounds(result.analysis_of(name.partition("[")[0]), Findings(result))
    described = summary_facts(summarise(result, asked), of_reports=True)
    keys: list[Path] = [("quantiles", repr(LOW))]
    if part == "another_seed":
        yield found_again
        promised = entry["promise"]["sentence"] if "promise" in entry else ""
        part, rest = ("range", ()) if promised else ("events", tuple(entry["events"]))
    if part == "own_error":
        yield from _ERROR_ESTIMATORS.get("".join(rest), (off_by_error, error_share, accuracy))
        keys *= any(end in rest for end in ("lower", "upper"))
        if keys and not entry["promise"]["reason"]:
            keys = [("tolerance", "lower")]
    elif part == "range" and "".join(rest).startswith("never"):
        yield from (never_ending, Population if result.has_weights else share_interval)
        keys = []
    elif part == "promise" and "".join(rest).startswith("share_at"):
        yield piles
        keys = []
    elif part == "promise":
        joint = asked.joint_bounds.get(name.partition("[")[0])
        bound = ("joint_bounds", SIDES[joint][0]) if joint else ("tolerance", "lower")
        keys = [bound] * ("quantile" not in "".join(rest)) + keys
    elif part == "events":
        side = "below" if "<" in rest[0] else "above"
        keys = [("thresholds", split_name(rest[0])[2], side)]
    for key in keys:
        try:
            yield from described.at("outputs", name, *key).by
        except KeyError:  # there is no such number
            yield from described.at("outputs", name, key[0]).by
