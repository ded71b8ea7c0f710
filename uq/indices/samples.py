"""The sample that a sensitivity method works on: where the rows of its design stand in a result."""

from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.designs.layouts import PLAIN
from uq.designs.registry import DESIGNS
from uq.errors import InputError
from uq.indices.independent_inputs import independent_inputs
from uq.indices.steps import directions
from uq.methods.sample import Sample
from uq.rows.elements import flags


def sample_of(ds: xr.Dataset) -> Sample:
    """Find the groups of a design, in which no row has a value yet.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    Sample

    Raises
    ------
    InputError
        When a group lacks rows, or rows are not those of the design.
    """
    layout = DESIGNS[ds.attrs["design"]].layout
    nothing = np.full(ds.sizes["sample"], np.nan)
    sample = Sample.plain(nothing, independent_inputs(ds), random=bool(ds.attrs.get("random")))
    if layout is PLAIN:
        return sample
    groups, blocks = _grouped_rows(ds)
    return replace(
        sample,
        groups=groups.transpose(0, 2, 1) if layout.by_block else groups,
        blocks=blocks,
        direction=directions(ds, groups) if layout.one_at_a_time else np.empty(0),
    )


def _grouped_rows(ds: xr.Dataset) -> tuple[NDArray[np.intp], tuple[str, ...]]:
    """Return the row of each replicate, group and block, shape (R, N, k), and the blocks' names."""
    labels = flags(ds["block"])
    keys = np.stack([ds[name].values for name in ("replicate", "group", "block")])
    order = np.lexsort(keys[::-1])
    if order.size % len(labels) == 0:
        groups = keys[:, order].reshape(3, -1, len(labels))
        whole = (np.ptp(groups[:2], axis=2) == 0).all()
        if whole and (groups[2] == [code for code, _ in labels]).all():
            order = order.reshape(ds.attrs["replicates"], -1, len(labels))
            return order, tuple(label for _, label in labels)
    raise InputError("rows of the design are missing: its indices need whole groups")
