"""Sensitivity from an expansion in functions of one and of two inputs, fitted by SALib."""

import warnings
from itertools import combinations
from typing import Any

import numpy as np

from uq.contract import Floats
from uq.indices.index import S1, S2, SHAPLEY, ST, Indices, Null, RefusedError
from uq.indices.sample import DesignSample
from uq.stats.estimate import Estimate

EXPLAINED = 0.8
"""An expansion that explains less of the rows held out does not represent the output."""

_DEGREES = (2, 4, 6, 8)  # and the highest that an input of few values allows
_ENOUGH = 0.99
_LEAST_VALUES = 10
_MIN_ROWS = 600  # SALib accepts no fewer than the 300 that are not held out
_MOST_ROWS = 2048
_TERMS_PER_ROW = 0.8
_MOST_TERMS = 500


def hdmr_indices(sample: DesignSample) -> Indices:
    """Estimate the indices of an expansion in functions of one and of two inputs.

    Parameters
    ----------
    sample : DesignSample
        Of independent inputs.

    Returns
    -------
    Indices
        ``S1``, ``S2``, ``ST`` and ``shapley``: S1 and half of the S2 that an input shares, which
        are its Shapley effect where no three inputs interact [2]_. No intervals; the null is the
        index of one input without effect.

    Raises
    ------
    RefusedError
        Few values or rows, an input with a single value, or no degree of polynomials explains
        enough of the rows held out.

    References
    ----------
    .. [1] G. Li et al., "Global sensitivity analysis for systems with independent and/or
       correlated inputs", J. Phys. Chem. A 114, 6022-6032 (2010).
    .. [2] A. B. Owen, "Sobol' indices and Shapley value", SIAM/ASA J. Uncertainty Quantification
       2, 245-251 (2014).
    """
    x, y = sample.inputs, sample.values
    if len(np.unique(y)) < _LEAST_VALUES:
        raise RefusedError(
            f"the output takes fewer than {_LEAST_VALUES} values, and polynomials cannot represent"
            " it; use pawn"
        )
    if len(y) < _MIN_ROWS:
        raise RefusedError(
            f"only {len(y)} rows have a value; {_MIN_ROWS} are needed, half of them held out"
        )
    n = min(len(y), _MOST_ROWS)
    names = [*x, ""]
    rng = np.random.default_rng(0)
    chosen = rng.permutation(len(y))[:n]  # imported rows may come in a meaningful order
    columns = np.column_stack([*(column[chosen] for column in x.values()), rng.random(n)])
    y = (y[chosen] - y[chosen].mean()) / y[chosen].std()
    degrees, least = _degrees(names, columns[: n // 2])
    degree, explained = _best(columns, y, degrees)
    if not degree:
        raise RefusedError(f"{n} rows are too few for the pairs of {len(x)} inputs")
    if explained < EXPLAINED:
        raise RefusedError(
            f"functions of one and of two inputs explain {max(explained, 0):.0%} of the variance of"
            f" rows held out; {EXPLAINED:.0%} are needed{least}"
        )
    share, k = np.ravel(_expansion(columns, y, degree)["S"]), len(names)
    second = dict(zip(combinations(range(k), 2), share[k:], strict=True))
    shared = np.array([sum(v for pair, v in second.items() if i in pair) for i in range(k)])
    kinds = {S1: share[:k], ST: share[:k] + shared, SHAPLEY: share[:k] + shared / 2}
    values = {
        kind: {name: Estimate(float(v)) for name, v in zip(x, shares, strict=False)}
        for kind, shares in kinds.items()
    }
    values[S2] = {
        f"{names[i]},{names[j]}": Estimate(float(v)) for (i, j), v in second.items() if names[j]
    }
    note = (
        f"polynomials of degree {degree} in one and in two inputs explain {explained:.1%} of the"
        " variance of rows held out; half of the inputs without effect exceed the null"
    )
    nulls = {kind: Null(float(shares[-1]), exceeded=0.5) for kind, shares in kinds.items()}
    return Indices(values, (note,), nulls)


def _best(x: Floats, y: Floats, degrees: tuple[int, ...]) -> tuple[int, float]:
    """Return the degree that explains most of the held-out variance (0: none), and its share."""
    half, k = len(y) // 2, x.shape[1]
    best, explained = 0, float("-inf")
    for degree in degrees:
        terms = k * degree + k * (k - 1) // 2 * degree**2
        if explained > _ENOUGH or terms > min(_TERMS_PER_ROW * half, _MOST_TERMS):
            break
        # SALib takes the ranges of the inputs from the rows it is given: here from all of them.
        expected = _expansion(x[:half], y[:half], degree).emulate(x)
        gain = float(1 - (y - expected)[half:].var() / y[half:].var())
        if not gain > explained:
            break  # more terms than the rows can tell apart
        best, explained = degree, gain
    return best, explained


def _degrees(names: list[str], x: Floats) -> tuple[tuple[int, ...], str]:
    """Return the degrees to try, and why they are no higher: k values allow k - 1.

    Raises
    ------
    RefusedError
        For an input with a single value.
    """
    counts = [len(np.unique(column)) for column in x.T]
    fewest, name = min(zip(counts, names, strict=True), key=lambda pair: pair[0])
    if fewest == 1:
        raise RefusedError(
            f"{name} has the same value in all of {len(x)} rows: no polynomial can be fitted"
        )
    if fewest > max(_DEGREES):
        return _DEGREES, ""
    allowed = (*(d for d in _DEGREES if d < fewest - 1), fewest - 1)
    return allowed, f" ({name} has {fewest} values, which allow no degree above {allowed[-1]})"


def _expansion(x: Floats, y: Floats, degree: int) -> Any:
    from SALib.analyze import enhanced_hdmr

    names = [str(i) for i in range(x.shape[1])]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that there is no bootstrap
        return enhanced_hdmr.analyze(
            {"num_vars": len(names), "names": names},
            x,
            y,
            poly_order=degree,
            bootstrap=1,
            subset=len(y),
            return_emulator=True,
        )
