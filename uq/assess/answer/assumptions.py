"""Assumptions of an answer: laws and values without a measurement."""

from collections.abc import Sized

from uq.assess.answer.sources import ASSUMED, mark_of
from uq.assess.answer.wording import called, joined
from uq.assess.fact import Fact
from uq.result.result import Result
from uq.study.file import Tied
from uq.text.numbers import counted


def assumptions(result: Result) -> dict[str, Fact]:
    """Return the assumed laws and fixed values, and the laws without a source.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    dict of str to Fact
        ``assumed_laws``, ``assumed_values`` and ``laws_without_source``, as far as there are any:
        the ``inputs``, and the number that they are ``of``.
    """
    study = result.study.uncertain
    tied = [name for name, law in study.items() if isinstance(law, Tied)]
    laws = {name: how for name, how in _marks(result, "input").items() if name not in tied}
    fixed = _marks(result, "fixed")
    assumed = [name for name, how in laws.items() if how == ASSUMED]
    unstated = [
        name
        for name, how in laws.items()
        if not how and "initial" not in result.dataset[name].attrs
    ]
    values = [name for name, how in fixed.items() if how == ASSUMED]
    groups = {
        "assumed_laws": (f"{_counted_with_verb(assumed, laws, 'law')} assumed", assumed, laws),
        "assumed_values": (
            f"{_counted_with_verb(values, fixed, 'fixed value')} assumed",
            values,
            fixed,
        ),
        "laws_without_source": ("No source says how well these laws are known", unstated, laws),
    }
    return {
        key: Fact(
            {"inputs": names, "of": len(total)},
            words=f"{clause}: {joined([called(name) for name in names])}.",
        )
        for key, (clause, names, total) in groups.items()
        if names
    }


def _counted_with_verb(names: Sized, total: Sized, noun: str) -> str:
    verb = "is" if len(names) == 1 else "are"
    return f"{len(names)} of {counted(len(total), noun)} {verb}"


def _marks(result: Result, role: str) -> dict[str, str]:
    """Return the quality of the source of each parameter with a role."""
    return {
        str(name): mark_of(result, str(name))
        for name, variable in result.dataset.variables.items()
        if variable.attrs.get("role") == role
    }
