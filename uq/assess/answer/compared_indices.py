"""Index of each input, with the half-width of its difference from another."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, nan, sqrt

import numpy as np

from uq.assess.chosen_targets import chosen
from uq.assess.design_sample import sample_of
from uq.assess.row_inputs import why_dependent
from uq.assess.sensitivities import TargetIndices, methods
from uq.indices.given_data import MIN_ROWS
from uq.indices.index import IndexKind, Null, RefusedError
from uq.indices.method import SensitivityMethod
from uq.indices.methods import METHODS, fed_by
from uq.result.result import Result
from uq.sampling.designs import PLAIN
from uq.stats.estimate import Estimate
from uq.stats.intervals import scatter_interval

_PARTS = 8
_FEWEST_PARTS = 4
_DOUBTFUL = 2.0  # times the error of an index that is too uncertain for an interval


AGAIN = sqrt(2)
"""Standard deviation of the difference of two independent estimates over that of one."""


@dataclass(frozen=True)
class Measured:
    """The index of one input.

    Attributes
    ----------
    name : str
    index : Estimate
        With an interval where one is known.
    half : float
        Half-width of its interval, or another measure of its error.
    counts : bool
        Whether it is larger than those of inputs without effect.
    shared : dict of str to float
        Other input -> covariance of the errors of both indices, in units of half-widths.
    """

    name: str
    index: Estimate
    half: float
    counts: bool
    shared: Mapping[str, float] = field(default_factory=dict)

    def apart(self, other: "Measured") -> float:
        """Return the half-width of the interval of the difference from another index."""
        return sqrt(max(self.half**2 + other.half**2 - 2 * self.shared.get(other.name, 0.0), 0.0))


def method_for(result: Result, event: bool) -> str | None:
    """Return the ranking method: the first that the study asks for, or that its design supports.

    Of an event first those whose index has a scale of its own: others, as PAWN, cannot exceed the
    probability of a rare one. None for rows with weights. Of shares of the variance alone, the ones
    with intervals where the design has such: a leader is not named without.
    """
    if result.has_weights:
        return None
    fed = fed_by(result.design, bool(why_dependent(result)))
    candidates = [_with_intervals(name, fed) for name in (*methods(result), *fed) if name in fed]
    unconditional = [name for name in candidates if not METHODS[name].conditional]
    if not event:
        return next((name for name in unconditional if METHODS[name].takes_numbers), None)
    of_events = [name for name in unconditional if METHODS[name].takes_events]
    return min(of_events, key=lambda name: not _has_scale(METHODS[name]), default=None)


def _with_intervals(name: str, fed: Sequence[str]) -> str:
    """Return a method, or one that estimates the same indices with intervals."""
    if METHODS[name].intervals:
        return name
    same = (other for other in fed if METHODS[other].kinds == METHODS[name].kinds)
    return next(
        (other for other in same if METHODS[other].kinds and METHODS[other].intervals), name
    )


def _has_scale(method: SensitivityMethod) -> bool:
    return method.of_variance or not method.takes_numbers


def measured_inputs(
    result: Result, method: str, name: str, kind: IndexKind, target_indices: TargetIndices
) -> Iterator[Measured]:
    """Yield the indices of one kind, the largest first, of inputs with an effect of their own."""
    every, borrowed = target_indices.kinds()[kind], target_indices.indices.by_correlation
    values = {label: index for label, index in every.items() if label not in borrowed} or every
    null = target_indices.indices.nulls.get(kind, Null(nan))
    limit = null.largest if isfinite(null.largest) else null.limit
    products = target_indices.indices.half_products
    has_errors = bool(products) or any(index.has_interval for index in values.values())
    scatter = {} if has_errors else _parts(result, method, name).get(kind.key, {})
    order = sorted(values, key=lambda label: -_size(values[label]))
    # Where no other input has an effect in any row, it is certain without an interval.
    alone = kind.unit == "variance" and all(values[label].value == 0 for label in order[1:])
    for label in order:
        index = values[label]
        if not isfinite(index.value):
            continue
        half = (index.high - index.low) / 2 if index.has_interval else null.limit
        if products and not index.has_interval:
            half = _DOUBTFUL * sqrt(products[label, label])
        if label in scatter:  # estimates from fewer rows, which may be biased: no interval
            low, high = scatter_interval(index.value, np.array(scatter[label]))
            half = (high - low) / 2
        counts = index.low > 0 if index.has_interval or not isfinite(limit) else index.value > limit
        counts |= alone and index.value > 0 and not index.has_interval
        shared = {
            other: product
            for pair, product in products.items()
            if label in pair and (other := pair[pair[0] == label]) != label
        }
        yield Measured(label, index, half, bool(counts and not index.low <= 0), shared)


def _size(index: Estimate) -> float:
    return index.value if isfinite(index.value) else -1.0


def _parts(result: Result, method: str, name: str) -> dict[str, dict[str, list[float]]]:
    """Return the indices from independent parts of the rows: kind -> input -> one per part."""
    if result.design.layout is not PLAIN:
        return {}
    result = result.first_rows
    (target,) = chosen(result, method, [name])
    sample = replace(sample_of(result), values=target.values, nulls=False)
    rows = np.flatnonzero(sample.whole)
    if (most := METHODS[method].most_rows) and len(rows) > most:
        rows = np.sort(np.random.default_rng(0).choice(rows, most, replace=False))
    if result.has_independent_samples:
        part = np.arange(len(rows)) % max(min(_PARTS, len(rows) // MIN_ROWS), 1)
    else:
        part = result.dataset["replicate"].values[rows]
    estimates: dict[str, dict[str, list[float]]] = {}
    if len(np.unique(part)) < _FEWEST_PARTS:
        return estimates
    for number in np.unique(part):
        try:
            indices = METHODS[method].indices(sample.rows(rows[part == number]))
        except RefusedError:
            return {}
        for kind, values in indices.values.items():
            for label, index in values.items():
                estimates.setdefault(kind.key, {}).setdefault(label, []).append(index.value)
    return estimates


def are_tied(first: Measured, other: Measured, times: float = 1.0) -> bool:
    """Return whether another input may have as large an index, errors multiplied by `times`."""
    return first.index.value - other.index.value <= times * first.apart(other)
