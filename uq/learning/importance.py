"""Rows not drawn from the laws of the study, and how much they count before any inspection."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.result.nesting import is_nested, nesting_of
from uq.result.weights import IMPORTANCE, OWN_SIZE, ROUND, has_rounds

REPETITIONS = 8
"""Independent repetitions of the sampler, where the design has no replicates of its own."""


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
    if not has_rounds(rows):
        equal = np.ones(rows.sizes["sample"])
        return Importance(equal, equal > 0)
    return Importance(rows[IMPORTANCE].values, rows[ROUND].values == 0)


def repetitions_of(own: xr.Dataset) -> NDArray[np.int32]:
    """Return the repetition of the sampler that begins with each row of a result, shape (n,).

    The replicate of a design that has several, else an eighth of the samples.
    """
    if int(own.attrs["replicates"]) > 1:
        return np.asarray(own["replicate"].values)
    return np.asarray(nesting_of(own).sample % REPETITIONS, dtype=np.int32)


def own_rows(rows: xr.Dataset) -> xr.Dataset:
    """Return the rows drawn from the laws of the study alone, as they were."""
    if not has_rounds(rows):
        return rows
    found = rows.isel(sample=importance_of(rows).own).drop_vars([IMPORTANCE, ROUND])
    attrs = dict(found.attrs)
    samples, replicates = map(int, attrs.pop(OWN_SIZE))
    found.attrs = attrs | {"samples": samples, "replicates": replicates}
    if replicates > 1:
        return found
    of = found["replicate"]
    return found.assign_coords(replicate=of.copy(data=np.zeros_like(of.values)))


def with_rounds(
    own: xr.Dataset,
    rounds: Sequence[xr.Dataset],
    log_importance: Floats,
    repetition: NDArray[np.int32],
) -> xr.Dataset:
    """Return the rows of a study with those of further rounds.

    Parameters
    ----------
    own : xarray.Dataset
        Rows of the study.
    rounds : sequence of xarray.Dataset
        Results of the same model; where samples have several rows, of a multiple of their number.
    log_importance : ndarray, shape (n,)
        Of all rows.
    repetition : ndarray of int, shape (n,)
        The independent repetition of the sampler to which each row belongs: its replicate.
    """
    n = own.sizes["sample"]
    names = list(own.data_vars)
    new = xr.concat(
        [one[names].drop_vars(("replicate", "group", "block")) for one in rounds],
        "sample",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )
    new = new.assign_coords(
        {name: ("sample", values) for name, values in _places(own, new.sizes["sample"]).items()}
    )
    found = xr.concat(
        [own, new],
        "sample",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )
    sizes = [n, *(one.sizes["sample"] for one in rounds)]
    about = {"role": IMPORTANCE, "units": "1"}
    meaning = "how much the row counts before the inspections"
    found = found.assign(
        {
            IMPORTANCE: ("sample", np.exp(log_importance), about | {"long_name": meaning}),
            ROUND: (
                "sample",
                np.repeat(np.arange(len(sizes)), sizes),
                about | {"long_name": "0: a row of the study"},
            ),
        }
    )
    size = int(own.attrs["samples"]), int(own.attrs["replicates"])
    count = len(np.unique(repetition))
    return found.assign_coords(
        sample=found["sample"].copy(data=np.arange(found.sizes["sample"])),
        replicate=found["replicate"].copy(data=repetition),
    ).assign_attrs({"samples": len(repetition) // count, "replicates": count, OWN_SIZE: size})


def _places(own: xr.Dataset, count: int) -> dict[str, NDArray[np.integer]]:
    """Return the places of new rows in the design, after those of the study."""
    place = nesting_of(own)
    number = np.arange(count)
    sample, unit = np.divmod(number, place.units)
    found = {
        "replicate": np.zeros(count, own["replicate"].dtype),
        "group": own["group"].values.max() + 1 + sample,
        "block": np.zeros(count, own["block"].dtype),
    }
    if is_nested(own):
        found |= {
            "world": own["world"].values.max() + 1 + sample,
            "unit": unit.astype(own["unit"].dtype),
            "repeat": np.zeros(count, own["repeat"].dtype),
        }
    return found
