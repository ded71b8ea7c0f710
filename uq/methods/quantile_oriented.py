"""Quantile-oriented indices: how much better a quantile is known once an input is."""

import numpy as np
from numpy.typing import NDArray

from uq.methods.indices import Kind, RefusedError
from uq.methods.sample import Floats, Sample
from uq.methods.slices import even_cuts, slice_of, tells_nothing

MIN_SLICES = 5
MOST_SLICES = 48
_ROWS_IN_SLICE = 30
_ROWS_BEYOND = 5


def quantile_indices(x: Floats, sample: Sample) -> tuple[dict[Kind, Floats], tuple[str, ...]]:
    """Estimate the index of each input for each quantile.

    With psi(r) = r (p - [r < 0]), whose mean E psi(Y - q) is least at the quantile q of Y, the
    index is 1 - E[min_q E[psi(Y - q) | X]] / min_q E[psi(Y - q)] [1]_: 0 if knowing X does not
    sharpen the quantile at all, 1 if nothing remains.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    sample : Sample
        The output, and the quantiles.

    Returns
    -------
    indices : dict
        Kind -> raw indices, shape (d,), from slices of equally many rows, or by value where an
        input has few. They are too large, as each slice has its quantile fitted to it: those of
        inputs without effect show by how much. NaN where an input varies within one slice only.
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
    y, found, notes = sample.values, {}, []
    for name, p in sample.quantiles.items():
        rows = max(_ROWS_IN_SLICE, int(np.ceil(_ROWS_BEYOND / min(p, 1 - p))))
        if len(y) < MIN_SLICES * rows:
            notes.append(
                f"only {len(y)} rows have a value; {name} needs {MIN_SLICES * rows}, {rows} in each"
                f" of {MIN_SLICES} slices of an input"
            )
        elif (whole := _least_contrast(y, p)) == 0:
            notes.append(f"the values on one side of {name} are all the same: it does not move")
        else:
            slices = min(len(y) // rows, MOST_SLICES)
            cuts = even_cuts(len(y), slices)
            number = [slice_of(column, cuts, rows) for column in x.T]
            rest = [
                np.nan if tells_nothing(column, own) else _remains(y, p, own)
                for column, own in zip(x.T, number, strict=True)
            ]
            found[Kind(name, name)] = 1 - np.array(rest) / whole
    if not found:
        raise RefusedError("; ".join(notes))
    return found, tuple(notes)


def without_optimism(raw: Floats, idle: Floats) -> Floats:
    """Correct raw indices by what the same estimate makes of inputs without effect.

    Fitting each slice lowers what remains by the same factor for every input, exactly so where the
    law of the output in a slice changes in place and width alone.
    """
    return 1 - (1 - raw) / (1 - idle.mean())


def _least_contrast(y: Floats, p: float) -> float:
    rest = y - np.quantile(y, p, method="inverted_cdf")
    return float(np.mean(rest * (p - (rest < 0))))


def _remains(y: Floats, p: float, number: NDArray[np.intp]) -> float:
    """Return the mean of the least contrasts in slices of y; `number` is each row's slice."""
    parts = (y[number == k] for k in range(number.max() + 1))
    return sum(_least_contrast(part, p) * len(part) for part in parts) / len(y)
