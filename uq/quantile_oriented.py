"""Quantile-oriented indices: how much better a quantile is known once an input is."""

from collections.abc import Mapping

import numpy as np

from uq.elements import Floats
from uq.targets import RefusedError

MIN_SLICES = 5
MOST_SLICES = 48
_ROWS_IN_SLICE = 30
_ROWS_BEYOND = 5


def quantile_indices(x: Floats, y: Floats, quantiles: Mapping[str, float]) -> dict[str, Floats]:
    """Estimate the index of each input for each quantile.

    With psi(r) = r (p - [r < 0]), whose mean E psi(Y - q) is least at the quantile q of Y, the
    index is 1 - E[min_q E[psi(Y - q) | X]] / min_q E[psi(Y - q)] [1]_: 0 if knowing X does not
    sharpen the quantile at all, 1 if nothing remains.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    y : ndarray, shape (n,)
    quantiles : dict of str to float
        Name of an index -> probability p.

    Returns
    -------
    dict
        Name -> raw indices, shape (d,), from slices of equally many rows. They are too large, as
        each slice has its quantile fitted to it: those of inputs without effect show by how much.

    Raises
    ------
    RefusedError
        Too few rows for the quantile.

    References
    ----------
    .. [1] J.-C. Fort, T. Klein, N. Rachdi, "New sensitivity analysis subordinated to a contrast",
       Commun. Stat. Theory Methods 45, 4349-4364 (2016).
    """
    n = len(y)
    orders = np.argsort(x, axis=0, kind="stable")
    found = {}
    for name, p in quantiles.items():
        rows = max(_ROWS_IN_SLICE, int(np.ceil(_ROWS_BEYOND / min(p, 1 - p))))
        if n < MIN_SLICES * rows:
            raise RefusedError(
                f"only {n} rows have a value; {name} needs {MIN_SLICES * rows}, {rows} in each"
                f" of {MIN_SLICES} slices of an input"
            )
        edges = np.linspace(0, n, min(n // rows, MOST_SLICES) + 1).astype(int)
        whole = _least_contrast(y, p)
        if whole <= 0:
            raise RefusedError(f"the values up to {name} are all the same: it does not move")
        remains = [
            sum(_least_contrast(part, p) * len(part) for part in np.split(y[order], edges[1:-1]))
            for order in orders.T
        ]
        found[name] = 1 - np.array(remains) / (n * whole)
    return found


def without_optimism(raw: Floats, idle: Floats) -> Floats:
    """Correct raw indices by what the same estimate makes of inputs without effect.

    Fitting each slice lowers what remains by the same factor for every input, exactly so where the
    law of the output in a slice changes in place and width alone.
    """
    return 1 - (1 - raw) / (1 - idle.mean())


def _least_contrast(y: Floats, p: float) -> float:
    rest = y - np.quantile(y, p, method="inverted_cdf")
    return float(np.mean(rest * (p - (rest < 0))))
