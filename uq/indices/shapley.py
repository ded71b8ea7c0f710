"""Shapley effects: shares of the variance that sum to one, whatever the inputs do together."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.indices.groups import whole_groups
from uq.indices.steps import steps
from uq.indices.targets import ALL_NOISE, Index, Indices, RefusedError
from uq.intervals import UNKNOWN, Ends, is_constant, scatter_interval
from uq.rows.elements import Floats

MIN_PATHS = 32
"""Fewer paths than this have a mean whose interval Student's law does not give."""


class Paths(NamedTuple):
    """Where the rows of a Shapley design stand.

    Attributes
    ----------
    order : ndarray of int, shape (n, d + 1)
        Row of each path and point on it, of all replicates.
    parameters : tuple of str
    changed : ndarray of bool, shape (n, d, d)
        Whether a step (second axis) changes an input (last axis).
    """

    order: NDArray[np.intp]
    parameters: tuple[str, ...]
    changed: NDArray[np.bool_]


def paths(ds: xr.Dataset) -> Paths:
    """Find the paths of a Shapley design.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    Paths

    Raises
    ------
    InputError
        When rows are missing or are not those of the design.
    """
    order, parameters, direction = steps(ds)
    d = len(parameters)
    return Paths(order.reshape(-1, d + 1), parameters, direction.reshape(-1, d, d) != 0)


def shapley_indices(design: Paths, values: Floats) -> Indices:
    """Estimate the Shapley effect of each input.

    Parameters
    ----------
    design : Paths
    values : ndarray, shape (n,)
        One number per row of the result, NaN where there is none: its whole path is left out.

    Returns
    -------
    Indices
        ``shapley``, shares of the variance. Paths are independent: the interval is Student's, of
        the ratio to first order.

    Raises
    ------
    RefusedError
        Too few paths, a constant output, or one that is constant along each path.

    Notes
    -----
    Along a path from one row to an independent one, input by input in random order, step k moves
    the output from before to after. With the output y at the start of the path, the mean of
    (y - (before + after)/2) (before - after) over the steps of an input is its Shapley effect
    times the variance [1]_; their sum over a path is (y - end)^2/2.

    References
    ----------
    .. [1] T. Goda, "A simple algorithm for global sensitivity analysis with Shapley effects",
       Reliab. Eng. Syst. Saf. 213, 107702 (2021).
    """
    whole = whole_groups(values, design.order)
    kept = int(whole.sum())
    if kept < MIN_PATHS:
        raise RefusedError(f"only {kept} of {whole.size} paths are whole; {MIN_PATHS} are needed")
    y = values[design.order][whole]
    if is_constant(y):
        raise RefusedError("the same value in all rows: there is no variance to apportion")
    before, after = y[:, :-1], y[:, 1:]
    steps = (y[:, :1] - (before + after) / 2) * (before - after)
    parts = np.einsum("ns,nsp->np", steps, design.changed[whole])
    total = parts.sum(axis=1)
    if is_constant(y - y[:, :1]):
        raise RefusedError(ALL_NOISE)
    shares = parts.mean(axis=0) / total.mean()
    errors = (parts - shares * total[:, None]) / total.mean()
    return Indices(
        {
            "shapley": {
                name: Index(float(share), *_interval(float(share), error))
                for name, share, error in zip(design.parameters, shares, errors.T, strict=True)
            }
        }
    )


def _interval(share: float, errors: Floats) -> Ends:
    """Return the interval of a share from the errors of its paths, none of rounding alone."""
    return UNKNOWN if is_constant(share + errors) else scatter_interval(share, errors)
