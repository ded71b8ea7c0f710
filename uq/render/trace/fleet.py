"""The numbers of `uq fleet` and their origins."""

from typing import Any

from uq.assess.fleet import fleet, fleet_of, the_life
from uq.assess.fleet_json import fleet_json
from uq.assess.population import Population
from uq.errors import InputError
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin
from uq.render.trace.summary import states_of
from uq.result.result import Result
from uq.text.keys import Json, Options, Path
from uq.text.quantities import read_threshold


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of fleets of a size."""
    try:
        size, allow = int(options.get("size", "")), int(options.get("allow", "0"))
    except ValueError:
        raise InputError(
            "a key of a fleet begins with fleet[size=N], or with by=T, allow=K, output=LIFE as well"
        ) from None
    output, by = options.get("output"), list[float]()
    if "by" in options:
        units = the_life(result.independent, output).declared.unit
        by = [read_threshold("by", options["by"], "a life", units)]
    return fleet_json(fleet_of(result, size, by, allow, output))


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of a number of a fleet."""
    rows = result.independent
    states = states_of(rows.named_elements(document["output"])[0])
    return Origin((cited(fleet), cited(Population)), rows, states, tuple(document["notes"]))
