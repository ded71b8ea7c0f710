"""The numbers of `uq what-if`, and where they come from."""

from typing import Any

import xarray as xr

from uq.analysis.what_if import answer, read_changes, what_if, what_if_json
from uq.keys import Json, Options, Path
from uq.rows.elements import independent_rows
from uq.tracing import of_summary
from uq.tracing.citations import cited
from uq.tracing.origin import Origin


def says(ds: xr.Dataset, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of a result under the laws that the options set."""
    changes = [f"{name}={value}" for name, value in options.items()]
    return what_if_json(answer(ds, read_changes(changes)))


def origin(ds: xr.Dataset, options: Options, path: Path, said: Json) -> Origin:
    """Return where a number under other laws comes from."""
    weighted = Origin((cited(what_if),), independent_rows(ds))
    if path[0] not in ("outputs", "regime", "samples", "status"):
        return weighted
    found = of_summary.origin(ds, {}, path, said)
    return Origin(weighted.estimators + found.estimators, found.rows, found.states)
