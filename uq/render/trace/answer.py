"""The numbers of the answer and their origins."""

from functools import partial
from typing import Any

from uq.assess.answer.answer import conclude, regimes_of, without_advice
from uq.assess.answer.facts import Answer
from uq.assess.answer.quantities import quantities
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.indices.methods import indices_of
from uq.render.trace.citations import Citation, cited
from uq.render.trace.indices import estimator_of
from uq.render.trace.origin import Origin
from uq.render.trace.summary import states_of
from uq.result.result import Result
from uq.text.keys import Json, Options, Path


def facts(result: Result, options: Options, path: Path) -> Fact:
    """Return the facts of the answer: of the quantity or the part alone that a path names."""
    findings = Findings(result)
    part, *names = path or ("",)
    alone = not result.is_nested  # variance components change the sentences on regimes
    if part == "quantities" and names and alone:
        answered = tuple(quantities(findings, names[0]))
        return Answer("", 0, 0, answered, (), (), result=result).fact
    if part == "regimes" and alone:
        occurring = tuple(regimes_of(findings))
        return Answer("", 0, 0, (), occurring, (), result=result).fact
    if part in ("rows", "failed"):
        return Answer("", len(result), int(result.failed.sum()), (), (), ()).fact
    return (conclude if part in ("", "advice") else without_advice)(findings).fact


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the answer, as far as the path needs it."""
    return facts(result, options, path).json


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a number of the answer."""
    place = facts(result, options, path).at(*path)
    rows = result if place.rows is None else place.rows
    of_element = path[0] == "quantities" and place.rows is not None
    states = states_of(rows.named_elements(path[1])[0]) if of_element else {}
    return Origin(tuple(map(_cited, place.by)), rows, states, place.notes)


def _cited(function: Any) -> Citation:
    """Return the citation of a function, of an index that of its method."""
    if isinstance(function, partial) and function.func is indices_of:
        return estimator_of(*function.args)
    return cited(function)
