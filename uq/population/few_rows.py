"""Where few rows carry a mean of numbers between 0 and 1: the interval of a share of hits."""

from collections.abc import Callable
from math import inf
from typing import NamedTuple

import numpy as np

from uq.contract import Floats
from uq.intervals import Ends, Replicates
from uq.population.smoothing import effective_rows, per_sample

FEW = 20
"""With fewer effective rows on either side, an interval is no narrower than that of hits."""


class Hits(NamedTuple):
    """Of how many rows an interval is no narrower than that of hits, and how far this counts."""

    rows: float
    """The effective number of all rows, or fewer where those that carry most are heavier than they:
    a row that is missing may be as heavy. Where no row carries anything, as heavy as the heaviest.
    """

    extent: float
    """1 where no more than 20 effective rows carry the mean, 0 from 40 on, between them linear, so
    that an interval does not jump where the weights change a little.
    """


def hits_behind(numbers: Floats, weights: Floats | None, part: Replicates) -> list[Hits]:
    """Return the hits of which the interval of a mean must allow, where few rows carry a side.

    Parameters
    ----------
    numbers : ndarray, shape (n,)
        Between 0 and 1.
    weights : ndarray, shape (n,), or None
    part : ndarray of int, shape (n,), or None
        The independent part of each row.

    Returns
    -------
    list of Hits
        Of the mean, and of its complement; only those that count.
    """
    worth = np.ones(len(numbers)) if weights is None else weights
    of_samples = per_sample(worth, part)
    found = (_hits(per_sample(worth * side, part), of_samples) for side in (numbers, 1 - numbers))
    return [one for one in found if one.extent > 0]


def _hits(carried: Floats, of_samples: Floats) -> Hits:
    extent = float(np.clip(2 - effective_rows(carried) / FEW, 0.0, 1.0))
    most = carried.max()
    # A sample that carries nearly as much as another counts nearly as it does.
    heaviest = (of_samples * carried).max() / most if most > 0 else of_samples.max()
    with np.errstate(over="ignore"):  # of a row that hardly has a weight
        rows = min(effective_rows(of_samples), float(of_samples.sum() / heaviest))
    return Hits(rows, extent)


def fewest_rows(hits: list[Hits]) -> float:
    """Return the least number of rows of which an interval is that of hits; infinite for none."""
    return min((one.rows for one in hits), default=inf)


def widened(ends: Ends, hits: list[Hits], of_hits: Callable[[float], Ends]) -> Ends:
    """Return an interval that is no narrower than those of hits, as far as these count.

    Parameters
    ----------
    ends : tuple
        Lower and upper end.
    hits : list of Hits
    of_hits : function
        Rows -> the interval of a share among so many.
    """
    intervals = [(of_hits(one.rows), one.extent) for one in hits]
    low, high = ends
    return (
        min((low + extent * min(0.0, there[0] - low) for there, extent in intervals), default=low),
        max(
            (high + extent * max(0.0, there[1] - high) for there, extent in intervals),
            default=high,
        ),
    )
