"""Nested design: samples, units and repeats, and the rows used for sensitivity indices.

In a study with ``units`` or ``repeats`` each sample is a world: its units have the same ``shared``
inputs and individual ``own`` inputs, and each unit is computed in several repeats that differ only
by random seeds. Samples are independent, rows within a sample are not.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from uq.contract import Floats
from uq.sampling.designs import DESIGNS, PLAIN
from uq.text.numbers import counted, grouped


class Nesting(NamedTuple):
    """Indices of rows in samples, units and repeats; in a plain design each row is a sample.

    Attributes
    ----------
    samples : int
        Number of samples with rows here, over all replicates.
    units, repeats : int
        Units per sample, repeats per unit.
    sample : ndarray of int, shape (n,)
        The sample of each row, from 0 to ``samples - 1``.
    unit, repeat : ndarray of int, shape (n,)
        From 0.
    replicate : ndarray of int, shape (samples,)
        The replicate of each sample.
    """

    samples: int
    units: int
    repeats: int
    sample: NDArray[np.intp]
    unit: NDArray[np.int64]
    repeat: NDArray[np.int64]
    replicate: NDArray[np.int64]

    def table(self, values: ArrayLike) -> Floats:
        """Return one number per row as shape (samples, units, repeats), NaN for missing rows."""
        table = np.full((self.samples, self.units, self.repeats), np.nan)
        table[self.sample, self.unit, self.repeat] = values
        return table

    def means(self, values: ArrayLike, weights: ArrayLike | None = None) -> Floats:
        """Return the mean of each sample, shape (samples,), NaN where no row has a value.

        Parameters
        ----------
        values : ndarray, shape (n,)
            NaN for rows that do not take part.
        weights : ndarray, shape (n,), optional
            Of each row.
        """
        values = np.asarray(values, dtype=float)
        finite = np.isfinite(values)
        worth = np.where(finite, 1.0 if weights is None else np.asarray(weights, float), 0.0)
        total = np.bincount(self.sample, worth, self.samples)
        sums = np.bincount(self.sample, worth * np.where(finite, values, 0.0), self.samples)
        return np.divide(sums, total, out=np.full(self.samples, np.nan), where=total > 0)


def nesting_of(ds: xr.Dataset) -> Nesting:
    """Return the indices of the rows of a result in samples, units and repeats.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, or some rows of one.

    Returns
    -------
    Nesting
    """
    n = ds.sizes["row"]
    if not is_nested(ds):
        nothing = np.zeros(n, np.int64)
        return Nesting(n, 1, 1, np.arange(n), nothing, nothing, ds["replicate"].values)
    worlds, first, sample = np.unique(ds["world"].values, return_index=True, return_inverse=True)
    return Nesting(
        len(worlds),
        int(ds.attrs["units_per_sample"]),
        int(ds.attrs["repeats"]),
        sample,
        ds["unit"].values,
        ds["repeat"].values,
        ds["replicate"].values[first],
    )


def size_in_words(samples: int, units: int, repeats: int) -> str:
    """Return the size of a design: ``20 samples of 3 units, 2 repeats of each``."""
    if units == 1:
        return counted(samples, "sample") + f" of {repeats} repeats" * (repeats > 1)
    several = f", {repeats} repeats of each" * (repeats > 1)
    return f"{counted(samples, 'sample')} of {units} units{several}"


def samples_have(count: int) -> str:
    """Return subject and verb of a sentence: ``1 sample has``, ``2 samples have``."""
    return counted(count, "sample has", "samples have")


def is_nested(ds: xr.Dataset) -> bool:
    """Whether samples of a result have several rows."""
    return "world" in ds.variables


def one_of_each_sample(ds: xr.Dataset) -> xr.Dataset:
    """Return the first repeat of the first unit of each sample: rows of a plain design."""
    if not is_nested(ds):
        return ds
    return ds.isel(row=(ds["unit"].values == 0) & (ds["repeat"].values == 0))


def first_samples(ds: xr.Dataset, samples: int) -> xr.Dataset:
    """Return the rows of the first samples of each replicate."""
    chosen = ds["group"].values < samples
    count = int(chosen.sum())
    return ds.isel(row=slice(count) if chosen[:count].all() else chosen)


RANKED = 50_000
"""Maximum number of rows used for ranking inputs: more hardly change their order."""


def ranked_rows(ds: xr.Dataset) -> xr.Dataset:
    """Return the rows that sensitivity indices of a result are estimated from.

    Parameters
    ----------
    ds : xarray.Dataset

    Returns
    -------
    xarray.Dataset
        The first samples of a large plain design, or as many random rows if they are imported, as
        their order may be meaningful; else `ds` itself, also for a design that compares rows.
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
