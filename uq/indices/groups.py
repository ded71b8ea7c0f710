"""Confidence intervals of methods with grouped rows, and Morris' elementary effects.

If each replicate has only about three hits of an event, or three rows of the regime that
scatters, the variance cannot be estimated reliably: eight such replicates may agree by chance.
Intervals that rest on few rows are therefore widened. docs/statistics.md reports the coverage with
and without the widening, and `benchmarks/coverage/few.py` counts the widened intervals.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from uq.contract import Floats
from uq.indices.index import IndexKind, Indices, RefusedError
from uq.indices.method import NO_EFFECT, DesignSample
from uq.sampling.unit_cube import STEP
from uq.stats.estimate import Estimate
from uq.stats.intervals import (
    CONFIDENCE,
    ROUNDING,
    is_constant,
    scatter_interval,
    sized,
    upper_probability,
)
from uq.stats.quantile_functions import student

ENOUGH_ROWS, ENOUGH_SHARE = 50, 0.22
"""Intervals are widened if the effective number of rows behind the variance is below the first
limit in each replicate, and below the second limit as a share of the rows. This share is one third
for a normal law."""

Values = Mapping[IndexKind, Mapping[str, float]]
"""Kind of index -> input -> value."""

MIN_TRAJECTORIES = 4
"""Minimum number of trajectories for a useful mean."""

MU = IndexKind("mu", "mean effect (mu)", "output")
SIGMA = IndexKind("sigma", "scatter of effects (sigma)", "output")
MU_STAR = IndexKind("mu_star", "mean magnitude of effects (mu*)", "output")


def pooled_with_intervals(
    estimate: Callable[[Floats], Values],
    pooled: Floats,
    replicates: Sequence[Floats],
    noun: str,
    lacking: str = "",
    confidence: float = CONFIDENCE,
) -> tuple[dict[IndexKind, dict[str, Estimate]], tuple[str, ...]]:
    """Return pooled estimates of all groups, with intervals from the scatter between replicates.

    Parameters
    ----------
    estimate : callable
        Complete groups, along the first axis -> indices.
    pooled : ndarray
        All complete groups.
    replicates : sequence of ndarray
        Groups of each replicate.
    noun : str
        Name of the indices in messages.
    lacking : str
        Reason why single replicates give no estimates, or "".
    confidence : float, optional

    Returns
    -------
    indices : dict
    notes : tuple of str
        Reasons for missing intervals.
    """
    notes: tuple[str, ...] = ()
    if len(replicates) == 1:
        notes = (f"no intervals: with replicates = 1 nothing shows the scatter of the {noun}",)
    elif lacking:
        notes = (f"no intervals: {lacking}",)
    scatter = [] if notes else [estimate(replicate) for replicate in replicates]

    def with_interval(kind: IndexKind, label: str, value: float) -> Estimate:
        estimates = np.array([values[kind][label] for values in scatter])
        return Estimate(value, *scatter_interval(value, estimates, confidence), lacking)

    indices = {
        kind: {label: with_interval(kind, label, value) for label, value in values.items()}
        for kind, values in estimate(pooled).items()
    }
    return indices, notes


def with_difference(
    estimate: Callable[[Floats], Values], pair: tuple[str, str] | None
) -> Callable[[Floats], Values]:
    """Return an estimator that also gives the difference between the indices of two inputs."""
    if pair is None:
        return estimate
    first, second = pair

    def both(groups: Floats) -> Values:
        return {
            kind: {**values, f"{first} - {second}": values[first] - values[second]}
            if first in values
            else values
            for kind, values in estimate(groups).items()
        }

    return both


def effective_rows(deviations: Floats) -> float:
    """Return the effective number of rows behind a variance.

    Parameters
    ----------
    deviations : ndarray, shape (n,) or (n, e)
        Deviations of each element from its mean.

    Returns
    -------
    float
        n divided by the kurtosis: n/3 for a normal law, about the number of hits for a rare event.
    """
    squares = _squares(deviations)
    return float(squares.sum() ** 2 / (squares**2).sum())


def one_more_row(
    deviations: Floats, groups: int, replicates: int, confidence: float = CONFIDENCE
) -> float:
    """Return the half-width to add for one more row as extreme as the most extreme.

    Parameters
    ----------
    deviations : ndarray, shape (n,) or (n, e)
        Deviations of the independent rows from their mean, scaled to variance 1 over all elements.
    groups, replicates : int
        Number of groups in all replicates, and number of replicates.
    confidence : float, optional

    Returns
    -------
    float
        Half-width; zero if the variance rests on enough rows, or on a sufficient share of them.
    """
    enough = min(ENOUGH_ROWS * replicates, ENOUGH_SHARE * len(deviations))
    if replicates < 2 or effective_rows(deviations) >= enough:
        return 0.0
    wide = student(upper_probability(confidence), replicates - 1)
    return float(wide * _squares(deviations).max() / groups)


def _squares(deviations: Floats) -> Floats:
    squares = deviations**2
    return squares if squares.ndim == 1 else np.asarray(squares.sum(axis=1))


def widened(estimate: Estimate, by: float) -> Estimate:
    """Return the estimate with half-widths increased to sqrt(half^2 + by^2)."""
    value = estimate.value
    below, above = (np.hypot(end - value, by) for end in (estimate.low, estimate.high))
    return replace(estimate, low=float(value - below), high=float(value + above))


def morris_indices(sample: DesignSample) -> Indices:
    """Estimate mean, mean magnitude and standard deviation of Morris' elementary effects.

    Parameters
    ----------
    sample : DesignSample
        Sample of trajectories.

    Returns
    -------
    Indices
        ``mu``, ``sigma`` and ``mu_star``, in the unit of the output, scaled to a change of the
        input over the full range of its law. They are pooled over all trajectories, with intervals
        from the scatter between replicates.

    Raises
    ------
    RefusedError
        The output is constant.

    Notes
    -----
    Trajectories selected for large distances favour the corners. Their intervals cover the average
    over selected trajectories, which differs from the mean over all trajectories by tens of per
    cent; the note of the design states this.

    References
    ----------
    F. Campolongo, J. Cariboni, A. Saltelli, "An effective screening design for sensitivity analysis
    of large models", Environ. Model. Softw. 22, 1509-1518 (2007).
    """
    (y, unit), whole = sized(sample.grouped), sample.whole  # squares neither overflow nor vanish
    if is_constant(y[whole]):
        raise RefusedError(NO_EFFECT)
    # A step within one discrete value changes no input, and has no effect.
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
