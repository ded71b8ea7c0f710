"""The numbers of `uq what-if`, and where they come from."""

from typing import Any

import xarray as xr

from uq.analysis.what_if import WhatIf, answer, read_changes, what_if, what_if_json
from uq.keys import Json, Options, Path
from uq.rows.elements import independent_rows
from uq.tracing import of_summary
from uq.tracing.citations import cited
from uq.tracing.origin import Origin


def says(ds: xr.Dataset, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of a result under the laws that the options set."""
    return what_if_json(_answer(ds, options))


def origin(ds: xr.Dataset, options: Options, path: Path, said: Json) -> Origin:
    """Return where a number under other laws comes from."""
    rows = independent_rows(ds)
    if path[0] in ("samples", "status", "rows_used"):
        return of_summary.origin(ds, {}, path, said)
    if path[0] in ("effective_rows", "pareto_k"):
        return Origin((cited(what_if), cited(of_summary.WEIGHTS[path[0]])), rows)
    found = of_summary.in_summary(_answer(ds, options).summary, rows, path)
    return Origin((cited(what_if), *found.estimators), rows, found.states)


def _answer(ds: xr.Dataset, options: Options) -> WhatIf:
    return answer(ds, read_changes([f"{name}={value}" for name, value in options.items()]))
