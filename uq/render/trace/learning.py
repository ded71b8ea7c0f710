"""The numbers of `uq update` and their origins."""

from collections.abc import Callable
from typing import Any

from uq.assess.population import Population
from uq.learning.answer import learnt, learnt_json
from uq.learning.epistemic_band import over_shared
from uq.learning.information_gain import taught
from uq.learning.posterior import posterior
from uq.learning.posterior_inputs import confounded, inputs_learnt, quantiles
from uq.learning.prior_predictive import strangeness
from uq.learning.remaining_life import read_times, remaining
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin
from uq.result.result import Result
from uq.stats.importance_weights import effective_rows, tail_shape
from uq.stats.weighted_means import moments_of_rows
from uq.text.keys import Json, Options, Path

_PARTS: dict[str, Callable[..., Any]] = {
    "effective_rows": effective_rows,
    "pareto_k": tail_shape,
    "confounded": confounded,
    "taught": taught,
    "strangeness": strangeness,
}


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the posterior numbers."""
    texts = [options["by"]] if "by" in options else []
    return learnt_json(learnt(result, read_times("by", texts, result)))


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a posterior number."""
    by: list[Callable[..., Any]] = [posterior]
    if path[0] == "inputs":
        by += [inputs_learnt, quantiles if "quantiles" in path else moments_of_rows]
    elif path[0] in ("units", "uninspected"):
        by += [remaining, over_shared if "over_shared" in path else Population]
    elif path[0] in _PARTS:
        by.append(_PARTS[path[0]])
    return Origin(tuple(map(cited, by)), result.independent, notes=tuple(document["notes"]))
