"""Which input changes from row to row of a group: as the design says, drawn once more.

The rows themselves cannot tell. A factor recovered from a product is rounded, and seems to change
where only what it multiplies does; an input of discrete values may stay as it is in its own step.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.designs.registry import DESIGNS
from uq.errors import InputError
from uq.methods.groups import grouped_rows
from uq.rows.elements import Floats
from uq.study.file import Tied
from uq.study.reading import read_study_text


class Steps(NamedTuple):
    """Groups of rows in which one input changes at a time.

    Attributes
    ----------
    order : ndarray of int, shape (R, N, d + 1)
        Row of each replicate, group and place in it.
    parameters : tuple of str
        The inputs that change, d of them.
    direction : ndarray, shape (R, N, d, d)
        Whether a step (third axis) raises an input (last axis), 1, lowers it, -1, or neither, 0,
        in probability.
    """

    order: NDArray[np.intp]
    parameters: tuple[str, ...]
    direction: Floats


def steps(ds: xr.Dataset) -> Steps:
    """Find the groups of a design in which one input changes at a time, and its steps.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    Steps

    Raises
    ------
    InputError
        When rows are missing or are not those of the design.
    """
    order, _ = grouped_rows(ds)
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
    return Steps(order, parameters, direction)


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
