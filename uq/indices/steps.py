"""Which input changes from row to row of a group: as the design says, drawn once more.

The rows themselves cannot tell. A factor recovered from a product is rounded, and seems to change
where only what it multiplies does; an input of discrete values may stay as it is in its own step.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.designs.registry import DESIGNS
from uq.errors import InputError
from uq.rows.elements import Floats
from uq.study.file import Tied
from uq.study.reading import read_study_text


def directions(ds: xr.Dataset, order: NDArray[np.intp]) -> Floats:
    """Find the steps of a design in which one input changes at a time.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    order : ndarray of int, shape (R, N, d + 1)
        Row of each replicate, group and place in it.

    Returns
    -------
    ndarray, shape (R, N, d, d)
        Whether a step (third axis) raises an input (last axis), 1, lowers it, -1, or neither, 0,
        in probability.

    Raises
    ------
    InputError
        When the rows are not those of the design.
    """
    entries = read_study_text(ds.attrs["study"], "study of this result").uncertain
    scales = {name: e.times for name, e in entries.items() if not isinstance(e, Tied)}
    parameters = tuple(scales)
    direction = np.sign(np.diff(_unit(ds, order, len(parameters)), axis=2))
    places = [parameters.index(times or name) for name, times in scales.items()]
    changing = direction != 0
    sound = bool((changing.sum(axis=-1) == 1).all())
    for name, own, scale in zip(parameters, range(len(parameters)), places, strict=True):
        values = ds[name].values[order]
        still = ~(changing[..., own] | changing[..., scale])
        sound &= bool((values[..., 1:] == values[..., :-1])[still].all())
    if not sound:
        raise InputError(
            f"the rows are not those of its design as '{ds.attrs['design']}' is drawn here, so the"
            " effect of an input cannot be determined: run the study again"
        )
    return np.asarray(direction)


def _unit(ds: xr.Dataset, order: NDArray[np.intp], d: int) -> Floats:
    """Draw the points of the unit cube that the rows come from, shape (*order.shape, d)."""
    first = order[..., 0]
    group, replicate = ds["group"].values[first], ds["replicate"].values[first]
    start = int(group.min())
    points = DESIGNS[ds.attrs["design"]].unit_rows(
        seed=int(ds.attrs["seed"]),
        replicates=int(ds.attrs["replicates"]),
        d=d,
        samples=int(ds.attrs["samples"]),
        second_order=bool(ds.attrs["second_order"]),
        start=start,
        stop=int(group.max()) + 1,
    )
    return points[group - start, replicate]
