"""The laws by name.

To add one: its class, a file with a `uq.inputs.law.Law`, and a line here. Study files then accept
it, and schema, templates, tables and documentation show it.
"""

from collections.abc import Iterable
from functools import lru_cache, reduce
from operator import or_
from typing import Annotated, Any, get_args

from pydantic import Field, TypeAdapter

from uq.inputs.distributions import (
    Beta,
    Exponential,
    Gamma,
    Gumbel,
    LogNormal,
    LogUniform,
    Normal,
    Pert,
    Triangular,
    TruncatedNormal,
    Uniform,
    Weibull,
)
from uq.inputs.law import Law
from uq.inputs.observed import DiscreteChoice, Empirical, Histogram, IntegerRange


def _named(laws: Iterable[type[Law]]) -> dict[str, type[Law]]:
    return {get_args(law.model_fields["distribution"].annotation)[0]: law for law in laws}


LAWS = _named(
    (
        Uniform,
        LogUniform,
        Normal,
        TruncatedNormal,
        LogNormal,
        Triangular,
        Pert,
        Beta,
        Weibull,
        Gamma,
        Gumbel,
        Exponential,
        DiscreteChoice,
        IntegerRange,
        Empirical,
        Histogram,
    )
)
"""What a study file calls a law -> its class, in the order in which they are named."""


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
    """Return pydantic's type of all laws, as they are by then."""
    return _one_of(tuple(LAWS.values()))


@lru_cache(maxsize=1)
def _one_of(laws: tuple[type[Law], ...]) -> TypeAdapter[Law]:
    union: Any = reduce(or_, laws)
    return TypeAdapter(Annotated[union, Field(discriminator="distribution")])
