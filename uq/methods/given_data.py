"""Sensitivity from a plain sample: every method that asks for no design of its own.

RBD-FAST, Borgonovo's delta, PAWN and HDMR are SALib's estimators. Their scatter is not known:
bootstrap intervals of these estimates miss the truth far more often than they say. Beside each
index stands what the same estimate makes of inputs that play no part; an index below that shows
nothing. One input in twenty without effect passes it; beside it, named ``_any``, stands what the
largest of all inputs would pass once in twenty. An input with many equal values has its own rows,
shuffled, to be measured against.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from SALib.analyze.rbd_fast import permute_outputs, unskew_S1
from scipy.fft import rfft

from uq.methods.hdmr import hdmr_indices
from uq.methods.quantile_oriented import quantile_indices, without_optimism
from uq.methods.regional import ks_distances
from uq.methods.slices import delta, pawn
from uq.indices.targets import Index, Indices, RefusedError
from uq.intervals import is_constant
from uq.rows.elements import Floats

MIN_ROWS = 64
"""Fewer rows than this leave too few in each slice of an input."""

DUMMIES = 19
"""The largest of 19 is passed by one input in twenty that plays no part."""

MOST_ROWS = {"delta": 10_000, "pawn": 20_000, "rbd-fast": 200_000, "quantile": 200_000}
"""More rows would take long, and tell little more.

On Ishigami's function the estimates from so many scatter by 0.001 to 0.007. Delta is 0.03 to 0.06
too small besides, of which ten times the rows would mend a third.
"""

TIED = 0.05
"""An input has many equal values where one of them has a larger share of the rows than this."""

_HARMONICS = 10


def given_data_indices(
    method: str, x: dict[str, Floats], values: Floats, quantiles: Mapping[str, float]
) -> Indices:
    """Estimate the indices of one method.

    Parameters
    ----------
    method : {"rbd-fast", "delta", "pawn", "hdmr", "quantile", "regional"}
    x : dict of str to ndarray, shape (n,)
        The uncertain parameters.
    values : ndarray, shape (n,)
        One number per row, NaN where there is none: the row is left out.
    quantiles : dict of str to float
        Name -> probability of each quantile that ``quantile`` is about.

    Returns
    -------
    Indices
        ``S1`` (RBD-FAST), ``delta``, ``pawn`` (the median over slices), ``KS`` (regional), one for
        each of `quantiles`, or those of `uq.methods.hdmr`; without intervals, with `dummy`.

    Raises
    ------
    RefusedError
        Too few rows, a constant output, one with repeated values where a density is needed, one
        that is no event where it must be.
    """
    kept = np.flatnonzero(np.isfinite(values))
    if (n := len(kept)) < MIN_ROWS:
        raise RefusedError(f"only {n} of {len(values)} rows have a value; {MIN_ROWS} are needed")
    if is_constant(values[kept]):
        raise RefusedError("the same value in all rows: nothing depends on the inputs")
    thinned: tuple[str, ...] = ()
    if n > (most := MOST_ROWS.get(method, n)):
        # At random: imported rows may come in an order that means something.
        kept = np.sort(np.random.default_rng(0).choice(kept, most, replace=False))
        thinned = (f"from {most} of {n} rows, chosen at random: all would take long",)
    y, x = values[kept], {parameter: column[kept] for parameter, column in x.items()}
    if method == "hdmr":
        return hdmr_indices(x, y)
    rng = np.random.default_rng(0)
    columns = np.column_stack([*x.values(), rng.random((len(y), DUMMIES))])
    raw, notes = _raw(method, columns, y, quantiles)
    idle = {kind: one[len(x) :] for kind, one in raw.items()}
    values_of: dict[str, dict[str, Index]] = {kind: {} for kind in raw}
    notes = (*notes, *_no_slices(list(x), raw))
    tied = [name for name, column in x.items() if _is_tied(column)]
    if method == "rbd-fast" and tied:
        notes = (*notes, _no_order(tied, len(x)))
    for i, (name, column) in enumerate(x.items()):
        own = idle
        sliced = not all(np.isnan(one[i]) for one in raw.values())
        if name in tied and sliced and method != "rbd-fast":
            shuffled = np.column_stack([rng.permutation(column) for _ in range(DUMMIES)])
            own, _ = _raw(method, shuffled, y, quantiles)
            notes = (*notes, _own_null(name, {k: _index(method, v, v) for k, v in own.items()}))
        for kind, one in raw.items():
            value = float(_index(method, one[i], own[kind]))
            lost = name in tied and method == "rbd-fast"
            values_of[kind][name] = Index(np.nan if lost else value)
    dummy = {}
    for kind, one in idle.items():
        reached = _index(method, one, one)
        dummy[kind] = float(reached.max())
        if len(x) > 1:
            dummy[f"{kind}_any"] = largest_of(len(x), reached)
    return Indices(values_of, thinned + notes, dummy=dummy)


def largest_of(inputs: int, idle: Floats) -> float:
    """Return what the largest of several inputs without effect passes once in twenty, or less.

    Parameters
    ----------
    inputs : int
    idle : ndarray, shape (k,)
        What an index is for each of some inputs without effect.

    Returns
    -------
    float
        By Gumbel's law of the same mean and variance, whose tail is heavier than that of any of
        these indices: of 3 to 60 inputs without effect one or more passed in 0.5 to 7 % of samples.
    """
    scale = float(idle.std(ddof=1)) * np.sqrt(6) / np.pi
    quantile = -np.log(-np.log(0.95 ** (1 / inputs)))
    found = idle.mean() + scale * (quantile - np.euler_gamma)
    return float(max(found, idle.max()))


def _raw(
    method: str, x: Floats, y: Floats, quantiles: Mapping[str, float]
) -> tuple[dict[str, Floats], tuple[str, ...]]:
    """Return what a method makes of columns of inputs, shape (d,) each, and its notes."""
    if method == "quantile":
        return quantile_indices(x, y, quantiles)
    kind, measure = _METHODS[method]
    return {kind: measure(x, y)}, ()


def _index(method: str, raw: Floats, idle: Floats) -> Floats:
    """Return indices from raw ones and those of inputs without effect."""
    return without_optimism(raw, idle) if method == "quantile" else raw


def _is_tied(column: Floats) -> bool:
    counts = np.unique(column, return_counts=True)[1]
    return bool(counts.max() > max(TIED * len(column), 1))


def _no_order(tied: list[str], inputs: int) -> str:
    """Say which inputs RBD-FAST cannot sort the rows by; refuse where that is all of them."""
    said = (
        "rbd-fast sorts the rows by each input, so it takes none with many equal values:"
        f" {', '.join(tied)}; use delta, pawn or quantile"
    )
    if len(tied) == inputs:
        raise RefusedError(said)
    return said


def _no_slices(names: list[str], raw: Mapping[str, Floats]) -> list[str]:
    """Say of which inputs all rows are in one slice; refuse where that is all of them."""
    said = []
    for i, name in enumerate(names):
        if lost := [kind for kind, one in raw.items() if np.isnan(one[i])]:
            said.append(f"{name} has too few rows of any value but one: no {' or '.join(lost)}")
    if all(np.isnan(one[: len(names)]).all() for one in raw.values()):
        raise RefusedError("; ".join(said))
    return said


def _own_null(name: str, own: Mapping[str, Floats]) -> str:
    known = {kind: one.max() for kind, one in own.items() if np.isfinite(one).all()}
    reached = ", ".join(f"{kind} = {one:.2g}" for kind, one in known.items())
    return (
        f"{name} has many equal values: shuffled {DUMMIES} times, and so without effect, it"
        f" reaches {reached}"
    )


def _rbd_fast(x: Floats, y: Floats) -> Floats:
    """Return the share of the first harmonics in the power of y along each input, unbiased."""
    spectra = (rfft(permute_outputs(column, y)) for column in x.T)
    first = [np.sum(np.abs(one[1 : _HARMONICS + 1]) ** 2) for one in spectra]
    share = np.array(first) * 2 / (len(y) ** 2 * y.var())
    return unskew_S1(share, _HARMONICS, len(y))


_METHODS: dict[str, tuple[str, Callable[[Floats, Floats], NDArray[np.float64]]]] = {
    "rbd-fast": ("S1", _rbd_fast),
    "delta": ("delta", delta),
    "pawn": ("pawn", pawn),
    "regional": ("KS", ks_distances),
}
