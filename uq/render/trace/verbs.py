"""The verbs whose numbers have keys. To add one, write what it says and where that comes from."""

from collections.abc import Callable
from typing import Any, NamedTuple

from uq.render.trace import (
    answer,
    convergence,
    fleet,
    indices,
    inputs,
    learning,
    levels,
    summary,
    two_fidelities,
    what_if,
)
from uq.render.trace.origin import Origin
from uq.result.result import Result
from uq.text.keys import SUMMARY, Json, Options, Path, value_at


def from_the_rows(verb: "Verb", number_origin: Origin, options: Options, path: Path) -> Any:
    """Return the number at a path, computed from the rows of its origin alone."""
    return value_at(verb.says(number_origin.rows, options, path), path)


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

    says: Callable[[Result, Options, Path], dict[str, Any]]
    origin: Callable[[Result, Options, Path, Json], Origin]
    options: tuple[str, ...] = ()
    again: Callable[["Verb", Origin, Options, Path], Any] = from_the_rows


VERBS: dict[str, Verb] = {
    SUMMARY: Verb(summary.says, summary.origin, ("regime",)),
    "answer": Verb(answer.says, answer.origin),
    "inputs": Verb(inputs.says, inputs.origin),
    "sensitivity": Verb(indices.says, indices.origin, ("method", "regime")),
    "levels": Verb(levels.says, levels.origin),
    "fleet": Verb(fleet.says, fleet.origin, ("size", "by", "allow", "output")),
    "update": Verb(learning.says, learning.origin, ("by",)),
    "convergence": Verb(convergence.says, convergence.origin, (), convergence.again),
    "twin": Verb(two_fidelities.says, two_fidelities.origin),
    "what-if": Verb(what_if.says, what_if.origin, ("uncertain.", "dependence.")),
}
"""By name; the answer is a part of the summary, and a report shows the inputs."""
