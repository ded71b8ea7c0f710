"""Morris' elementary effects: which inputs matter at all, from few rows."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.designs.trajectories import STEP
from uq.methods.groups import whole_groups
from uq.indices.steps import steps
from uq.indices.targets import Index, Indices, RefusedError
from uq.intervals import ROUNDING, is_constant, scatter_interval
from uq.rows.elements import Floats

MIN_TRAJECTORIES = 4
"""Fewer trajectories than this give no mean worth the name."""

_CORNERS = (
    "trajectories chosen far apart favour the corners of the inputs: the effects are theirs, tens"
    " of per cent off those of all trajectories, which the design 'morris' estimates"
)


class Trajectories(NamedTuple):
    """Where the rows of a Morris design stand.

    Attributes
    ----------
    order : ndarray of int, shape (R, N, d + 1)
        Row of each replicate, trajectory and point on it.
    parameters : tuple of str
        The inputs that change, d of them.
    direction : ndarray, shape (R, N, d, d)
        Whether a step (third axis) raises an input (last axis), 1, lowers it, -1, or neither, 0,
        in probability.
    optimised : bool
        Whether they were chosen far apart.
    """

    order: NDArray[np.intp]
    parameters: tuple[str, ...]
    direction: Floats
    optimised: bool


def trajectories(ds: xr.Dataset) -> Trajectories:
    """Find the trajectories of a Morris design.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    Trajectories

    Raises
    ------
    InputError
        When rows are missing or are not those of the design.
    """
    return Trajectories(*steps(ds), optimised=ds.attrs["design"] == "morris-optimised")


def morris_indices(design: Trajectories, values: Floats) -> Indices:
    """Estimate mean, mean magnitude and standard deviation of the elementary effects.

    Parameters
    ----------
    design : Trajectories
    values : ndarray, shape (n,)
        One number per row of the result, NaN where there is none: its whole trajectory is left out.

    Returns
    -------
    Indices
        ``mu``, ``sigma`` and ``mu_star``, in the output's unit, for a change of the input from the
        bottom to the top of its law if the effect were the same all the way. From all
        trajectories together; the interval from the same estimate by replicates.

    Raises
    ------
    RefusedError
        Too few trajectories, or a constant output.

    Notes
    -----
    Trajectories chosen far apart favour the corners. There the intervals are of what such
    trajectories give on average, which differs from the mean over all trajectories by tens of per
    cent; a note says so.

    References
    ----------
    F. Campolongo, J. Cariboni, A. Saltelli, "An effective screening design for sensitivity analysis
    of large models", Environ. Model. Softw. 22, 1509-1518 (2007).
    """
    whole = whole_groups(values, design.order)
    kept = int(whole.sum())
    if kept < MIN_TRAJECTORIES:
        raise RefusedError(
            f"only {kept} of {whole.size} trajectories are whole; {MIN_TRAJECTORIES} are needed"
        )
    y = values[design.order]
    if is_constant(y[whole]):
        raise RefusedError("the same value in all rows: nothing depends on the inputs")
    # A step within one of several discrete values changes no input, and has no effect.
    effects = np.einsum("rns,rnsp->rnp", np.diff(y, axis=2), design.direction) / STEP

    replicates = [own[rows] for own, rows in zip(effects, whole, strict=True)]
    rounding = ROUNDING * np.abs(y[whole]).max()
    scatter: list[dict[str, Floats]] = []
    notes = [_CORNERS] if design.optimised else []
    if len(replicates) == 1:
        notes.append("no intervals: with replicates = 1 nothing shows the scatter of the effects")
    elif any(len(own) < 2 for own in replicates):
        notes.append("no intervals: some replicates have fewer than two whole trajectories")
    else:
        scatter = [_estimates(own, rounding) for own in replicates]
    indices: dict[str, dict[str, Index]] = {}
    for kind, found in _estimates(effects[whole], rounding).items():
        indices[kind] = {
            name: Index(
                float(value),
                *scatter_interval(float(value), np.array([one[kind][i] for one in scatter])),
            )
            for i, (name, value) in enumerate(zip(design.parameters, found, strict=True))
        }
    return Indices(indices, tuple(notes))


def _estimates(effects: Floats, rounding: float) -> dict[str, Floats]:
    """Return each measure, shape (d,), from effects of shape (n, d); no sigma below rounding."""
    sigma = effects.std(axis=0, ddof=1)
    return {
        "mu": effects.mean(axis=0),
        "sigma": np.where(sigma > rounding, sigma, 0.0),
        "mu_star": np.abs(effects).mean(axis=0),
    }
