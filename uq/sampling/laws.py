"""Registry of the laws by name.

To add a law, write a subclass of `uq.sampling.law.Law` and add a line here. Study files then accept
it, and schema, templates, tables and documentation show it.
"""

from functools import lru_cache, reduce
from operator import or_
from typing import Annotated, Any, get_args

from pydantic import BaseModel, Field, TypeAdapter

from uq.errors import nearest
from uq.sampling import listed_values, scipy_laws
from uq.sampling.input_faults import MISSING, InputFault, fault_of
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
        scipy_laws.WearCoefficient,
    )
}
"""Name in a study file -> law, in the order in which laws are listed."""


_OTHER_NAMES = {
    "gauss": "normal",
    "gaussian": "normal",
    "flat": "uniform",
    "rectangular": "uniform",
    "galton": "lognormal",
    "data": "empirical",
    "sample": "empirical",
    "choice": "discrete-choice",
}
"""Name of a law elsewhere -> its name here."""


_NAMES = f" (allowed: {', '.join(LAWS)})"


def listed_once(faults: list[InputFault]) -> list[InputFault]:
    """Return faults of which only the last that allows any law lists the laws."""
    places = [i for i, fault in enumerate(faults) if fault.problem.endswith(_NAMES)][:-1]
    shorter = {
        i: faults[i]._replace(problem=faults[i].problem.removesuffix(_NAMES)) for i in places
    }
    return [shorter.get(i, fault) for i, fault in enumerate(faults)]


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


def law_fault(error: dict[str, Any], law: type[BaseModel] | None) -> InputFault:
    """Return a pydantic error in an entry of the table [uncertain] as a fault.

    Parameters
    ----------
    error : dict
        An item of ``ValidationError.errors()``; ``loc`` is the path in a study file.
    law : type, optional
        What the entry is; None if it names no law.
    """
    path = tuple(error["loc"])
    if error["type"] == "union_tag_not_found":
        for key, given in error["input"].items():
            if meant := nearest(key, ["distribution"]):
                return InputFault((*path, key), f"no such key{meant}", given)
        return InputFault((*path, "distribution"), f"{MISSING}{_NAMES}")
    if error["type"] == "union_tag_invalid":
        name = error["ctx"]["tag"]
        other = _OTHER_NAMES.get(name.lower())
        meant = f"; did you mean '{other}'?" if other else nearest(name, LAWS)
        return InputFault((*path, "distribution"), f"no such law{meant}{_NAMES}", name)
    fields = list(law.model_fields) if law else []
    common = list(Law.model_fields)[1:] if law and issubclass(law, Law) else []
    names = [name for name in fields if name not in common] + common  # source is the first
    return fault_of(error, lambda at: (f"argument of {at[1]}'s law", names))


def any_law() -> TypeAdapter[Law]:
    """Return the pydantic type adapter of all registered laws."""
    return _one_of(tuple(LAWS.values()))


@lru_cache(maxsize=1)
def _one_of(laws: tuple[type[Law], ...]) -> TypeAdapter[Law]:
    union: Any = reduce(or_, laws)
    return TypeAdapter(Annotated[union, Field(discriminator="distribution")])
