"""First-order indices from a plain sample, with intervals."""

from itertools import combinations_with_replacement

import numpy as np

from uq.contract import Floats
from uq.estimate import Estimate
from uq.intervals import upper_probability
from uq.methods.given_data import DUMMIES, beside_nulls, null_of, one_kind
from uq.methods.indices import S1, Indices
from uq.methods.measures import first_order
from uq.methods.residual_variance import (
    Part,
    Residual,
    ordered_residual_variance,
    residual_variance,
    variance,
)
from uq.methods.sample import Sample
from uq.quantile_functions import student
from uq.wording import counted

ENOUGH_ROWS = 20
"""Where the error of an index rests on fewer rows it has no interval: of an input that matters in
3 % of 300 rows alone, the intervals would cover 82 %."""

FINE = 0.01
"""An index whose doubled error is below this has it as its interval, however few rows decide: those
beside a jump of an output that nothing else changes."""


def first_order_indices(sample: Sample) -> Indices:
    """Estimate the share of the variance that each input explains alone.

    Parameters
    ----------
    sample : Sample
        Of independent inputs; of a whole output the variances of its elements are summed.

    Returns
    -------
    Indices
        ``S1``, 1 less the variance that is left when an input is known over that of all rows
        (`uq.methods.residual_variance`), without bias however steep the output is. Intervals are
        Student's, on the scale of log(1 - S1), by the influence of each row [1]_, raised at both
        ends by one more row as influential as the most influential. They are those of independent
        rows for replicates, too, whose mean influence scatters no more; a few replicates may have
        as many rows each beyond a jump, and hide its error. None where the error rests on fewer
        than `ENOUGH_ROWS` rows; of an event, inputs without effect then show what is negligible.
        Of one replicate, whose rows depend on each other, the index is that of random balance,
        beside inputs without effect.

    References
    ----------
    .. [1] S. Da Veiga, F. Gamboa, "Efficient estimation of sensitivity indices", J. Nonparametr.
       Stat. 25, 573-595 (2013).
    """
    part = sample.replicate
    if part is not None and len(np.unique(part)) < 2:
        by_balance = beside_nulls(one_kind(S1, first_order))(sample)
        note = (
            "the rows of one replicate depend on each other: by random balance, too small where"
            " the output is steep in an input; [design] replicates = 8 gives unbiased indices"
            " with intervals"
        )
        return Indices(by_balance.values, (note, *by_balance.notes), by_balance.nulls)
    y = sample.values.reshape(len(sample.values), -1)
    y = y - y.mean(axis=0)
    columns = dict(sample.inputs)
    values, errors, widest, factors = _of_rows(columns, y, part, sample.confidence)
    names = list(columns)
    halves = np.sqrt(np.diag(errors))
    indices = {
        name: _estimate(float(values[i]), halves[i], widest[:, i], factors[i])
        for i, name in enumerate(names)
    }
    products = {
        (names[i], names[j]): float(errors[i, j])
        for i, j in combinations_with_replacement(range(len(names)), 2)
    }
    lacking = {name: index.reason for name, index in indices.items() if index.reason}
    notes = tuple(f"S1 of {name} has no interval: {why}" for name, why in lacking.items())
    nulls = {}
    if lacking and sample.nulls and len(np.unique(y)) == 2:
        nulls = {S1: null_of(_without_effect(y, part), len(names))}
    missing = {name: factors[i] for i, name in enumerate(names) if name in lacking}
    return Indices({S1: indices}, notes, nulls, half_products=products, rows_factors=missing)


def _without_effect(y: Floats, part: Part) -> Floats:
    """Return the indices of inputs without effect."""
    every = variance(y, part)
    orders = np.random.default_rng(0).random((DUMMIES, len(y))).argsort(axis=1)
    parts = [None if part is None else part[order] for order in orders]
    left = [
        ordered_residual_variance(y[order], of) for order, of in zip(orders, parts, strict=True)
    ]
    return 1 - np.array(left) / every


def _of_rows(
    columns: dict[str, Floats], y: Floats, part: Part, confidence: float
) -> tuple[Floats, Floats, Floats, list[float]]:
    """Return indices, products of half-widths, and what one more row would add at either end.

    Last, how many times the rows each would need for an interval.
    """
    n, every = len(y), variance(y, part)
    squares = np.sum(y**2, axis=1)
    values, influences, noises, factors = [], [], [], []
    for column in columns.values():
        left = residual_variance(column, y, part)
        value = 1 - left.variance / every
        influence = (left.squares - (1 - value) * squares) / every
        influence -= influence.mean()
        values.append(value)
        influences.append(influence)
        noises.append(_beyond(left, influence, value, every))
        factors.append(_rows_factor(influence))
    influence = np.array(influences)
    quantile = student(upper_probability(confidence), n - 1)
    scatter = influence @ influence.T / (n - 1) + np.diag(noises)
    widest = np.array([influence.max(axis=1), -influence.min(axis=1)]) / n
    return np.array(values), quantile**2 * scatter / n, widest, factors


def _beyond(left: Residual, influence: Floats, value: float, every: float) -> float:
    """Return the variance of pairs, less the part of the influence's that smoothing adds."""
    scatter = float(influence @ influence) / (len(influence) - 1)
    excess = min(max(1 - value, 0.0), 1.0) * left.excess / every**2
    return left.noise / every**2 - min(excess, 0.9 * scatter)


def _rows_factor(influence: Floats) -> float:
    """Return how many times the rows an interval needs: those that an error rests on, at least."""
    square = float(influence @ influence)
    rows = square**2 / float(np.sum(influence**4)) if square > 0 else 0.0
    return ENOUGH_ROWS / max(rows, 1.0)


def _estimate(value: float, half: float, widest: Floats, factor: float) -> Estimate:
    """Return an index with its interval on the scale of log(1 - S1)."""
    doubled = 2 * half + widest
    if factor > 1 and 0 < half and doubled.max() < FINE:
        return Estimate(value, float(value - doubled[0]), float(value + doubled[1]))
    if factor > 1:
        rows = counted(round(ENOUGH_ROWS / factor), "row")
        return Estimate(value, reason=f"its error rests on about {rows}; {ENOUGH_ROWS} are needed")
    if not half > 0:
        return Estimate(value, reason="the rows show no error")
    # Beyond an error as large as what is left, the scale would send the lower end far away.
    relative = min(half / (1 - value), 1.0) if value < 1 else 1.0
    low = value - half * np.expm1(relative) / relative - widest[0]
    high = value - half * np.expm1(-relative) / relative + widest[1]
    return Estimate(value, float(low), float(high))
