"""Assumptions of an answer: laws and values without a measurement."""

from collections.abc import Sized

import xarray as xr

from uq.assess.answer.sources import ASSUMED, mark_of
from uq.assess.answer.wording import called, joined
from uq.result.elements import study_file_of
from uq.study.file import Tied
from uq.text.numbers import counted


def assumptions(ds: xr.Dataset) -> tuple[str, ...]:
    """Return which laws and fixed values are assumed, or have no source that says it, in words.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    """
    study = study_file_of(ds).uncertain
    tied = [name for name, law in study.items() if isinstance(law, Tied)]
    laws = {name: how for name, how in _marks(ds, "input").items() if name not in tied}
    fixed = _marks(ds, "fixed")
    assumed = [name for name, how in laws.items() if how == ASSUMED]
    unstated = [name for name, how in laws.items() if not how and "initial" not in ds[name].attrs]
    values = [name for name, how in fixed.items() if how == ASSUMED]
    said = (
        (f"{_some(assumed, laws, 'law')} assumed", assumed),
        (f"{_some(values, fixed, 'fixed value')} assumed", values),
        ("No source says how well these laws are known", unstated),
    )
    return tuple(
        f"{what}: {joined([called(name) for name in names])}." for what, names in said if names
    )


def _some(names: Sized, of: Sized, noun: str) -> str:
    verb = "is" if len(names) == 1 else "are"
    return f"{len(names)} of {counted(len(of), noun)} {verb}"


def _marks(ds: xr.Dataset, role: str) -> dict[str, str]:
    """Return how well each parameter of a role is known."""
    return {
        str(name): mark_of(ds, str(name))
        for name, one in ds.variables.items()
        if one.attrs.get("role") == role
    }
