"""The numbers of `uq sensitivity`, and where they come from."""

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from uq.indices.as_json import sensitivity_json
from uq.indices.chosen import chosen
from uq.indices.samples import sample_of
from uq.indices.sensitivities import sensitivities
from uq.keys import Json, Options, Path
from uq.methods.registry import METHODS
from uq.rows.in_regime import within_regime
from uq.rows.nesting import one_of_each_sample
from uq.rows.ranked import ranked_rows
from uq.tracing.citations import Citation, cited
from uq.tracing.origin import Origin


def says(ds: xr.Dataset, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the indices: of the target alone that a path names, if it names one."""
    named = [path[1]] if path[:1] == ("outputs",) and path[1:] else None
    found = sensitivities(ds, options.get("method"), named, options.get("regime"))
    return sensitivity_json(found)


def origin(ds: xr.Dataset, options: Options, path: Path, said: Json) -> Origin:
    """Return where an index comes from."""
    if regime := options.get("regime"):
        ds = within_regime(ds, regime)
    rows = one_of_each_sample(ranked_rows(ds))
    by = (estimator_of(said["method"], *path[2:3]),)
    if path[0] != "outputs":
        return Origin(by, rows)
    entry = said["outputs"][path[1]]
    (target,) = chosen(rows, said["method"], [path[1]])
    sample = replace(sample_of(rows), values=target.values)
    states = {"in groups with a value in each row": len(np.unique(sample.groups[sample.whole]))}
    dropped = len(np.unique(sample.groups[~sample.whole]))
    states |= {"in groups that lack one, dropped": dropped} if dropped else {}
    return Origin(by, rows, states, tuple(entry.get("notes", ())))


def estimator_of(method: str, key: str = "") -> Citation:
    """Return what a method estimates, and whose estimator it is.

    Parameters
    ----------
    method : str
    key : str
        Of the kind of index; "" if not one of its own.
    """
    own = METHODS[method]
    kinds = [f" ({kind.words})" for kind in own.kinds if kind.key == key]
    code = f"uq.methods.registry.METHODS['{method}']"
    said = [own.source, own.intervals and f"intervals: {own.intervals}"]
    sources = (*filter(None, said), *cited(own.estimate).sources)
    return Citation(f"{own.question}{''.join(kinds)}", code, sources)
