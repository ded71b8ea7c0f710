"""Importance weights of rows that were not drawn from the laws of the study."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.result.result import Result
from uq.result.weights import IMPORTANCE, OWN_SIZE, ROUND

REPETITIONS = 8
"""Independent repetitions of the sampler, where the design has no replicates of its own."""


def importance_of(rows: Result) -> Floats:
    """Return the prior importance weight of each row, shape (n,)."""
    return rows.dataset[IMPORTANCE].values if rows.has_rounds else np.ones(len(rows))


def from_study(rows: Result) -> Mask:
    """Return the mask of rows drawn from the laws of the study, shape (n,)."""
    return rows.dataset[ROUND].values == 0 if rows.has_rounds else np.ones(len(rows), dtype=bool)


def repetitions_of(rows: Result) -> NDArray[np.int32]:
    """Return the sampler repetition to which each initial row is assigned, shape (n,).

    A repetition starts from one replicate of a replicated design, else from an eighth of the
    samples.
    """
    if int(rows.dataset.attrs["replicates"]) > 1:
        return np.asarray(rows.dataset["replicate"].values)
    return np.asarray(rows.nesting.sample % REPETITIONS, dtype=np.int32)


def own_rows(rows: Result) -> Result:
    """Return only the rows drawn from the laws of the study, without weights of new rounds."""
    if not rows.has_rounds:
        return rows
    study_rows = rows.take(from_study(rows)).dataset.drop_vars([IMPORTANCE, ROUND])
    attrs = dict(study_rows.attrs)
    samples, replicates = map(int, attrs.pop(OWN_SIZE))
    study_rows.attrs = attrs | {"samples": samples, "replicates": replicates}
    if replicates > 1:
        return Result(study_rows)
    replicate = study_rows["replicate"]
    nothing = replicate.copy(data=np.zeros_like(replicate.values))
    return Result(study_rows.assign_coords(replicate=nothing))


def with_rounds(
    study_rows: Result,
    rounds: Sequence[xr.Dataset],
    log_importance: Floats,
    repetition: NDArray[np.int32],
) -> xr.Dataset:
    """Append the rows of further sampling rounds to the rows of a study.

    Parameters
    ----------
    study_rows : Result
        Rows of the study.
    rounds : sequence of xarray.Dataset
        Results of the same model; where samples have several rows, of a multiple of their number.
    log_importance : ndarray, shape (n,)
        Of all rows.
    repetition : ndarray of int, shape (n,)
        The independent repetition of the sampler to which each row belongs: its replicate.
    """
    n = len(study_rows)
    names = list(study_rows.dataset.data_vars)
    new = _one_below_the_other(
        [round_rows[names].drop_vars(("replicate", "group", "block")) for round_rows in rounds]
    )
    new = new.assign_coords(
        {name: ("row", values) for name, values in _places(study_rows, new.sizes["row"]).items()}
    )
    combined = _one_below_the_other([study_rows.dataset, new])
    sizes = [n, *(round_rows.sizes["row"] for round_rows in rounds)]
    about = {"role": IMPORTANCE, "units": "1"}
    meaning = "how much the row counts before the inspections"
    combined = combined.assign(
        {
            IMPORTANCE: ("row", np.exp(log_importance), about | {"long_name": meaning}),
            ROUND: (
                "row",
                np.repeat(np.arange(len(sizes)), sizes),
                about | {"long_name": "0: a row of the study"},
            ),
        }
    )
    size = int(study_rows.dataset.attrs["samples"]), int(study_rows.dataset.attrs["replicates"])
    count = len(np.unique(repetition))
    return combined.assign_coords(
        row=combined["row"].copy(data=np.arange(combined.sizes["row"])),
        replicate=combined["replicate"].copy(data=repetition),
    ).assign_attrs({"samples": len(repetition) // count, "replicates": count, OWN_SIZE: size})


def _one_below_the_other(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Concatenate the rows of all parts; common variables are taken from the first part."""
    return xr.concat(
        parts,
        "row",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )


def _places(study_rows: Result, count: int) -> dict[str, NDArray[np.integer]]:
    """Return the design indices of new rows, numbered after the rows of the study."""
    place = study_rows.nesting
    number = np.arange(count)
    sample, unit = np.divmod(number, place.units)
    coordinates = {
        "replicate": np.zeros(count, study_rows.dataset["replicate"].dtype),
        "group": study_rows.dataset["group"].values.max() + 1 + sample,
        "block": np.zeros(count, study_rows.dataset["block"].dtype),
    }
    if study_rows.is_nested:
        coordinates |= {
            "world": study_rows.dataset["world"].values.max() + 1 + sample,
            "unit": unit.astype(study_rows.dataset["unit"].dtype),
            "repeat": np.zeros(count, study_rows.dataset["repeat"].dtype),
        }
    return coordinates
