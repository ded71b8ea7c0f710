"""The numbers of the answer and their origins."""

from collections.abc import Callable, Iterator
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
from uq.assess.findings import Findings
from uq.assess.joint_bounds import SIDES
from uq.assess.population import Population
from uq.assess.regime_boundary import compared_rows
from uq.assess.regime_switching import switching
from uq.assess.solver_error import error_share, off_by_error, stating_none
from uq.assess.statistics.counts import accuracy, never_ending
from uq.assess.summary import status_counts, summarise
from uq.assess.targets import split_name
from uq.assess.what_if import what_if
from uq.render.trace.citations import Citation, cited
from uq.render.trace.indices import estimator_of
from uq.render.trace.origin import Origin
from uq.render.trace.summary import functions_of, states_of
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


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a number of the answer."""
    part, *names = path
    if part in ("rows", "failed"):
        return Origin((cited(status_counts),), result)
    if part == "intermingled":
        return Origin((cited(uncertainty_exponent),), compared_rows(result))
    if part == "levels":
        return Origin((cited(switching if "another_regime" in names else nested_shares),), result)
    if part == "enough":
        if "error" in names[-1]:
            return Origin((cited(compared),), result.independent)
        return Origin((cited(found_again), cited(share_interval)), result)
    if part == "advice":
        return Origin((cited(what_if if "tolerances" in names else unsettled),), result)
    if "ranking" in names:
        ranking = value_at(document, path[: path.index("ranking") + 1])
        index = estimator_of(ranking["method"], ranking["index"])
        if "effects" in names:
            return Origin((cited(effects),), result)
        return Origin((index,), result, notes=tuple(_notes(result)))
    if "earliest" in names:
        return Origin((cited(inputs_apart),), result)
    if "limit" in names:
        return Origin((cited(limit_of), cited(event_curve), cited(share_interval)), result)
    if "parts" in names or "decided_by" in names:
        return Origin((cited(event_curve), cited(share_interval)), result)
    rows = result.independent
    if part == "regimes":
        statistic = summarise(result, result.analysis).regimes[names[0]]
        return Origin(tuple(map(cited, statistic.by)), rows)
    states = states_of(rows.named_elements(names[0])[0])
    return Origin(
        tuple(dict.fromkeys(_estimators(result, document["quantities"][names[0]], *names))),
        rows,
        states,
    )


def _notes(result: Result) -> Iterator[str]:
    """Yield the note that an index rests on one row per sample, where samples have several rows."""
    if result.is_nested:
        used = len(result.first_rows)
        yield f"the index rests on {grouped(used)} of these rows, the first of each sample"


def _estimators(
    result: Result, entry: Json, name: str, part: str, *rest: str
) -> Iterator[Citation]:
    """Yield the estimators of a number of a promise, range, event or prediction interval."""
    asked = with_bounds(result.analysis_of(name.partition("[")[0]), Findings(result))
    described = summarise(result, asked).outputs[name]
    keys: list[Path] = [("quantiles", repr(LOW))]
    if part == "another_seed":
        yield cited(found_again)
        promised = entry["promise"]["sentence"] if "promise" in entry else ""
        part, rest = ("range", ()) if promised else ("events", tuple(entry["events"]))
    if part == "own_error":
        yield from map(
            cited, _ERROR_ESTIMATORS.get("".join(rest), (off_by_error, error_share, accuracy))
        )
        keys *= any(end in rest for end in ("lower", "upper"))
        if keys and not entry["promise"]["reason"]:
            keys = [("tolerance", "lower")]
    elif part == "range" and "".join(rest).startswith("never"):
        yield from map(cited, (never_ending, Population if result.has_weights else share_interval))
        keys = []
    elif part == "promise" and "".join(rest).startswith("share_at"):
        yield cited(piles)
        keys = []
    elif part == "promise":
        joint = asked.joint_bounds.get(name.partition("[")[0])
        bound = ("joint_bounds", SIDES[joint][0]) if joint else ("tolerance", "lower")
        keys = [bound] * ("quantile" not in "".join(rest)) + keys
    elif part == "events":
        side = "below" if "<" in rest[0] else "above"
        keys = [("thresholds", split_name(rest[0])[2], side)]
    for key in keys:
        yield from map(cited, functions_of(described, key))
