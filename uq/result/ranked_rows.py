"""The rows by which inputs are ranked: a part of a large plain design."""

import numpy as np
import xarray as xr

from uq.result.nesting import first_samples
from uq.sampling.designs import DESIGNS
from uq.sampling.layouts import PLAIN
from uq.text.numbers import grouped

RANKED = 50_000
"""Rows by which inputs are ranked where a design is larger: more hardly change their order."""


def ranked_rows(ds: xr.Dataset) -> xr.Dataset:
    """Return the rows that sensitivity indices of a result are estimated from.

    Parameters
    ----------
    ds : xarray.Dataset

    Returns
    -------
    xarray.Dataset
        The first samples of a large plain design, and as many imported rows at random, since these
        may come in a meaningful order; else `ds` itself, also of a design that compares rows.
    """
    samples, rows = int(ds.attrs["samples"]), ds.sizes["row"]
    design = DESIGNS[ds.attrs["design"]]
    if rows <= RANKED or design.layout is not PLAIN:
        return ds
    if design.imported:
        chosen = np.random.default_rng(0).choice(rows, RANKED, replace=False)
        return ds.isel(row=np.sort(chosen)).load()
    # Loaded: they are few, and read once for each target.
    return first_samples(ds, max(RANKED * samples // rows, 1)).load()


def ranked_in_words(ranked: xr.Dataset, ds: xr.Dataset) -> str:
    """Return a phrase for the rows that are ranked: ``by the first 50 000 rows``; "" for all."""
    if ranked is ds:
        return ""
    count = grouped(ranked.sizes["row"])
    if DESIGNS[ds.attrs["design"]].imported:
        return f"by {count} rows chosen at random"
    return f"by the first {count} rows"
