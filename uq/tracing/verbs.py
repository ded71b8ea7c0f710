"""The verbs whose numbers have keys. To add one, write what it says and where that comes from."""

from collections.abc import Callable
from typing import Any, NamedTuple

import xarray as xr

from uq.keys import SUMMARY, Json, Options, Path, value_at
from uq.tracing import (
    of_answer,
    of_fleet,
    of_indices,
    of_inputs,
    of_learning,
    of_levels,
    of_running,
    of_summary,
    of_twin,
    of_what_if,
)
from uq.tracing.origin import Origin


def from_the_rows(verb: "Verb", found: Origin, options: Options, path: Path) -> Any:
    """Return what the verb says of the rows of an origin alone."""
    return value_at(verb.says(found.rows, options, path), path)


class Verb(NamedTuple):
    """A verb whose numbers have keys.

    Attributes
    ----------
    says : callable
        Result, options, path -> its JSON, as far as the path needs it.
    origin : callable
        Result, options, path of a number, and the JSON it is in -> `Origin`.
    options : tuple of str
        Those of the command that change its numbers; of a name that ends with a dot, more follows.
    again : callable
        Verb, origin, options, path -> the entry at the path, from the rows of the origin.
    """

    says: Callable[[xr.Dataset, Options, Path], dict[str, Any]]
    origin: Callable[[xr.Dataset, Options, Path, Json], Origin]
    options: tuple[str, ...] = ()
    again: Callable[["Verb", Origin, Options, Path], Any] = from_the_rows


VERBS: dict[str, Verb] = {
    SUMMARY: Verb(of_summary.says, of_summary.origin, ("regime",)),
    "answer": Verb(of_answer.says, of_answer.origin),
    "inputs": Verb(of_inputs.says, of_inputs.origin),
    "sensitivity": Verb(of_indices.says, of_indices.origin, ("method", "regime")),
    "levels": Verb(of_levels.says, of_levels.origin),
    "fleet": Verb(of_fleet.says, of_fleet.origin, ("size", "by", "allow", "output")),
    "update": Verb(of_learning.says, of_learning.origin, ("by",)),
    "convergence": Verb(of_running.says, of_running.origin, (), of_running.again),
    "twin": Verb(of_twin.says, of_twin.origin),
    "what-if": Verb(of_what_if.says, of_what_if.origin, ("uncertain.", "dependence.")),
}
"""By name; the answer is a part of the summary, and a report shows the inputs."""
