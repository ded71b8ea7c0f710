"""The inputs of a result with a law of their own, each a column of its design."""

from collections import defaultdict

from uq.contract import Floats
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.sampling.truncation import factor_of
from uq.study.file import Tied
from uq.study.input_checks import laws_of


def independent_inputs(result: Result) -> dict[str, Floats]:
    """Return the values of each input as its own law gives them.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        Without parameters that equal another; for one that is another times a factor, the factor.
        With inputs that have rank correlations.
    """
    return {
        name: result.dataset[name].values
        if law.times is None
        else factor_of(law, result.dataset[name].values, result.dataset[law.times].values)
        for name, law in laws_of(result.dataset.attrs["study"]).items()
    }


def correlated_inputs(result: Result) -> dict[str, tuple[str, ...]]:
    """Return the inputs with stated rank correlations: name -> correlated inputs."""
    stated = result.study.dependence
    if stated is None:
        return {}
    names = stated.parameters
    return {
        name: tuple(other for other, rank in zip(names, row, strict=True) if rank and other != name)
        for name, row in zip(names, stated.rank_correlation, strict=True)
    }


def why_dependent(result: Result) -> str:
    """Return a clause on why inputs are not assumed to be independent, or ""."""
    study = result.study
    if study.dependence is not None:
        return "the inputs of this study depend on each other"
    if DESIGNS[study.design.method].imported and not study.design.independent:
        return "imported inputs may depend on each other"
    return ""


_DUE = "the index of an input may be due to another"
_DIVIDED = "what correlated inputs explain in common is divided among them"


def notes_on_inputs(result: Result) -> list[str]:
    """Return sentences on the meaning of indices of tied or dependent inputs."""
    notes, tied = [], defaultdict[str, list[str]](list)
    for name, entry in result.study.uncertain.items():
        if isinstance(entry, Tied):
            tied[entry.equals].append(name)
        elif entry.times is not None:
            notes.append(f"{name} is {entry.times} times a factor: its index is that of the factor")
    for name, others in tied.items():
        equal, together = ("equals", "both") if len(others) == 1 else ("equal", "all of them")
        notes.append(
            f"{' and '.join(others)} {equal} {name}: the index of {name} is that of {together}"
        )
    if why := why_dependent(result):
        shared = result.design.layout.given_the_rest
        notes.append(f"{why}: {_DIVIDED if shared else _DUE}")
    return notes
