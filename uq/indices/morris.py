"""Morris' elementary effects: which inputs matter at all, from few rows."""

import numpy as np

from uq.contract import Floats
from uq.indices.groups import Values, pooled_with_intervals
from uq.indices.index import IndexKind, Indices, RefusedError
from uq.indices.method import NO_EFFECT
from uq.indices.sample import DesignSample
from uq.sampling.unit_cube import STEP
from uq.stats.intervals import ROUNDING, is_constant, sized

MIN_TRAJECTORIES = 4
"""Fewer trajectories than this do not give a useful mean."""

MU = IndexKind("mu", "mean effect (mu)", "output")
SIGMA = IndexKind("sigma", "scatter of effects (sigma)", "output")
MU_STAR = IndexKind("mu_star", "mean magnitude of effects (mu*)", "output")


def morris_indices(sample: DesignSample) -> Indices:
    """Estimate mean, mean magnitude and standard deviation of the elementary effects.

    Parameters
    ----------
    sample : DesignSample
        Of trajectories.

    Returns
    -------
    Indices
        ``mu``, ``sigma`` and ``mu_star``, in the output's unit, scaled to a change of the input
        over the whole range of its law. Pooled over all trajectories, with intervals from the
        scatter between replicates.

    Raises
    ------
    RefusedError
        A constant output.

    Notes
    -----
    Trajectories chosen far apart favour the corners. Their intervals are those of the average over
    such trajectories, which differs from the mean over all trajectories by tens of per cent; the
    note of the design states this.

    References
    ----------
    F. Campolongo, J. Cariboni, A. Saltelli, "An effective screening design for sensitivity analysis
    of large models", Environ. Model. Softw. 22, 1509-1518 (2007).
    """
    (y, unit), whole = sized(sample.grouped), sample.whole  # squares neither overflow nor vanish
    if is_constant(y[whole]):
        raise RefusedError(NO_EFFECT)
    # A step within one of several discrete values changes no input, and has no effect.
    effects = np.einsum("rns,rnsp->rnp", np.diff(y, axis=2), sample.direction) / STEP

    replicates = [replicate[rows] for replicate, rows in zip(effects, whole, strict=True)]
    rounding = ROUNDING * np.abs(y[whole]).max()
    few = any(len(replicate) < 2 for replicate in replicates)
    lacking = "some replicates have fewer than two whole trajectories" if few else ""

    def measures(effects: Floats) -> Values:  # of shape (n, d); no sigma below rounding
        sigma = effects.std(axis=0, ddof=1)
        statistics = {
            MU: effects.mean(axis=0),
            SIGMA: np.where(sigma > rounding, sigma, 0.0),
            MU_STAR: np.abs(effects).mean(axis=0),
        }
        return {
            kind: dict(zip(sample.inputs, (unit * values).tolist(), strict=True))
            for kind, values in statistics.items()
        }

    return Indices(*pooled_with_intervals(measures, effects[whole], replicates, "effects", lacking))
