"""Morris' elementary effects: which inputs matter at all, from few rows."""

from collections.abc import Sequence

import numpy as np

from uq.designs.trajectories import STEP
from uq.estimate import Estimate
from uq.intervals import ROUNDING, is_constant
from uq.methods.groups import by_replicates
from uq.methods.indices import Indices, Kind, RefusedError
from uq.methods.method import NO_EFFECT
from uq.methods.sample import Floats, Sample

MIN_TRAJECTORIES = 4
"""Fewer trajectories than this give no mean worth the name."""

MU = Kind("mu", "mean effect (mu)", "output")
SIGMA = Kind("sigma", "scatter of effects (sigma)", "output")
MU_STAR = Kind("mu_star", "mean magnitude of effects (mu*)", "output")


def morris_indices(sample: Sample) -> Indices:
    """Estimate mean, mean magnitude and standard deviation of the elementary effects.

    Parameters
    ----------
    sample : Sample
        Of trajectories.

    Returns
    -------
    Indices
        ``mu``, ``sigma`` and ``mu_star``, in the output's unit, for a change of the input from the
        bottom to the top of its law if the effect were the same all the way. From all
        trajectories together; the interval from the same estimate by replicates.

    Raises
    ------
    RefusedError
        A constant output.

    Notes
    -----
    Trajectories chosen far apart favour the corners. There the intervals are of what such
    trajectories give on average, which differs from the mean over all trajectories by tens of per
    cent; the design says so.

    References
    ----------
    F. Campolongo, J. Cariboni, A. Saltelli, "An effective screening design for sensitivity analysis
    of large models", Environ. Model. Softw. 22, 1509-1518 (2007).
    """
    y, whole = sample.values[sample.groups], sample.whole
    if is_constant(y[whole]):
        raise RefusedError(NO_EFFECT)
    # A step within one of several discrete values changes no input, and has no effect.
    effects = np.einsum("rns,rnsp->rnp", np.diff(y, axis=2), sample.direction) / STEP

    replicates = [own[rows] for own, rows in zip(effects, whole, strict=True)]
    rounding = ROUNDING * np.abs(y[whole]).max()
    few = any(len(own) < 2 for own in replicates)
    found, notes = by_replicates(
        lambda groups: _estimates(list(sample.inputs), groups, rounding),
        effects[whole],
        replicates,
        "effects",
        "some replicates have fewer than two whole trajectories" if few else "",
    )
    indices: dict[Kind, dict[str, Estimate]] = {MU: {}, SIGMA: {}, MU_STAR: {}}
    for (kind, name), estimate in found.items():
        indices[kind][name] = estimate
    return Indices(indices, notes)


def _estimates(
    names: Sequence[str], effects: Floats, rounding: float
) -> dict[tuple[Kind, str], float]:
    """Return each measure from effects of shape (n, d); no sigma below rounding."""
    sigma = effects.std(axis=0, ddof=1)
    measures = {
        MU: effects.mean(axis=0),
        SIGMA: np.where(sigma > rounding, sigma, 0.0),
        MU_STAR: np.abs(effects).mean(axis=0),
    }
    return {
        (kind, name): float(value)
        for kind, found in measures.items()
        for name, value in zip(names, found, strict=True)
    }
