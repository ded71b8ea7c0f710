"""Registry of the laws by name.

To add a law, write a subclass of `uq.sampling.law.Law` and add a line here. Study files then accept
it, and schema, templates, tables and documentation show it.
"""

from functools import lru_cache, reduce
from operator import or_
from typing import Annotated, Any, get_args

from pydantic import Field, TypeAdapter

from uq.sampling import listed_values, scipy_laws
from uq.sampling.law import Law

LAWS: dict[str, type[Law]] = {
    get_args(law.model_fields["distribution"].annotation)[0]: law
    for law in (
        scipy_laws.Uniform,
        scipy_laws.LogUniform,
        scipy_laws.Normal,
        scipy_laws.TruncatedNormal,
        scipy_laws.LogNormal,
        scipy_laws.Triangular,
        scipy_laws.Pert,
        scipy_laws.Beta,
        scipy_laws.Weibull,
        scipy_laws.Gamma,
        scipy_laws.Gumbel,
        scipy_laws.Exponential,
        listed_values.DiscreteChoice,
        listed_values.IntegerRange,
        listed_values.Empirical,
        listed_values.Histogram,
    )
}
"""Name in a study file -> law, in the order in which laws are listed."""


def law_of(entry: Any) -> Law:
    """Return the law from an entry of a study file.

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
    """Return the pydantic type adapter of all registered laws."""
    return _one_of(tuple(LAWS.values()))


@lru_cache(maxsize=1)
def _one_of(laws: tuple[type[Law], ...]) -> TypeAdapter[Law]:
    union: Any = reduce(or_, laws)
    return TypeAdapter(Annotated[union, Field(discriminator="distribution")])
