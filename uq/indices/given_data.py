"""Given-data sensitivity indices from a plain sample, compared with inputs without effect.

RBD-FAST, Borgonovo's delta, PAWN, quantile-oriented indices and regional sensitivity need no
special design (`uq.indices.measures`, `quantile_indices`). Their sampling error cannot be
estimated: bootstrap intervals cover far less than their nominal level. Each index is therefore
compared with a null: the 95 % quantile of the same estimate for an input without effect. A second
limit is the 95 % quantile of the largest estimate over all inputs without effect. An index below
its null is negligible. An input with many equal values has a separate null from permutations of its
values. The Hilbert-Schmidt independence criterion (HSIC) of an event has p-values instead; it is
computed by OpenTURNS, which is imported on first use.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.indices.index import IndexKind, Indices, Null, RefusedError
from uq.indices.measures import (
    MOST_CATEGORIES,
    as_event,
    even_cuts,
    has_many_equal,
    is_undivided,
    slices_along,
)
from uq.indices.method import DesignSample
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import mid_ranks

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
        elif (whole := float(_least_contrasts(y[None], (p,))[0, 0])) == 0:
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
    """Return the minimum contrast of each quantile in each row of y, shape (slices, quantiles)."""
    ranks = np.quantile(np.arange(y.shape[1]), probabilities, method="inverted_cdf").astype(int)
    quantiles = np.sort(y, axis=1)[:, ranks].T
    rests = zip((y - quantile[:, None] for quantile in quantiles), probabilities, strict=True)
    return np.array([np.mean(rest * (p - (rest < 0)), axis=1) for rest, p in rests]).T


def _remains(
    column: Floats,
    y: Floats,
    probabilities: Sequence[float],
    cases: Sequence[tuple[NDArray[np.intp], int]],
) -> Floats:
    """Return for each quantile the mean of the minimum contrasts over slices of an input."""
    remains = np.full(len(probabilities), np.nan)
    keys = tuple((tuple(cuts.tolist()), least) for cuts, least in cases)
    for asked, order, counts in _slicings(np.ascontiguousarray(column).tobytes(), keys):
        wanted = [probabilities[i] for i in asked]
        sorted_by_slice, ends = y[order], np.cumsum(counts)
        least = np.empty((len(counts), len(asked)))
        for count in np.unique(counts):
            alike = np.flatnonzero(counts == count)
            rows = (ends[alike] - count)[:, None] + np.arange(count)
            least[alike] = _least_contrasts(sorted_by_slice[rows], wanted)
        remains[list(asked)] = sum(least * counts[:, None]) / len(y)
    return remains


@lru_cache(64)
def _slicings(
    column: bytes, cases: tuple[tuple[tuple[int, ...], int], ...]
) -> list[tuple[tuple[int, ...], NDArray[np.intp], NDArray[np.intp]]]:
    """Return the distinct slicings along an input, kept for the next output of the same rows.

    Returns
    -------
    list of tuple
        The cases that share a slicing, the rows ordered by slice, and their number in each slice;
        without cases in which an input varies only within one slice.
    """
    values = np.frombuffer(column)
    arrays = [(np.array(cuts, np.intp), least) for cuts, least in cases]
    shared: dict[int, tuple[NDArray[np.intp], list[int]]] = {}
    for i, number in enumerate(slices_along(values, arrays)):
        if not is_undivided(values, number):
            shared.setdefault(id(number), (number, []))[1].append(i)
    return [
        # by counting, as slices are few; the rows of a slice keep their order
        (tuple(asked), np.argsort(number.astype(np.uint16), kind="stable"), np.bincount(number))
        for number, asked in shared.values()
    ]


HSIC = IndexKind("hsic", "HSIC, normalised")
P = IndexKind("p", "p-value of independence", "p-value")

MOST_ROWS = 2000
"""Largest number of rows: time and memory grow with its square."""


def target_indices(sample: DesignSample) -> Indices:
    """Estimate the target HSIC of each input for an event, with its p-value.

    Parameters
    ----------
    sample : DesignSample
        Plain sample of an event, 0 or 1.

    Returns
    -------
    Indices
        ``p``, the p-value of the independence test of each input, by a gamma approximation [2]_;
        and ``hsic``, the normalised HSIC of input and event [1]_: 0 if they are independent, at
        most 1. It is computed from ranks, with Gaussian kernels of one standard deviation in width.
        For an input with few values the kernel only compares values for equality, so that their
        labels do not matter.

    Raises
    ------
    RefusedError
        The output is not an event, too few rows are on one side of it, or OpenTURNS is not
        installed.

    References
    ----------
    .. [1] A. Marrel, V. Chabridon, "Statistical developments for target and conditional sensitivity
       analysis: application on safety studies for nuclear reactor", Reliab. Eng. Syst. Saf. 214,
       107711 (2021).
    .. [2] A. Gretton et al., "A kernel statistical test of independence", Adv. Neural Inf. Process.
       Syst. 20, 585-592 (2008).
    """
    as_event(sample.values)
    return _indices(sample)


def conditional_indices(sample: DesignSample) -> Indices:
    """Estimate the conditional HSIC of each input: its HSIC among the rows with an event.

    Parameters
    ----------
    sample : DesignSample
        Plain sample of the output in these rows.

    Returns
    -------
    Indices
        As in `target_indices`, between input and output, both by their ranks among these rows.

    Raises
    ------
    RefusedError
        OpenTURNS is not installed.
    """
    ranked = replace(sample, values=mid_ranks(sample.values))
    indices = _indices(ranked)
    note = f"of the {len(sample.values)} rows in which it happens; there inputs may be dependent"
    return replace(indices, notes=(note, *indices.notes))


def _indices(sample: DesignSample) -> Indices:
    indices = beside_nulls(one_kind(HSIC, _normalised))(sample)
    p_values = {name: Estimate(_p_value(x, sample.values)) for name, x in sample.inputs.items()}
    return replace(indices, values={P: p_values, **indices.values})


def _normalised(x: Floats, y: Floats) -> Floats:
    """Return the normalised HSIC of each input column; NaN for a constant column."""
    return np.array(
        [
            _estimator(column, y).getR2HSICIndices()[0] if np.ptp(column) else np.nan
            for column in x.T
        ]
    )


def _p_value(x: Floats, y: Floats) -> float:
    return float(_estimator(x, y).getPValuesAsymptotic()[0]) if np.ptp(x) else np.nan


def _estimator(x: Floats, y: Floats) -> Any:
    """Return OpenTURNS' estimator for one input.

    For an event it is the estimator of target sensitivity, with the event itself as filter. Given
    an event, conditional sensitivity with weights 0 and 1 equals global sensitivity of the rows of
    weight 1.
    """
    try:
        import openturns as ot
    except ImportError:
        raise RefusedError(
            "OpenTURNS is not installed: pip install 'vibrolife[reliability]'"
        ) from None
    few = len(np.unique(x)) <= MOST_CATEGORIES
    x = x if few else mid_ranks(x)
    kernel = ot.DiracCovarianceModel(1) if few else ot.SquaredExponential([x.std()])
    return ot.HSICEstimatorGlobalSensitivity(
        [kernel, ot.SquaredExponential([y.std()])],
        ot.Sample(x[:, None]),
        ot.Sample(y[:, None]),
        ot.HSICVStat(),
    )
