"""Given-data sensitivity indices from a plain sample, compared with inputs without effect.

RBD-FAST, Borgonovo's delta, PAWN, quantile-oriented indices and regional sensitivity need no
special design (`uq.indices.measures`, `quantile_indices`). Their sampling error cannot be
estimated: bootstrap intervals cover far less than their nominal level. Each index is therefore
compared with a null: the 95 % quantile of the same estimate for an input without effect. A second
limit is the 95 % quantile of the largest estimate over all inputs without effect. An index below
its null is negligible. An input with many equal values has a separate null from permutations of its
values.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.indices.index import IndexKind, Indices, Null, RefusedError
from uq.indices.measures import even_cuts, has_many_equal, is_undivided, slices_along
from uq.indices.method import DesignSample
from uq.stats.estimate import Estimate

MIN_ROWS = 64
"""Minimum sample size: fewer rows leave too few rows in each slice of an input."""

DUMMIES = 19
"""Number of inputs without effect: one in twenty others exceeds the largest of these 19."""

Measure = Callable[[Floats, DesignSample], tuple[dict[IndexKind, Floats], tuple[str, ...]]]
"""Input columns, shape (n, k), and the sample -> raw indices, shape (k,) each, and notes."""

MIN_SLICES = 5
MOST_SLICES = 48
_ROWS_IN_SLICE = 30
_ROWS_BEYOND = 5


def one_kind(kind: IndexKind, measure: Callable[[Floats, Floats], Floats]) -> Measure:
    """Return a `Measure` of one kind of index, from a function of input columns and output."""
    return lambda x, sample: ({kind: measure(x, sample.values)}, ())


def beside_nulls(
    measure: Measure,
    correction: Callable[[Floats, Floats], Floats] | None = None,
) -> Callable[[DesignSample], Indices]:
    """Return an estimator of indices and their null, from inputs without effect.

    Parameters
    ----------
    measure : callable
        See `Measure`; NaN for an input whose rows are all in one slice.
    correction : callable, optional
        ``correction(raw, idle)`` -> corrected indices, from raw indices and the indices of inputs
        without effect.

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
    """Return the null limits for one input without effect, and for the largest of several."""
    return Null(float(reached.max()), _largest_of(inputs, reached) if inputs > 1 else np.nan)


def _largest_of(inputs: int, idle: Floats) -> float:
    """Return an upper 95 % limit of the largest index of several inputs without effect.

    Parameters
    ----------
    inputs : int
    idle : ndarray, shape (k,)
        Indices of k inputs without effect.

    Returns
    -------
    float
        Quantile of Gumbel's law of the same mean and variance. Its tail is heavier than the tail of
        any of these indices: one or more of 3 to 60 inputs without effect exceeded the limit in 0.5
        to 7 % of samples.
    """
    scale = float(idle.std(ddof=1)) * np.sqrt(6) / np.pi
    quantile = -np.log(-np.log(0.95 ** (1 / inputs)))
    gumbel_quantile = idle.mean() + scale * (quantile - np.euler_gamma)
    return float(max(gumbel_quantile, idle.max()))


def _no_slices(names: Sequence[str], raw: Mapping[IndexKind, Floats]) -> list[str]:
    """Return a note on each input with a single slice; raise `RefusedError` if no other is left."""
    reasons = [
        f"{name} has too few rows of any value but one: no {' or '.join(lost)}"
        for i, name in enumerate(names)
        if (lost := [kind.key for kind, values in raw.items() if np.isnan(values[i])])
    ]
    if all(np.isnan(values[: len(names)]).all() for values in raw.values()):
        raise RefusedError("; ".join(reasons))
    return reasons


def _shuffled_note(name: str, null_values: Mapping[IndexKind, Floats]) -> str:
    """Return a note on the permutation null of an input with many equal values."""
    maxima = {
        kind.key: values.max() for kind, values in null_values.items() if np.isfinite(values).all()
    }
    reached = ", ".join(f"{kind} = {maximum:.2g}" for kind, maximum in maxima.items())
    return (
        f"{name} has many equal values: shuffled {DUMMIES} times, and so without effect, it reaches"
        f" {reached}"
    )


def quantile_indices(
    x: Floats, sample: DesignSample
) -> tuple[dict[IndexKind, Floats], tuple[str, ...]]:
    """Estimate the quantile-oriented index of each input for each quantile.

    Let psi(r) = r (p - [r < 0]); its mean E psi(Y - q) is minimal at the quantile q of Y. The index
    is 1 - E[min_q E[psi(Y - q) | X]] / min_q E[psi(Y - q)] [1]_. It is 0 if X carries no
    information on the quantile, and 1 if X determines Y.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    sample : DesignSample
        Sample with the output and the quantiles.

    Returns
    -------
    indices : dict
        IndexKind -> raw indices, shape (d,), from slices with equal numbers of rows, or by value
        if an input has few values. They are biased upwards, since a quantile is fitted to each
        slice; the indices of inputs without effect estimate this bias. NaN if an input varies only
        within one slice.
    notes : tuple of str
        Reasons why quantiles have no index.

    Raises
    ------
    RefusedError
        No quantile has an index.

    References
    ----------
    .. [1] J.-C. Fort, T. Klein, N. Rachdi, "New sensitivity analysis subordinated to a contrast",
       Commun. Stat. Theory Methods 45, 4349-4364 (2016).
    """
    y, asked, notes = sample.values, {}, []
    for name, p in sample.quantiles.items():
        rows = max(_ROWS_IN_SLICE, int(np.ceil(_ROWS_BEYOND / min(p, 1 - p))))
        if len(y) < MIN_SLICES * rows:
            notes.append(
                f"only {len(y)} rows have a value; {name} needs {MIN_SLICES * rows}, {rows} in each"
                f" of {MIN_SLICES} slices of an input"
            )
        elif (whole := _least_contrasts(y, (p,))[0]) == 0:
            notes.append(f"all values on one side of {name} are equal: no input can move it")
        else:
            cuts = even_cuts(len(y), min(len(y) // rows, MOST_SLICES))
            asked[IndexKind(name, name)] = p, whole, (cuts, rows)
    if not asked:
        raise RefusedError("; ".join(notes))
    probabilities, contrasts, cases = zip(*asked.values(), strict=True)
    remains = np.array([_remains(column, y, probabilities, cases) for column in x.T])
    return dict(zip(asked, 1 - remains.T / np.array(contrasts)[:, None], strict=True)), tuple(notes)


def without_optimism(raw: Floats, idle: Floats) -> Floats:
    """Return indices corrected for the optimism of fitting, from inputs without effect.

    Fitting each slice reduces the remaining contrast by the same factor for every input. This is
    exact if the law of the output differs between slices only in location and scale.
    """
    return 1 - (1 - raw) / (1 - idle.mean())


def _least_contrasts(y: Floats, probabilities: Sequence[float]) -> Floats:
    quantiles = np.quantile(y, probabilities, method="inverted_cdf")
    rests = zip((y - quantile for quantile in quantiles), probabilities, strict=True)
    return np.array([np.mean(rest * (p - (rest < 0))) for rest, p in rests])


def _remains(
    column: Floats,
    y: Floats,
    probabilities: Sequence[float],
    cases: Sequence[tuple[NDArray[np.intp], int]],
) -> list[float]:
    """Return for each quantile the mean of the minimum contrasts over slices of an input."""
    remains, contrasts = [], dict[int, Floats]()  # of all quantiles, by the slices they share
    for i, number in enumerate(slices_along(column, cases)):
        if is_undivided(column, number):
            remains.append(np.nan)
            continue
        if id(number) not in contrasts:
            parts = _parts(y, number)
            least = np.array([_least_contrasts(part, probabilities) for part in parts])
            contrasts[id(number)] = sum(least * np.array([[len(part)] for part in parts])) / len(y)
        remains.append(float(contrasts[id(number)][i]))
    return remains


def _parts(y: Floats, number: NDArray[np.intp]) -> list[Floats]:
    """Return y of each slice, its rows in their order."""
    order = np.argsort(number.astype(np.uint16), kind="stable")  # by counting: slices are few
    return np.split(y[order], np.cumsum(np.bincount(number))[:-1])
