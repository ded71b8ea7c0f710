"""The inputs of a result with a law of their own, each a column of its design."""

from collections import defaultdict

import xarray as xr

from uq.result.elements import Floats, study_file_of
from uq.sampling.designs import DESIGNS
from uq.sampling.truncation import factor_of
from uq.study.file import Tied
from uq.study.input_checks import laws_of


def independent_inputs(ds: xr.Dataset) -> dict[str, Floats]:
    """Return the values of each input as its own law gives them.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        Without parameters that equal another; for one that is another times a factor, the factor.
        With inputs that have rank correlations.
    """
    return {
        name: ds[name].values
        if law.times is None
        else factor_of(law, ds[name].values, ds[law.times].values)
        for name, law in laws_of(ds.attrs["study"]).items()
    }


def correlated_inputs(ds: xr.Dataset) -> dict[str, tuple[str, ...]]:
    """Return the inputs with stated rank correlations: name -> those it is correlated with."""
    stated = study_file_of(ds).dependence
    if stated is None:
        return {}
    names = stated.parameters
    return {
        name: tuple(other for other, rank in zip(names, row, strict=True) if rank and other != name)
        for name, row in zip(names, stated.rank_correlation, strict=True)
    }


def why_dependent(ds: xr.Dataset) -> str:
    """Return a clause on why inputs are not assumed to be independent, or ""."""
    study = study_file_of(ds)
    if study.dependence is not None:
        return "the inputs of this study depend on each other"
    if DESIGNS[study.design.method].imported and not study.design.independent:
        return "imported inputs may depend on each other"
    return ""


_DUE = "the index of an input may be due to another"
_DIVIDED = "what correlated inputs explain in common is divided among them"


def notes_on_inputs(ds: xr.Dataset) -> list[str]:
    """Return sentences on what the indices of tied or dependent inputs mean."""
    notes, tied = [], defaultdict[str, list[str]](list)
    for name, entry in study_file_of(ds).uncertain.items():
        if isinstance(entry, Tied):
            tied[entry.equals].append(name)
        elif entry.times is not None:
            notes.append(f"{name} is {entry.times} times a factor: its index is that of the factor")
    for name, others in tied.items():
        equal, together = ("equals", "both") if len(others) == 1 else ("equal", "all of them")
        notes.append(
            f"{' and '.join(others)} {equal} {name}: the index of {name} is that of {together}"
        )
    if why := why_dependent(ds):
        shared = DESIGNS[ds.attrs["design"]].layout.given_the_rest
        notes.append(f"{why}: {_DIVIDED if shared else _DUE}")
    return notes
