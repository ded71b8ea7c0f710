"""Sensitivity from a plain sample: every method that asks for no design of its own.

RBD-FAST, Borgonovo's delta, PAWN and HDMR are SALib's estimators. Their scatter is not known:
bootstrap intervals of these estimates miss the truth far more often than they say. Beside each
index stands what the same estimate makes of inputs that play no part; an index below that shows
nothing.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from SALib.analyze.rbd_fast import permute_outputs, unskew_S1
from scipy.fft import rfft

from uq.indices.hdmr import hdmr_indices
from uq.indices.quantile_oriented import quantile_indices, without_optimism
from uq.indices.regional import ks_distances
from uq.indices.slices import delta, pawn
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
        each of `quantiles`, or those of `uq.indices.hdmr`; without intervals, with `dummy`.

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
    idle = np.random.default_rng(0).random((len(y), DUMMIES))
    columns = np.column_stack([*x.values(), idle])
    if method == "quantile":
        raw, notes = quantile_indices(columns, y, quantiles)
        found = {kind: without_optimism(one, one[len(x) :]) for kind, one in raw.items()}
    else:
        kind, measure = _METHODS[method]
        found, notes = {kind: measure(columns, y)}, ()
    values_of = {
        kind: {parameter: Index(float(v)) for parameter, v in zip(x, one, strict=False)}
        for kind, one in found.items()
    }
    return Indices(
        values_of,
        thinned + notes,
        dummy={k: float(one[len(x) :].max()) for k, one in found.items()},
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
