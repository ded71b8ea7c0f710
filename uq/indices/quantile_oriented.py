"""Quantile-oriented indices: how much knowing an input sharpens a quantile."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.indices.index import IndexKind, RefusedError
from uq.indices.sample import DesignSample
from uq.indices.slices import by_slices, even_cuts

MIN_SLICES = 5
MOST_SLICES = 48
_ROWS_IN_SLICE = 30
_ROWS_BEYOND = 5


def quantile_indices(
    x: Floats, sample: DesignSample
) -> tuple[dict[IndexKind, Floats], tuple[str, ...]]:
    """Estimate the index of each input for each quantile.

    With psi(r) = r (p - [r < 0]), whose mean E psi(Y - q) is least at the quantile q of Y, the
    index is 1 - E[min_q E[psi(Y - q) | X]] / min_q E[psi(Y - q)] [1]_: 0 if knowing X does not
    sharpen the quantile at all, 1 if it determines it.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    sample : DesignSample
        The output, and the quantiles.

    Returns
    -------
    indices : dict
        IndexKind -> raw indices, shape (d,), from slices of equally many rows, or by value where an
        input has few values. They are biased upwards, since a quantile is fitted to each slice:
        those of inputs without effect show by how much. NaN where an input varies within one slice
        only.
    notes : tuple of str
        Why some quantiles have none.

    Raises
    ------
    RefusedError
        None has any.

    References
    ----------
    .. [1] J.-C. Fort, T. Klein, N. Rachdi, "New sensitivity analysis subordinated to a contrast",
       Commun. Stat. Theory Methods 45, 4349-4364 (2016).
    """
    y, indices, notes = sample.values, {}, []
    for name, p in sample.quantiles.items():
        rows = max(_ROWS_IN_SLICE, int(np.ceil(_ROWS_BEYOND / min(p, 1 - p))))
        if len(y) < MIN_SLICES * rows:
            notes.append(
                f"only {len(y)} rows have a value; {name} needs {MIN_SLICES * rows}, {rows} in each"
                f" of {MIN_SLICES} slices of an input"
            )
        elif (whole := _least_contrast(y, p)) == 0:
            notes.append(f"all values on one side of {name} are equal: no input can move it")
        else:
            cuts = even_cuts(len(y), min(len(y) // rows, MOST_SLICES))
            remains = by_slices(x, cuts, partial(_remains, y, p), rows)
            indices[IndexKind(name, name)] = 1 - remains / whole
    if not indices:
        raise RefusedError("; ".join(notes))
    return indices, tuple(notes)


def without_optimism(raw: Floats, idle: Floats) -> Floats:
    """Correct raw indices by those of inputs without effect.

    Fitting each slice lowers what remains by the same factor for every input: exactly, where the
    law of the output differs between slices in location and scale alone.
    """
    return 1 - (1 - raw) / (1 - idle.mean())


def _least_contrast(y: Floats, p: float) -> float:
    rest = y - np.quantile(y, p, method="inverted_cdf")
    return float(np.mean(rest * (p - (rest < 0))))


def _remains(y: Floats, p: float, number: NDArray[np.intp]) -> float:
    """Return the mean of the least contrasts in slices of y; `number` is each row's slice."""
    parts = (y[number == k] for k in range(number.max() + 1))
    return sum(_least_contrast(part, p) * len(part) for part in parts) / len(y)
