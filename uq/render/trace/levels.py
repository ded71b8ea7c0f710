"""The numbers of `uq levels` and their origins."""

from typing import Any

from uq.assess.chosen_targets import output_in
from uq.assess.level_shares import by_level
from uq.assess.regime_switching import switching
from uq.assess.summary_json import levels_json
from uq.assess.targets import split_name
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin
from uq.render.trace.summary import states_of
from uq.result.nesting import nesting_of
from uq.result.result import Result
from uq.stats.variance_components import nested_shares
from uq.text.keys import Json, Options, Path


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the shares, of one element if the path names one."""
    named = output_in(split_name(path[1])[1]) if path[:1] == ("outputs",) and path[1:] else None
    return levels_json(by_level(result, named))


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a share."""
    rows = result.independent
    if path[0] == "outputs":
        inside = split_name(path[1])[1]
        if output_in(inside) != inside:  # of a category
            return Origin((cited(nested_shares),), rows)
        (element,) = rows.named_elements(inside)
        return Origin((cited(nested_shares),), rows, states_of(element))
    return Origin((cited(switching if path[0] == "regime" else nesting_of),), rows)
