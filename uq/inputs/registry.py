"""The laws by name.

To add one: its class, a file with a `uq.inputs.law.Law`, and a line here. Study files then accept
it, and schema, templates, tables and documentation show it.
"""

from collections.abc import Iterable
from functools import lru_cache, reduce
from operator import or_
from typing import Annotated, Any, get_args

from pydantic import Field, TypeAdapter

from uq.inputs import distributions, observed
from uq.inputs.law import Law


def _named(laws: Iterable[type[Law]]) -> dict[str, type[Law]]:
    return {get_args(law.model_fields["distribution"].annotation)[0]: law for law in laws}


LAWS = _named(
    (
        distributions.Uniform,
        distributions.LogUniform,
        distributions.Normal,
        distributions.TruncatedNormal,
        distributions.LogNormal,
        distributions.Triangular,
        distributions.Pert,
        distributions.Beta,
        distributions.Weibull,
        distributions.Gamma,
        distributions.Gumbel,
        distributions.Exponential,
        observed.DiscreteChoice,
        observed.IntegerRange,
        observed.Empirical,
        observed.Histogram,
    )
)
"""Name in a study file -> law, in the order in which laws are listed."""


def law_of(entry: Any) -> Law:
    """Return the law that a study file states.

    Parameters
    ----------
    entry : dict
        ``distribution`` and arguments.

    Returns
    -------
    Law

    Raises
    ------
    pydantic.ValidationError
    """
    return any_law().validate_python(entry)


def any_law() -> TypeAdapter[Law]:
    """Return pydantic's type of all laws registered so far."""
    return _one_of(tuple(LAWS.values()))


@lru_cache(maxsize=1)
def _one_of(laws: tuple[type[Law], ...]) -> TypeAdapter[Law]:
    union: Any = reduce(or_, laws)
    return TypeAdapter(Annotated[union, Field(discriminator="distribution")])
