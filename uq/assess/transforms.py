"""Transforms of outputs whose own variance is not informative: logarithm, rank or rate.

A life may never end or be censored; and where a few rows hold most of the variance, its indices are
about these rows.
"""

import numpy as np

from uq.contract import LARGEST_VALUE, Floats
from uq.result.element import Element
from uq.stats.order_statistics import mid_ranks
from uq.stats.tails import heavier_tail
from uq.text.numbers import counted, percent

LARGEST = 0.01
"""Share of the rows that a heavy tail is judged by: those farthest from the mean."""

HEAVY = 1 / 3
"""They hold 8 % of the variance of a normal law, 22 % of an exponential one, 49 % of a lognormal
one with sigma = 1; beyond a third the tail counts as heavy."""

FEWEST = 100
"""In fewer rows a single one is more than `LARGEST`: no tail is judged."""


Transformed = tuple[Floats, str]
"""One number per row, NaN where there is none; and why there can be none at all, or ""."""


def tail_share(values: Floats) -> float:
    """Return the share of the variance that lies in the 1 % of rows farthest from the mean.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where there is none.

    Returns
    -------
    float
        0 where there are fewer than `FEWEST` values, or all are the same.
    """
    defined = values[np.isfinite(values)]
    if len(defined) < FEWEST or not np.ptp(defined) > 0:
        return 0.0
    scaled = defined / np.abs(defined).max()  # squares neither overflow nor vanish
    squares = np.sort((scaled - scaled.mean()) ** 2)
    return float(squares[-int(np.ceil(LARGEST * len(defined))) :].sum() / squares.sum())


def heaviness(values: Floats) -> str:
    """Return why indices of the variance of these values are about a few of them.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where there is none.

    Returns
    -------
    str
        A clause; "" where the largest 1 % hold less than `HEAVY` of the variance, and the tail's
        shape is compatible with a finite variance (`uq.stats.tails`).
    """
    share = tail_share(values)
    if share > HEAVY:
        return f"{100 * LARGEST:g} % of the rows hold {percent(share)} of the variance"
    tail = heavier_tail(values[np.isfinite(values)])
    if tail is not None and tail.no_variance:
        return f"the {tail.side} tail suggests an infinite variance (k = {tail.k:.2g})"
    return ""


def logarithm(element: Element) -> Transformed:
    """Return the natural logarithm of an output; refused if a row has none."""
    nothing = np.full(len(element.values), np.nan)
    counts = {
        ("never ends", "never end"): int(element.never.sum()),
        ("is censored", "are censored"): int(element.censored.sum()),
        ("is not positive", "are not positive"): int((element.values <= 0).sum()),
    }
    excluded = [counted(count, *words) for words, count in counts.items() if count]
    if excluded:
        rows = f"of {int(element.present.sum())} rows {' and '.join(excluded)}"
        return nothing, f"{rows}: no logarithm; ask for rank({element.name})"
    return np.log(element.values), ""


def rank(element: Element) -> Transformed:
    """Return the share of rows below each, ties counted by half.

    Parameters
    ----------
    element : Element
        Rows of a lifetime that never end, and those censored after all others have ended, share the
        highest rank: their order is neither known nor needed.

    Returns
    -------
    values : ndarray, shape (n,)
        Between 0 and 1.
    refused : str
        Where a row was censored before the last life ended: its rank is not known.

    References
    ----------
    A. Saltelli, I. M. Sobol', "About the use of rank transformation in sensitivity analysis of
    model output", Reliab. Eng. Syst. Saf. 50, 225-239 (1995).
    """
    values, present = element.values, element.present
    beyond = element.never | element.censored
    last = values[present & ~beyond].max(initial=-np.inf)
    unknown = int((element.censored & (values < last)).sum())
    if unknown:
        return (
            np.full(len(values), np.nan),
            f"{counted(unknown, 'row')} censored before the last life ended: the order of the rows"
            " is not known; ask for P(T < t) by a threshold in [analysis], or lengthen the horizon",
        )
    ranks = np.full(len(values), np.nan)
    ranks[present] = mid_ranks(np.where(beyond, np.inf, values)[present])
    return ranks, ""


def rate(element: Element) -> Transformed:
    """Return the inverse of a life, 0 if it never ends; refused if a row has none."""
    with np.errstate(divide="ignore", over="ignore"):
        inverse = 1 / element.values
    if censored := int(element.censored.sum()):
        refused = (
            f"{counted(censored, 'lifetime is', 'lifetimes are')} censored, and the rate not known;"
            " ask for P(T < t) by a threshold in [analysis], or lengthen the horizon"
        )
    elif too_short := int((inverse > LARGEST_VALUE).sum()):
        rows, unit = counted(too_short, "row has", "rows have"), element.declared.unit
        refused = f"{rows} lifetime zero or below {1 / LARGEST_VALUE:g} {unit}: no rate"
    else:
        refused = ""
    return inverse, refused
