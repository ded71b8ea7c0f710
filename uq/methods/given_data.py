"""Sensitivity from a plain sample: indices beside those of inputs without effect.

RBD-FAST, Borgonovo's delta, PAWN, quantile-oriented indices and regional sensitivity need no design
of their own (`uq.methods.measures`, `uq.methods.quantile_oriented`). Their scatter is not known:
bootstrap intervals of these estimates cover far less than their nominal level. Each index is
therefore compared with a null: the same estimate for inputs without effect, which one in twenty of
them exceeds, and a second one, which the largest of all inputs would exceed once in twenty. An
index below its null is negligible. An input with many equal values has a null of its own, from its
values shuffled.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from uq.estimate import Estimate
from uq.methods.indices import IndexKind, Indices, Null, RefusedError
from uq.methods.sample import Floats, Sample
from uq.methods.slices import has_many_equal

MIN_ROWS = 64
"""Fewer rows than this leave too few in each slice of an input."""

DUMMIES = 19
"""One input in twenty without effect exceeds the largest of 19."""

Measure = Callable[[Floats, Sample], tuple[dict[IndexKind, Floats], tuple[str, ...]]]
"""Columns of inputs, shape (n, k), and the sample -> raw indices, shape (k,) each, and notes."""


def one_kind(kind: IndexKind, measure: Callable[[Floats, Floats], Floats]) -> Measure:
    """Return the measure of one kind of index, from columns of inputs and the output."""
    return lambda x, sample: ({kind: measure(x, sample.values)}, ())


def beside_nulls(
    measure: Measure,
    correction: Callable[[Floats, Floats], Floats] | None = None,
) -> Callable[[Sample], Indices]:
    """Return the estimate of indices with the null of inputs without effect.

    Parameters
    ----------
    measure : callable
        See `Measure`; NaN for an input whose rows are all in one slice.
    correction : callable, optional
        ``correction(raw, idle)`` -> indices, from raw ones and those of inputs without effect.

    Returns
    -------
    callable
        ``estimate(sample)`` of a `uq.methods.method.Method`.
    """
    corrected = correction or (lambda raw, idle: raw)

    def estimate(sample: Sample) -> Indices:
        x = sample.inputs
        rng = np.random.default_rng(0)
        dummies = DUMMIES if sample.nulls or correction else 0
        columns = np.column_stack([*x.values(), rng.random((len(sample.values), dummies))])
        raw, notes = measure(columns, sample)
        idle = {kind: one[len(x) :] for kind, one in raw.items()}
        found: dict[IndexKind, dict[str, Estimate]] = {kind: {} for kind in raw}
        notes = (*notes, *_no_slices(list(x), raw))
        for i, (name, column) in enumerate(x.items()):
            own = idle
            sliced = not all(np.isnan(one[i]) for one in raw.values())
            if sliced and dummies and has_many_equal(column):
                shuffled = np.column_stack([rng.permutation(column) for _ in range(DUMMIES)])
                own, _ = measure(shuffled, sample)
                reached = {kind: corrected(one, one) for kind, one in own.items()}
                notes = (*notes, _ownnull_of(name, reached))
            for kind, one in raw.items():
                found[kind][name] = Estimate(float(corrected(one[i], own[kind])))
        reached = {kind: corrected(one, one) for kind, one in idle.items() if dummies}
        return Indices(found, notes, {kind: null_of(one, len(x)) for kind, one in reached.items()})

    return estimate


def null_of(reached: Floats, inputs: int) -> Null:
    """Return the limits for one input without effect, and for the largest of several."""
    return Null(float(reached.max()), largest_of(inputs, reached) if inputs > 1 else np.nan)


def largest_of(inputs: int, idle: Floats) -> float:
    """Return what the largest of several inputs without effect exceeds once in twenty, or less.

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
    found = idle.mean() + scale * (quantile - np.euler_gamma)
    return float(max(found, idle.max()))


def _no_slices(names: Sequence[str], raw: Mapping[IndexKind, Floats]) -> list[str]:
    """Return which inputs have all rows in one slice; refuse if that is all of them."""
    reasons = [
        f"{name} has too few rows of any value but one: no {' or '.join(lost)}"
        for i, name in enumerate(names)
        if (lost := [kind.key for kind, one in raw.items() if np.isnan(one[i])])
    ]
    if all(np.isnan(one[: len(names)]).all() for one in raw.values()):
        raise RefusedError("; ".join(reasons))
    return reasons


def _ownnull_of(name: str, own: Mapping[IndexKind, Floats]) -> str:
    known = {kind.key: one.max() for kind, one in own.items() if np.isfinite(one).all()}
    reached = ", ".join(f"{kind} = {one:.2g}" for kind, one in known.items())
    return (
        f"{name} has many equal values: shuffled {DUMMIES} times, and so without effect, it reaches"
        f" {reached}"
    )
