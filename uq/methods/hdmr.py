"""Sensitivity from an expansion in functions of one and of two inputs, fitted by SALib."""

import warnings
from itertools import combinations
from typing import Any

import numpy as np

from uq.estimate import Estimate
from uq.methods.indices import S1, S2, SHAPLEY, ST, Indices, Null, RefusedError
from uq.methods.sample import Floats, Sample

MIN_ROWS = 300
"""SALib takes no fewer."""

EXPLAINED = 0.8
"""An expansion that explains less of rows it has not seen says too little about the output."""

_DEGREES = (2, 4, 6, 8)  # and what an input of few values allows, which tells all of them apart
_ENOUGH = 0.99
_LEAST_VALUES = 10
_MOST_ROWS = 2048
_TERMS_PER_ROW = 0.8
_MOST_TERMS = 500


def hdmr_indices(sample: Sample) -> Indices:
    """Estimate the indices of an expansion in functions of one and of two inputs.

    Parameters
    ----------
    sample : Sample
        Of independent inputs.

    Returns
    -------
    Indices
        ``S1``, ``S2``, ``ST`` and ``shapley``: S1 and half of the S2 that an input shares, which
        are its Shapley effect where no three inputs interact [2]_. No intervals; the null is what
        the fit makes of one input that plays no part.

    Raises
    ------
    RefusedError
        Too few rows, an input with a single value, or no degree of polynomials explains enough of
        the rows held out.

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
            f"it takes fewer than {_LEAST_VALUES} values, and no polynomial has such steps; use"
            " rbd-fast, pawn or regional"
        )
    n = min(len(y), _MOST_ROWS)
    if n < MIN_ROWS * 2:
        raise RefusedError(
            f"only {len(y)} rows have a value; {2 * MIN_ROWS} are needed, half of them held out"
        )
    names = [*x, ""]
    rng = np.random.default_rng(0)
    chosen = rng.permutation(len(y))[:n]  # imported rows may come in an order that means something
    columns = np.column_stack([*(column[chosen] for column in x.values()), rng.random(n)])
    y = (y[chosen] - y[chosen].mean()) / y[chosen].std()
    half = n // 2
    degrees, least = _degrees(names, columns[:half])
    degree, explained = 0, float("-inf")
    for candidate in degrees:
        if _terms(len(names), candidate) > min(_TERMS_PER_ROW * half, _MOST_TERMS):
            break
        # SALib takes the ranges of the inputs from the rows it is given: from all of them, here.
        expected = _expansion(columns[:half], y[:half], candidate).emulate(columns)
        rest = (y - expected)[half:]
        if (gain := float(1 - rest.var() / y[half:].var())) > explained:
            degree, explained = candidate, gain
        else:
            break  # more terms than the rows can tell apart
        if explained > _ENOUGH:
            break
    if not degree:
        raise RefusedError(f"{n} rows are too few for the pairs of {len(x)} inputs")
    if explained < EXPLAINED:
        raise RefusedError(
            f"functions of one and of two inputs explain {max(explained, 0):.0%} of the variance of"
            f" rows held out; {EXPLAINED:.0%} are needed{least}"
        )
    found = _expansion(columns, y, degree)
    share = np.ravel(found["S"])
    first, pairs = share[: len(names)], list(combinations(range(len(names)), 2))
    second = dict(zip(pairs, share[len(names) :], strict=True))
    shared = np.array(
        [sum(v for pair, v in second.items() if i in pair) for i in range(len(names))]
    )
    kinds = {S1: first, ST: first + shared, SHAPLEY: first + shared / 2}
    values = {
        kind: {name: Estimate(float(v)) for name, v in zip(x, found_, strict=False)}
        for kind, found_ in kinds.items()
    }
    values[S2] = {
        f"{names[i]},{names[j]}": Estimate(float(v)) for (i, j), v in second.items() if names[j]
    }
    note = (
        f"polynomials of degree {degree} in one and in two inputs explain {explained:.1%} of the"
        " variance of rows held out; an input without effect passes the one beside the indices in"
        " every second case"
    )
    nulls = {kind: Null(float(found_[-1])) for kind, found_ in kinds.items()}
    return Indices(values, (note,), nulls)


def _degrees(names: list[str], x: Floats) -> tuple[tuple[int, ...], str]:
    """Return the degrees to try, and why they are no higher; k values allow k - 1.

    Raises
    ------
    RefusedError
        Of an input with a single value.
    """
    counts = [len(np.unique(column)) for column in x.T]
    fewest = min(counts)
    name = names[counts.index(fewest)]
    if fewest == 1:
        raise RefusedError(
            f"{name} has the same value in all of {len(x)} rows: no polynomial can be fitted"
        )
    if fewest > max(_DEGREES):
        return _DEGREES, ""
    allowed = (*(d for d in _DEGREES if d < fewest - 1), fewest - 1)
    return (
        allowed,
        f" ({name} has {fewest} values, which allow no higher degree than {allowed[-1]})",
    )


def _terms(inputs: int, degree: int) -> int:
    return inputs * degree + inputs * (inputs - 1) // 2 * degree**2


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
