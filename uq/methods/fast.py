"""Extended FAST: first-order and total indices from the spectrum along a curve for each input."""

from math import floor
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from SALib.analyze.fast import compute_orders

from uq.designs.curves import HARMONICS
from uq.methods.groups import grouped_rows, whole_groups
from uq.indices.targets import ALL_NOISE, Index, Indices, RefusedError
from uq.intervals import is_constant
from uq.rows.elements import Floats


class Curves(NamedTuple):
    """Where the rows of an extended FAST design stand.

    Attributes
    ----------
    order : ndarray of int, shape (R, d, N)
        Row of each replicate, curve and point on it.
    parameters : tuple of str
        The input that each of the d curves is for.
    random : bool
        Whether curves differ in their seed, and so in the function that they are curves of.
    """

    order: NDArray[np.intp]
    parameters: tuple[str, ...]
    random: bool


def curves(ds: xr.Dataset) -> Curves:
    """Find the curves of an extended FAST design.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    Curves

    Raises
    ------
    InputError
        When rows are missing.
    """
    order, labels = grouped_rows(ds)
    names = tuple(label[len("curve_") :] for label in labels)
    return Curves(order.transpose(0, 2, 1), names, bool(ds.attrs.get("random")))


def fast_indices(design: Curves, values: Floats) -> Indices:
    """Estimate first-order and total indices.

    Parameters
    ----------
    design : Curves
    values : ndarray, shape (n,)
        One number per row of the result, NaN where there is none: its whole curve is left out.

    Returns
    -------
    Indices
        ``S1`` and ``ST``, means over replicates, without intervals: replicates show how far they
        scatter, not how far they are off because an input is told by a few harmonics only, which
        on the Ishigami function is many times more. The notes give the scatter. Of a random model
        they are shares of the mean variance at one seed: each curve counts by its variance.

    Raises
    ------
    RefusedError
        No whole curve for some input, or a constant output.

    References
    ----------
    A. Saltelli, S. Tarantola, K. P.-S. Chan, "A quantitative model-independent method for global
    sensitivity analysis of model output", Technometrics 41, 39-56 (1999).
    """
    y, whole = values[design.order], whole_groups(values, design.order)
    for name, own in zip(design.parameters, whole.T, strict=True):
        if not own.any():
            raise RefusedError(f"none of {len(whole)} curves for {name} has a value in each row")
    moves = np.array([[not is_constant(curve) for curve in own] for own in y])
    if design.random and not (moves & whole).any(axis=0).all():
        raise RefusedError(ALL_NOISE)
    if not design.random and not moves[whole].all():
        raise RefusedError("the same value along a whole curve: there is no variance to apportion")
    points = y.shape[2]
    omega = floor((points - 1) / (2 * HARMONICS))
    # The estimator loses digits on values far from zero.
    y = y - y[whole].mean()
    indices: dict[str, dict[str, Index]] = {"S1": {}, "ST": {}}
    scatter = dict.fromkeys(indices, 0.0)
    for i, name in enumerate(design.parameters):
        moving = y[whole[:, i] & moves[:, i], i]
        own = np.array([compute_orders(curve, points, HARMONICS, omega) for curve in moving])
        weights = moving.var(axis=1) if design.random else None
        for kind, column in zip(indices, own.T, strict=True):
            indices[kind][name] = Index(float(np.average(column, weights=weights)))
            if len(column) > 1:
                scatter[kind] = max(scatter[kind], float(column.std(ddof=1)))
    return Indices(indices, (_why_no_intervals(scatter), *_too_coarse(design, omega)))


def _why_no_intervals(scatter: dict[str, float]) -> str:
    spread = " and ".join(f"{kind} by {sd:.2g}" for kind, sd in scatter.items() if sd)
    seen = f": between replicates {spread} at most (standard deviation)" if spread else ""
    return (
        "no intervals: the method's own error, from telling an input by a few harmonics, does not"
        f" show in the scatter{seen}"
    )


def _too_coarse(design: Curves, omega: int) -> list[str]:
    others, room = len(design.parameters) - 1, omega // (2 * HARMONICS)
    if room >= others:
        return []
    needed = 4 * HARMONICS**2 * others + 1
    return [f"{others} inputs share {room} frequencies; samples = {needed} would give each its own"]
