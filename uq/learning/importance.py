"""Rows that were not drawn from the laws of the study, and so count unequally from the start."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from uq.contract import Floats, Mask

IMPORTANCE, ROUND = "importance", "round"
"""Variables of each row: how much it counts before any inspection, of mean 1 in expectation; and
the round in which it was drawn, 0 of the study's own rows."""


class Importance(NamedTuple):
    """How much rows count before any inspection.

    Attributes
    ----------
    of_rows : ndarray, shape (n,)
    own : ndarray of bool, shape (n,)
        Which rows were drawn from the laws of the study.
    """

    of_rows: Floats
    own: Mask

    @property
    def most(self) -> float:
        """The most that any row can count, computed or not."""
        return len(self.own) / int(self.own.sum())


def importance_of(rows: xr.Dataset) -> Importance:
    """Return how much the rows of a result count before any inspection."""
    if ROUND not in rows:
        equal = np.ones(rows.sizes["sample"])
        return Importance(equal, equal > 0)
    return Importance(rows[IMPORTANCE].values, rows[ROUND].values == 0)


def own_rows(rows: xr.Dataset) -> xr.Dataset:
    """Return the rows drawn from the laws of the study alone, as they were."""
    if ROUND not in rows:
        return rows
    found = rows.isel(sample=importance_of(rows).own).drop_vars([IMPORTANCE, ROUND])
    return found.assign_attrs(samples=found.sizes["sample"])


def with_rounds(
    own: xr.Dataset, rounds: Sequence[xr.Dataset], log_importance: Floats
) -> xr.Dataset:
    """Return the rows of a study with those of further rounds.

    Parameters
    ----------
    own : xarray.Dataset
        Independent rows of the study.
    rounds : sequence of xarray.Dataset
        Results of the same model.
    log_importance : ndarray, shape (n,)
        Of all rows.
    """
    names = list(own.data_vars)
    found = xr.concat(
        [own, *(one[names] for one in rounds)],
        "sample",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )
    number = np.arange(found.sizes["sample"])
    of_round = np.repeat(
        np.arange(len(rounds) + 1), [one.sizes["sample"] for one in (own, *rounds)]
    )
    about = {"role": "importance", "units": "1"}
    meaning = "how much the row counts before the inspections"
    found = found.assign(
        {
            IMPORTANCE: ("sample", np.exp(log_importance), about | {"long_name": meaning}),
            ROUND: ("sample", of_round, about | {"long_name": "0: a row of the study"}),
        }
    )
    places = {name: found[name].copy(data=number) for name in ("sample", "group")}
    return found.assign_coords(places).assign_attrs(samples=len(number))
