"""The numbers of `uq sensitivity` and their origins."""

from dataclasses import replace
from typing import Any

import numpy as np

from uq.assess.chosen_targets import chosen
from uq.assess.design_sample import sample_of
from uq.assess.sensitivities import sensitivities
from uq.assess.sensitivity_json import sensitivity_json
from uq.indices.methods import METHODS
from uq.render.trace.citations import Citation, cited
from uq.render.trace.origin import Origin
from uq.result.result import Result
from uq.text.keys import Json, Options, Path


def json_of(result: Result, options: Options, path: Path) -> dict[str, Any]:
    """Return the JSON of the indices, of one target if the path names one."""
    named = [path[1]] if path[:1] == ("outputs",) and path[1:] else None
    indices = sensitivities(result, options.get("method"), named, options.get("regime"))
    return sensitivity_json(indices)


def origin(result: Result, options: Options, path: Path, document: Json) -> Origin:
    """Return the origin of an index."""
    if regime := options.get("regime"):
        result = result.within_regime(regime)
    rows = result.ranked.first_rows
    by = (estimator_of(document["method"], *path[2:3]),)
    if path[0] != "outputs":
        return Origin(by, rows)
    entry = document["outputs"][path[1]]
    (target,) = chosen(rows, document["method"], [path[1]])
    sample = replace(sample_of(rows), values=target.values)
    states = {"in groups with a value in each row": len(np.unique(sample.groups[sample.whole]))}
    dropped = len(np.unique(sample.groups[~sample.whole]))
    states |= {"in groups that lack one, dropped": dropped} if dropped else {}
    return Origin(by, rows, states, tuple(entry.get("notes", ())))


def estimator_of(method: str, key: str = "") -> Citation:
    """Return question, estimator and references of a method.

    Parameters
    ----------
    method : str
    key : str
        Key of the kind of index; "" for none.
    """
    estimator = METHODS[method]
    kinds = [f" ({kind.words})" for kind in estimator.kinds if kind.key == key]
    code = f"uq.indices.methods.METHODS['{method}']"
    references = [estimator.source, estimator.intervals and f"intervals: {estimator.intervals}"]
    sources = (*filter(None, references), *cited(estimator.estimate).sources)
    return Citation(f"{estimator.question}{''.join(kinds)}", code, sources)
