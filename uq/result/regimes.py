"""The rows of a result that are in one regime."""

import numpy as np
import xarray as xr

from uq.errors import InputError, choices, nearest
from uq.result.elements import flags
from uq.result.result_file import failed


def within_regime(ds: xr.Dataset, regime: str) -> xr.Dataset:
    """Return the rows in one regime, and failed rows without a regime.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    regime : str

    Returns
    -------
    xarray.Dataset
        Failed rows without a regime are kept: any of them might have been in this one, and failed
        rows must be counted.

    Raises
    ------
    InputError
        When the result has no regimes, this one does not exist, or no row is in it.
    """
    if "regime" not in ds:
        raise InputError("this result has no regimes; leave the regime out")
    codes = {label: code for code, label in flags(ds["regime"]) if code >= 0}
    if regime not in codes:
        near, allowed = nearest(regime, list(codes)), ", ".join(codes)
        raise InputError(f"no such regime '{regime}'{near} (allowed: {allowed})")
    in_regime = ds["regime"].values == codes[regime]
    if not in_regime.any():
        present = np.unique(ds["regime"].values)
        occurring = [label for label, code in codes.items() if code in present]
        raise InputError(
            f"no row is in the regime '{regime}' (there are rows in: {choices(occurring)})"
        )
    return ds.isel(row=np.flatnonzero(in_regime | ((ds["regime"].values < 0) & failed(ds))))
