"""A result and what several tables and figures show of it, each computed once."""

from functools import cached_property

import pandas as pd
import xarray as xr

from uq.analysis.convergence import COLUMNS, running_estimates
from uq.analysis.level_shares import ByLevel, by_level
from uq.analysis.summary import Summary, summarise
from uq.errors import InputError
from uq.indices.sensitivities import Sensitivities, sensitivities
from uq.rows.elements import elements_of, independent_rows, output_names


class Findings:
    """What is known of a result, each part computed when first needed.

    Parameters
    ----------
    ds : xarray.Dataset
        A result; it must not be changed while this is in use.
    """

    def __init__(self, ds: xr.Dataset):
        self.ds = ds
        self._sensitivities: dict[str, Sensitivities] = {}

    @cached_property
    def rows(self) -> xr.Dataset:
        """The independent rows."""
        return independent_rows(self.ds)

    @cached_property
    def absent(self) -> frozenset[str]:
        """The outputs that no independent row has."""
        names = output_names(self.rows)
        there = (one.output for one in elements_of(self.rows, names) if one.present.any())
        return frozenset(names) - frozenset(there)

    @cached_property
    def summary(self) -> Summary:
        """What `uq.analysis.summary.summarise` returns."""
        return summarise(self.ds)

    @cached_property
    def running(self) -> pd.DataFrame:
        """What `uq.running_estimates` returns; where it refuses, no lines, and why in ``attrs``."""
        try:
            return running_estimates(self.ds)
        except InputError as refused:
            nothing = pd.DataFrame(columns=COLUMNS)
            nothing.attrs["refused"] = str(refused)
            return nothing

    @cached_property
    def levels(self) -> ByLevel:
        """What `uq.analysis.level_shares.by_level` returns."""
        return by_level(self.ds)

    def sensitivities(self, method: str) -> Sensitivities:
        """Return what `uq.indices.sensitivities.sensitivities` finds by a method.

        Raises
        ------
        InputError
            When the method does not apply to this result.
        """
        if method not in self._sensitivities:
            self._sensitivities[method] = sensitivities(self.ds, method)
        return self._sensitivities[method]
