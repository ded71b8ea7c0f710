"""Sensitivity from a plain sample: indices beside those of inputs without effect.

A replicate with three hits of an event, or three rows of the regime that scatters, does not show
the scatter of the next three, and eight such replicates may agree by chance. Where few rows count,
intervals are therefore widened; docs/statistics.md states what they cover with and without it, and
`benchmarks/coverage/few.py` counts the widened ones.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from uq.indices.index import IndexKind, Indices, Null, RefusedError
from uq.indices.sample import DesignSample, Floats
from uq.indices.slices import has_many_equal
from uq.stats.estimate import Estimate
from uq.stats.intervals import CONFIDENCE, scatter_interval, upper_probability
from uq.stats.quantile_functions import student

ENOUGH_ROWS, ENOUGH_SHARE = 50, 0.22
"""Where the variance rests on fewer rows of each replicate, and on less than this share of them,
intervals are widened. Of a normal law it rests on a third of the rows."""

Values = Mapping[IndexKind, Mapping[str, float]]
"""Kind of index -> input -> value."""


def pooled_with_intervals(
    estimate: Callable[[Floats], Values],
    pooled: Floats,
    replicates: Sequence[Floats],
    noun: str,
    lacking: str = "",
    confidence: float = CONFIDENCE,
) -> tuple[dict[IndexKind, dict[str, Estimate]], tuple[str, ...]]:
    """Estimate from all groups together, with intervals from the same estimate by replicates.

    Parameters
    ----------
    estimate : callable
        Whole groups, along the first axis -> indices.
    pooled : ndarray
        All whole groups.
    replicates : sequence of ndarray
        Groups of each replicate.
    noun : str
        Name of the indices in messages.
    lacking : str
        Why single replicates give no estimates, or "".
    confidence : float, optional

    Returns
    -------
    indices : dict
    notes : tuple of str
        Why there are no intervals.
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
    """Return an estimate that also gives the difference between the indices of two inputs."""
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
    """Return the number of rows that a variance rests on.

    Parameters
    ----------
    deviations : ndarray, shape (n,) or (n, e)
        From the mean, of each element.

    Returns
    -------
    float
        n over the kurtosis: n/3 for a normal law, about the number of hits for a rare event.
    """
    squares = _squares(deviations)
    return float(squares.sum() ** 2 / (squares**2).sum())


def one_more_row(
    deviations: Floats, groups: int, replicates: int, confidence: float = CONFIDENCE
) -> float:
    """Return the half-width that one more row, as extreme as the most extreme, adds to an interval.

    Parameters
    ----------
    deviations : ndarray, shape (n,) or (n, e)
        Of the independent rows from their mean, of variance 1, all elements together.
    groups, replicates : int
        All groups of all replicates.
    confidence : float, optional

    Returns
    -------
    float
        A half-width; zero where the variance rests on enough rows, or on a common share of them.
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
    """Return an estimate whose half-widths are sqrt(half^2 + by^2)."""
    value = estimate.value
    below, above = (np.hypot(end - value, by) for end in (estimate.low, estimate.high))
    return replace(estimate, low=float(value - below), high=float(value + above))


MIN_ROWS = 64
"""Fewer rows than this leave too few in each slice of an input."""

DUMMIES = 19
"""One input in twenty without effect exceeds the largest of 19."""

Measure = Callable[[Floats, DesignSample], tuple[dict[IndexKind, Floats], tuple[str, ...]]]
"""Columns of inputs, shape (n, k), and the sample -> raw indices, shape (k,) each, and notes."""


def one_kind(kind: IndexKind, measure: Callable[[Floats, Floats], Floats]) -> Measure:
    """Return the measure of one kind of index, from columns of inputs and the output."""
    return lambda x, sample: ({kind: measure(x, sample.values)}, ())


def beside_nulls(
    measure: Measure,
    correction: Callable[[Floats, Floats], Floats] | None = None,
) -> Callable[[DesignSample], Indices]:
    """Return an estimator of indices that also gives their null, from inputs without effect.

    Parameters
    ----------
    measure : callable
        See `Measure`; NaN for an input whose rows are all in one slice.
    correction : callable, optional
        ``correction(raw, idle)`` -> indices, from raw ones and those of inputs without effect.

    Returns
    -------
    callable
        ``estimate(sample)`` of a `uq.indices.method.SensitivityMethod`.
    """
    corrected = correction or (lambda raw, idle: raw)

    def estimate(sample: DesignSample) -> Indices:
        x = sample.inputs
        rng = np.random.default_rng(0)
        dummies = DUMMIES if sample.nulls or correction else 0
        columns = np.column_stack([*x.values(), rng.random((len(sample.values), dummies))])
        raw, notes = measure(columns, sample)
        idle = {kind: values[len(x) :] for kind, values in raw.items()}
        indices: dict[IndexKind, dict[str, Estimate]] = {kind: {} for kind in raw}
        notes = (*notes, *_no_slices(list(x), raw))
        for i, (name, column) in enumerate(x.items()):
            null_values = idle
            sliced = not all(np.isnan(values[i]) for values in raw.values())
            if sliced and dummies and has_many_equal(column):
                shuffled = np.column_stack([rng.permutation(column) for _ in range(DUMMIES)])
                null_values, _ = measure(shuffled, sample)
                reached = {kind: corrected(values, values) for kind, values in null_values.items()}
                notes = (*notes, _shuffled_note(name, reached))
            for kind, values in raw.items():
                indices[kind][name] = Estimate(float(corrected(values[i], null_values[kind])))
        reached = {kind: corrected(values, values) for kind, values in idle.items() if dummies}
        return Indices(
            indices, notes, {kind: null_of(values, len(x)) for kind, values in reached.items()}
        )

    return estimate


def null_of(reached: Floats, inputs: int) -> Null:
    """Return the limits for one input without effect, and for the largest of several."""
    return Null(float(reached.max()), largest_of(inputs, reached) if inputs > 1 else np.nan)


def largest_of(inputs: int, idle: Floats) -> float:
    """Return an upper 95 % limit of the largest index of several inputs without effect.

    Parameters
    ----------
    inputs : int
    idle : ndarray, shape (k,)
        Index of each of some inputs without effect.

    Returns
    -------
    float
        By Gumbel's law of the same mean and variance, whose tail is heavier than that of any of
        these indices: one or more of 3 to 60 inputs without effect exceeded it in 0.5 to 7 % of
        samples.
    """
    scale = float(idle.std(ddof=1)) * np.sqrt(6) / np.pi
    quantile = -np.log(-np.log(0.95 ** (1 / inputs)))
    gumbel_quantile = idle.mean() + scale * (quantile - np.euler_gamma)
    return float(max(gumbel_quantile, idle.max()))


def _no_slices(names: Sequence[str], raw: Mapping[IndexKind, Floats]) -> list[str]:
    """Return a note on each input whose rows are all in one slice; refuse if all inputs are so."""
    reasons = [
        f"{name} has too few rows of any value but one: no {' or '.join(lost)}"
        for i, name in enumerate(names)
        if (lost := [kind.key for kind, values in raw.items() if np.isnan(values[i])])
    ]
    if all(np.isnan(values[: len(names)]).all() for values in raw.values()):
        raise RefusedError("; ".join(reasons))
    return reasons


def _shuffled_note(name: str, null_values: Mapping[IndexKind, Floats]) -> str:
    """Return a note on the indices of an input with many equal values after shuffling."""
    maxima = {
        kind.key: values.max() for kind, values in null_values.items() if np.isfinite(values).all()
    }
    reached = ", ".join(f"{kind} = {maximum:.2g}" for kind, maximum in maxima.items())
    return (
        f"{name} has many equal values: shuffled {DUMMIES} times, and so without effect, it reaches"
        f" {reached}"
    )
