"""The numbers of the inputs that a report shows and their origins."""

from typing import Any

from uq.assess.sampled_inputs import PROBABILITIES, compare, laws_and_values, weights_of_samples
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin
from uq.result.result import Result
from uq.stats.estimate_json import number
from uq.text.keys import Json, Options, Path


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return quantiles of the inputs: of their laws as ``stated``, and as ``sampled``."""
    given, weights = laws_and_values(result), weights_of_samples(result)
    entries = {}
    for name in path[:1] if set(path[:1]) & set(given) else given:
        comparison = compare(*given[name], weights)
        quantiles = {
            kind: dict(zip(map(repr, PROBABILITIES), map(number, values), strict=True))
            for kind, values in (("stated", comparison.stated), ("sampled", comparison.sampled))
        }
        entries[name] = quantiles | {"distance": comparison.distance}
    return entries


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a number of an input."""
    return Origin((cited(compare),), result.independent)
