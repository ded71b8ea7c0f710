"""Running estimates of each output, and the errors of all rows, as a tree of facts."""

from collections.abc import Mapping
from typing import Any

from uq.assess.convergence import RunningEstimate, enough, running
from uq.assess.fact import Fact
from uq.result.result import Result
from uq.stats import estimate_json

Sizes = list[tuple[int, RunningEstimate]]
"""Number of samples, and the estimate from them."""

Converging = tuple[dict[str, Sizes], Mapping[Any, Any] | None]
"""Estimates of an output, or of its transform, by label; its line of `uq.enough`, if it has one."""


def converging(result: Result, output: str | None = None) -> dict[str, Converging]:
    """Return the running estimates of a result by output and label.

    Parameters
    ----------
    result : Result
    output : str, optional
        As for `uq.running_estimates`.
    """
    estimates = dict[str, dict[str, Sizes]]()
    for samples, line in running(result, output):
        estimates.setdefault(line.output, {}).setdefault(line.label, []).append((samples, line))
    errors = enough(result, output).to_dict("index")
    return {name: (by_label, errors.get(name)) for name, by_label in estimates.items()}


def convergence_facts(outputs: Mapping[str, Converging]) -> Fact:
    """Return running estimates, and the errors of all rows."""
    members = {}
    for name, (estimates, errors) in outputs.items():
        facts = {
            label: [running_fact(*size) for size in sizes] for label, sizes in estimates.items()
        }
        members[name] = {"estimates": facts} | errors_facts(errors)
    return Fact({"outputs": members})


def running_fact(samples: int, line: RunningEstimate) -> Fact:
    """Return the estimate from a number of samples."""
    members = {"samples": samples} | estimate_json.numbers(line.estimate)
    return Fact(members, line.by, rows=line.rows)


def errors_facts(errors: Mapping[Any, Any] | None) -> dict[str, Any]:
    """Return a line of `uq.enough`; nothing without one."""
    if not errors:
        return {}
    return {
        "sampling_error": Fact(estimate_json.number(errors["sampling"]), (enough,)),
        "own_error": Fact(estimate_json.number(errors["own"]), (enough,)),
        "warning": errors["warning"],
    }
