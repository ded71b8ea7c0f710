"""The numbers of `uq twin` and their origins."""

from typing import Any

from uq.assess.summary_json import twin_json
from uq.assess.two_fidelities import with_twin
from uq.render.trace.citations import cited
from uq.render.trace.origin import Origin
from uq.render.trace.summary import states_of
from uq.result.result import Result
from uq.stats.control_variate import controlled_mean, controlled_share
from uq.text.keys import Json, Options, Path


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the estimates with a twin."""
    return twin_json(with_twin(result, options.get("model")))


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of an estimate with a twin."""
    rows = result.independent
    states = states_of(rows.named_elements(path[1])[0]) if path[0] == "outputs" else {}
    by = controlled_mean if path[2:3] == ("mean",) else controlled_share
    return Origin((cited(by),), rows, states, ("It also rests on rows of the twin alone.",))
