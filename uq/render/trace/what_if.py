"""The numbers of `uq what-if` and their origins."""

from typing import Any

from uq.assess.what_if import WhatIf, answer, read_changes, what_if, what_if_json
from uq.render.trace import summary
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin
from uq.result.result import Result
from uq.text.keys import Json, Options, Path


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of a result under the laws that the options set."""
    return what_if_json(_answer(result, options))


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a number under other laws."""
    rows = result.independent
    if path[0] in ("samples", "status", "rows_used"):
        return summary.origin(result, {}, path, document)
    if path[0] in ("effective_rows", "pareto_k"):
        return Origin((cited(what_if), cited(summary.WEIGHTS[path[0]])), rows)
    base = summary.summary_origin(_answer(result, options).summary, rows, path)
    return Origin((cited(what_if), *base.estimators), rows, base.states)


def _answer(result: Result, options: Options) -> WhatIf:
    return answer(result, read_changes([f"{name}={value}" for name, value in options.items()]))
