"""The verbs whose numbers have keys. To add one, write its JSON and origins."""

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
    return value_at(verb.json_of(number_origin.rows, options, path), path)


class Verb(NamedTuple):
    """A verb whose numbers have keys.

    Attributes
    ----------
    json_of : callable
        Result, options, path -> its JSON, as far as the path needs it.
    origin : callable
        Result, options, path of a number, and the JSON it is in -> `Origin`.
    options : tuple of str
        Options of the command that change its numbers; names that end with a dot are prefixes.
    again : callable
        Verb, origin, options, path -> the entry at the path, from the rows of the origin.
    """

    json_of: Callable[[Result, Options, Path], dict[str, Any]]
    origin: Callable[[Result, Options, Path, Json], Origin]
    options: tuple[str, ...] = ()
    again: Callable[["Verb", Origin, Options, Path], Any] = from_the_rows


VERBS: dict[str, Verb] = {
    SUMMARY: Verb(summary.json_of, summary.origin, ("regime",)),
    "answer": Verb(answer.json_of, answer.origin),
    "inputs": Verb(inputs.json_of, inputs.origin),
    "sensitivity": Verb(indices.json_of, indices.origin, ("method", "regime")),
    "levels": Verb(levels.json_of, levels.origin),
    "fleet": Verb(fleet.json_of, fleet.origin, ("size", "by", "allow", "output")),
    "update": Verb(learning.json_of, learning.origin, ("by",)),
    "convergence": Verb(convergence.json_of, convergence.origin, (), convergence.again),
    "twin": Verb(two_fidelities.json_of, two_fidelities.origin),
    "what-if": Verb(what_if.json_of, what_if.origin, ("uncertain.", "dependence.")),
}
"""By name; the answer is a part of the summary, and a report shows the inputs."""
