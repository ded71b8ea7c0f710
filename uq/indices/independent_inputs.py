"""The inputs of a result that vary on their own, each a column of its design."""

import xarray as xr

from uq.designs.registry import DESIGNS
from uq.inputs.conditioning import factor_of
from uq.rows.elements import Floats
from uq.study.file import Tied
from uq.study.input_checks import laws_of
from uq.study.reading import read_study_text


def independent_inputs(ds: xr.Dataset) -> dict[str, Floats]:
    """Return the values of each input as its own law gives them.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        Without parameters that equal another; of one that is another times a factor, the factor.
        Inputs with rank correlations are there all the same.
    """
    return {
        name: ds[name].values
        if law.times is None
        else factor_of(law, ds[name].values, ds[law.times].values)
        for name, law in laws_of(ds.attrs["study"]).items()
    }


def why_dependent(ds: xr.Dataset) -> str:
    """Return a clause that says why inputs cannot be taken for independent, or ""."""
    study = read_study_text(ds.attrs["study"], "study of this result")
    if study.dependence is not None:
        return "the inputs of this study depend on each other"
    if DESIGNS[study.design.method].imported and not study.design.independent:
        return "imported inputs may depend on each other"
    return ""


def notes_on_inputs(ds: xr.Dataset) -> list[str]:
    """Return sentences on what stands for what among the inputs of a result."""
    entries = read_study_text(ds.attrs["study"], "study of this result").uncertain
    notes = []
    for name, entry in entries.items():
        if isinstance(entry, Tied):
            notes.append(f"{name} equals {entry.equals}: the index of {entry.equals} is of both")
        elif entry.times is not None:
            notes.append(f"{name} is {entry.times} times a factor: its index is of the factor")
    if why := why_dependent(ds):
        notes.append(f"{why}: an input may owe its index to another")
    return notes
