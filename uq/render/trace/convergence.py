"""The numbers of `uq convergence` and their origins."""

from typing import Any

from uq.assess.convergence import enough, estimates_from, method_shown
from uq.assess.running_estimates import converging
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import summarise
from uq.assess.summary_json import convergence_json, errors_json
from uq.assess.targets import split_name
from uq.render.trace.citations import cited
from uq.render.trace.indices import estimator_of
from uq.render.trace.origin import Origin
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.keys import Json, Options, Path, value_at


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of running estimates, of one element if the path names one.

    Only the errors if the path names one: every design has them.
    """
    named = split_name(path[1])[1] if path[:1] == ("outputs",) and path[1:] else None
    if path[2:] and path[2] != "estimates":
        errors = enough(result, named).to_dict("index")
        return {"outputs": {name: errors_json(record) for name, record in errors.items()}}
    return convergence_json(converging(result, named))


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a running estimate."""
    _, target, kind, *rest = path
    if kind != "estimates":
        return Origin((cited(enough),), result.independent)
    label, place = rest[0], int(rest[1])
    rows = result.first_samples(document["outputs"][target]["estimates"][label][place]["samples"])
    described = summarise(rows).outputs.get(target)
    for name, statistics in described.parts.items() if described else ():
        for statistic in statistics:
            if statistic.label == label:
                by = tuple(map(cited, statistic.by or (STATISTICS[name],)))
                return Origin(by, rows.independent)
    method = method_shown(result)
    assert method is not None
    return Origin((estimator_of(method, label.split()[0]),), rows)


def again(verb: Any, number_origin: Origin, options: Options, path: Path) -> Any:
    """Return the entry at a path from the rows of its origin: the estimate of the last size."""
    if path[2] != "estimates":
        errors = enough(number_origin.rows, path[1]).to_dict("index")[path[1]]
        return value_at(errors_json(errors), path[2:])
    for name, label, numbers, *_ in estimates_from(number_origin.rows, [path[1]]):
        if (name, label) == (path[1], path[3]):
            entry = {
                "samples": int(number_origin.rows.dataset["group"].max()) + 1
            } | estimate_json.numbers(Estimate(*numbers))
            return value_at(entry, path[5:])
    raise KeyError(path[3])
