"""The verbs whose numbers have keys. To add one, write the function that returns its facts."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from uq.assess.answer.answer import conclude, regimes_of, without_advice
from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.quantities import quantities
from uq.assess.chosen_targets import chosen, output_in
from uq.assess.components_by_level import by_level
from uq.assess.convergence import (
    convergence_facts,
    converging,
    enough,
    errors_facts,
    estimates_from,
    running_fact,
)
from uq.assess.design_sample import sample_of
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.fleet import fleet_facts, fleet_of, lifetime_element
from uq.assess.regimes import BOUNDARY, boundary, boundary_facts
from uq.assess.sampled_laws import inputs_facts
from uq.assess.sensitivities import sensitivities
from uq.assess.sensitivity_table import sensitivity_facts
from uq.assess.summary import summarise
from uq.assess.summary_facts import levels_facts, summary_facts
from uq.assess.targets import split_name
from uq.assess.two_fidelities import twin_facts, with_twin
from uq.assess.what_if import read_changes, reweighted_summary, what_if_facts
from uq.errors import InputError
from uq.learning.answer import learnt, learnt_facts
from uq.learning.remaining_life import read_times
from uq.result.result import Result
from uq.text.keys import SUMMARY, Options, Path
from uq.text.quantities import read_threshold

COUNTED = ("failed", "undefined", "censored", "never")

Facts = Callable[[Result, Options, Path], Fact]
"""Result, options, path -> facts of a verb, as far as the path needs them."""


def _named(path: Path, *within: str) -> str:
    """Return the output, element or target named by a path in the JSON of a verb, or ""."""
    return path[1] if path[1:] and path[0] in within else ""


def _summary(result: Result, options: Options, path: Path) -> Fact:
    """Return a summary, limited to the output of a path, with fits if the path needs them."""
    if path[:1] == (BOUNDARY,):
        return boundary_facts(result, boundary(result))
    names = result.output_names
    output = _named(path, "outputs", "categories").partition("[")[0]
    if path and path[0] not in ("outputs", "categories"):
        output = next(iter(names))  # counts and regimes need no output
    analysis = result.analysis_of(output if output in names else None)
    regime, fits = options.get("regime"), "fits" in path
    return summary_facts(summarise(result, analysis, regime=regime, fits=fits), of_reports=True)


def _inside(path: Path) -> str:
    """Return the output or element named by a path, directly or within a target, or ""."""
    name = _named(path, "outputs", "quantities")
    return split_name(name)[1] if name else ""


def _answer(result: Result, options: Options, path: Path) -> Fact:
    """Return the answer, limited to the quantity or part named by a path."""
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


def _of_independent_rows(facts: Facts) -> Facts:
    """Return a function for the same facts, which only the independent rows suffice to compute."""

    def marked(result: Result, options: Options, path: Path) -> Fact:
        return replace(facts(result, options, path), rows=result.independent)

    return marked


@_of_independent_rows
def _inputs(result: Result, options: Options, path: Path) -> Fact:
    return inputs_facts(result, *path[:1])


def _sensitivity(result: Result, options: Options, path: Path) -> Fact:
    name, regime = _named(path, "outputs"), options.get("regime")
    names = [name] if name else None
    return sensitivity_facts(sensitivities(result, options.get("method"), names, regime))


@_of_independent_rows
def _levels(result: Result, options: Options, path: Path) -> Fact:
    return levels_facts(by_level(result, output_in(_inside(path)) or None))


@_of_independent_rows
def _fleet(result: Result, options: Options, path: Path) -> Fact:
    try:
        size, allow = int(options.get("size", "")), int(options.get("allow", "0"))
    except ValueError:
        raise InputError(
            "a key of a fleet begins with fleet[size=N], or with by=T, allow=K, output=LIFE as well"
        ) from None
    output, by = options.get("output"), list[float]()
    if "by" in options:
        units = lifetime_element(result.independent, output).declared.unit
        by = [read_threshold("by", options["by"], "a life", units)]
    return fleet_facts(fleet_of(result, size, by, allow, output))


@_of_independent_rows
def _update(result: Result, options: Options, path: Path) -> Fact:
    times = read_times("by", [options["by"]] if "by" in options else [], result)
    return learnt_facts(learnt(result, times))


@_of_independent_rows
def _convergence(result: Result, options: Options, path: Path) -> Fact:
    """Return running estimates, or only the errors if the path names one."""
    name = _inside(path) or None
    if path[2:] and path[2] != "estimates":
        errors = enough(result, name).to_dict("index")
        return Fact({"outputs": {name: errors_facts(line) for name, line in errors.items()}})
    return convergence_facts(converging(result, name))


def _convergence_again(rows: Result, options: Options, path: Path) -> Any:
    """Return the value at a path; for running estimates, the last one."""
    if path[2] != "estimates":
        return _convergence(rows, options, path).at(*path).json
    lines = estimates_from(rows, [path[1]])
    line = next(line for line in lines if (line.output, line.label) == (path[1], path[3]))
    return running_fact(int(rows.dataset["group"].max()) + 1, line).at(*path[5:]).json


@_of_independent_rows
def _twin(result: Result, options: Options, path: Path) -> Fact:
    return twin_facts(with_twin(result, options.get("model")))


def _what_if(result: Result, options: Options, path: Path) -> Fact:
    changes = read_changes([f"{name}={value}" for name, value in options.items()])
    return what_if_facts(reweighted_summary(result, changes))


def states_of_element(rows: Result, facts: Fact, path: Path) -> dict[str, int]:
    """Return the number of rows by state (value, failed, censored, ...) for the element of a path.

    If the path names no element, use the element common to all facts; empty if there is none.
    """
    name = _inside(path) or facts.members.get("output", "")
    if not name or output_in(name) != name:  # of a category
        return {}
    (element,) = rows.named_elements(name)
    counts = {name: int(getattr(element, name).sum()) for name in COUNTED}
    nonzero = {name: count for name, count in counts.items() if count}
    return {"with a value": int(element.present.sum())} | nonzero


def _states_of_groups(rows: Result, facts: Fact, path: Path) -> dict[str, int]:
    """Return the number of row groups with all values, and the number of dropped groups."""
    if path[0] != "outputs":
        return {}
    (target,) = chosen(rows, facts.members["method"], [path[1]])
    sample = replace(sample_of(rows), values=target.values)
    states = {"in groups with a value in each row": len(np.unique(sample.groups[sample.whole]))}
    dropped = len(np.unique(sample.groups[~sample.whole]))
    return states | ({"in groups that lack one, dropped": dropped} if dropped else {})


def _no_states(rows: Result, facts: Fact, path: Path) -> dict[str, int]:
    return {}


class Verb(NamedTuple):
    """Verb whose numbers have keys.

    Attributes
    ----------
    facts : Facts
    options : tuple of str
        Options of the command that change its numbers; names that end with a dot are prefixes.
    states : callable
        Rows, facts, path -> how many of the rows behind a number have a value, failed and so on.
    again : callable, optional
        Rows, options, path -> the JSON at the path from these rows, where it does not stand at the
        same path of their facts.
    """

    facts: Facts
    options: tuple[str, ...] = ()
    states: Callable[[Result, Fact, Path], dict[str, int]] = states_of_element
    again: Callable[[Result, Options, Path], Any] | None = None


VERBS: dict[str, Verb] = {
    SUMMARY: Verb(_summary, ("regime",)),
    "answer": Verb(_answer),
    "inputs": Verb(_inputs, (), _no_states),
    "sensitivity": Verb(_sensitivity, ("method", "regime"), _states_of_groups),
    "levels": Verb(_levels),
    "fleet": Verb(_fleet, ("size", "by", "allow", "output")),
    "update": Verb(_update, ("by",), _no_states),
    "convergence": Verb(_convergence, (), _no_states, _convergence_again),
    "twin": Verb(_twin),
    "what-if": Verb(_what_if, ("uncertain.", "dependence.")),
}
"""By name; the answer is a part of the summary, and a report shows the inputs."""
