"""The numbers of `uq update`, and where they come from."""

from collections.abc import Callable
from typing import Any

import xarray as xr

from uq.keys import Json, Options, Path
from uq.learning.answer import learnt, learnt_json
from uq.learning.asked_times import read_times
from uq.learning.inputs_learnt import confounded, inputs_learnt, quantiles
from uq.learning.over_shared import over_shared
from uq.learning.posterior import posterior
from uq.learning.remaining import remaining
from uq.learning.strangeness import strangeness
from uq.learning.taught import taught
from uq.population.functionals import Population
from uq.population.means import moments_of_rows
from uq.population.smoothing import effective_rows, tail_shape
from uq.rows.elements import independent_rows
from uq.tracing.citations import cited
from uq.tracing.origin import Origin

_PARTS: dict[str, Callable[..., Any]] = {
    "effective_rows": effective_rows,
    "pareto_k": tail_shape,
    "confounded": confounded,
    "taught": taught,
    "strangeness": strangeness,
}


def says(ds: xr.Dataset, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of what inspections say."""
    texts = [options["by"]] if "by" in options else []
    return learnt_json(learnt(ds, read_times("by", texts, ds)))


def origin(ds: xr.Dataset, options: Options, path: Path, said: Json) -> Origin:
    """Return where a number that inspections say comes from."""
    by: list[Callable[..., Any]] = [posterior]
    if path[0] == "inputs":
        by += [inputs_learnt, quantiles if "quantiles" in path else moments_of_rows]
    elif path[0] in ("units", "uninspected"):
        by += [remaining, over_shared if "over_shared" in path else Population]
    elif path[0] in _PARTS:
        by.append(_PARTS[path[0]])
    return Origin(tuple(map(cited, by)), independent_rows(ds), notes=tuple(said["notes"]))
