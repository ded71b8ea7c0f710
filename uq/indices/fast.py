"""Extended FAST: first-order and total indices from the spectrum along a curve for each input."""

from math import floor

import numpy as np

from uq.contract import Floats
from uq.indices.index import ALL_NOISE, S1, ST, IndexKind, Indices, RefusedError
from uq.indices.sample import DesignSample
from uq.sampling.unit_cube import HARMONICS
from uq.stats.estimate import Estimate
from uq.stats.intervals import is_constant


def fast_indices(sample: DesignSample) -> Indices:
    """Estimate first-order and total indices.

    Parameters
    ----------
    sample : DesignSample
        Of curves, one for each input.

    Returns
    -------
    Indices
        ``S1`` and ``ST``, means over replicates, without intervals: the scatter between replicates,
        which the notes report, does not include the error of representing an input by a few
        harmonics, many times larger for the Ishigami function. For a random model they are shares
        of the mean variance at one seed: curves are weighted by their variance.

    Raises
    ------
    RefusedError
        No whole curve for some input, or a constant output.

    References
    ----------
    A. Saltelli, S. Tarantola, K. P.-S. Chan, "A quantitative model-independent method for global
    sensitivity analysis of model output", Technometrics 41, 39-56 (1999).
    """
    y, whole = sample.grouped, sample.whole
    parameters = [label.removeprefix("curve_") for label in sample.blocks]
    for name, complete in zip(parameters, whole.T, strict=True):
        if not complete.any():
            raise RefusedError(f"none of {len(whole)} curves for {name} has a value in each row")
    moves = np.array([[not sample.is_constant(curve) for curve in curves] for curves in y])
    if sample.random and not (moves & whole).any(axis=0).all():
        raise RefusedError(ALL_NOISE)
    if not sample.random and not moves[whole].all():
        raise RefusedError("the same value along a whole curve: there is no variance to apportion")
    points = y.shape[2]
    omega = floor((points - 1) / (2 * HARMONICS))
    # The estimator loses digits for values far from zero.
    y = y - y[whole].mean(axis=(0, 1))
    indices: dict[IndexKind, dict[str, Estimate]] = {S1: {}, ST: {}}
    scatter = dict.fromkeys(indices, 0.0)
    for i, name in enumerate(parameters):
        moving = y[whole[:, i] & moves[:, i], i]
        shares = np.array([_orders(curve, omega) for curve in moving])
        spread = moving.var(axis=1).reshape(len(moving), -1).sum(axis=1)
        weights = spread if sample.random else None
        for kind, column in zip(indices, shares.T, strict=True):
            indices[kind][name] = Estimate(float(np.average(column, weights=weights)))
            if len(column) > 1:
                scatter[kind] = max(scatter[kind], float(column.std(ddof=1)))
    deviations = " and ".join(f"{kind.key} by {sd:.2g}" for kind, sd in scatter.items() if sd)
    seen = f": between replicates {deviations} at most (standard deviation)" if deviations else ""
    notes = [
        "no intervals: the method's own error, from representing an input by a few harmonics, does"
        f" not show in the scatter{seen}"
    ]
    others, room = len(parameters) - 1, omega // (2 * HARMONICS)
    if room < others:
        needed = 4 * HARMONICS**2 * others + 1
        notes.append(
            f"{others} inputs share {room} frequencies; samples = {needed} would give each its own"
        )
    return Indices(indices, tuple(notes))


def _orders(curve: Floats, omega: int) -> Floats:
    """Return S1 and ST from the output along a curve, shape (points,) or (points, e).

    Indices of several elements are averaged, weighted by their variance.
    """
    from SALib.analyze.fast import compute_orders

    elements = curve.reshape(len(curve), -1).T
    moving = elements[[not is_constant(element) for element in elements]]
    orders = [compute_orders(element, len(element), HARMONICS, omega) for element in moving]
    weights = moving.var(axis=1)
    return np.average(orders, axis=0, weights=weights / weights.sum())
