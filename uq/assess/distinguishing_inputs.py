"""Inputs and regimes that distinguish the rows that end first from all rows."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from uq.assess.row_inputs import independent_inputs
from uq.contract import Floats
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.result import Result
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import Estimate
from uq.stats.intervals import (
    CONFIDENCE,
    mean_interval,
    share_interval,
)

SHARE = 0.05
"""The part of the rows that counts as the earliest."""

FEWEST = 10
"""Minimum number of early rows for a comparison."""

Places = NDArray[np.intp]


@dataclass(frozen=True)
class RankShift:
    """An input whose values differ between the earliest rows and all.

    Attributes
    ----------
    name : str
    direction : int
        1 if the earliest rows have higher values, -1 if lower; 0 where only their distance from
        the middle differs.
    outwards : int
        With direction 0: 1 if they are farther from the median of all rows, -1 if nearer.
    rank : Estimate
        Mean rank of the earliest rows within all, from 0 to 1; 0.5 for all rows. With direction
        0, of the distances of the ranks from the middle.
    median, others : float
        Of the values, in the earliest rows and in the others.
    """

    name: str
    direction: int
    outwards: int
    rank: Estimate
    median: float
    others: float


@dataclass(frozen=True)
class RegimeOfFirst:
    """A regime of the earliest rows.

    Attributes
    ----------
    label : str
    share : Estimate
        Its share of the earliest rows.
    overall : float
        Its share of all rows.
    is_more_frequent : bool
        Whether the earliest rows are in it more often than all, with 95 % confidence for all
        regimes together.
    """

    label: str
    share: Estimate
    overall: float
    is_more_frequent: bool


def earliest_rows(element: Element) -> Places:
    """Return the indices of the rows that fail first: at most `SHARE` of those with a value.

    Fewer where fewer end, or where a row was censored before: it may have ended earlier.
    """
    present = np.flatnonzero(element.present)
    ended = present[~element.censored[present] & np.isfinite(element.values[present])]
    first_censored = element.values[element.censored & element.present].min(initial=np.inf)
    ended = ended[element.values[ended] <= first_censored]
    order = ended[np.argsort(element.values[ended], kind="stable")]
    return order[: max(int(np.ceil(SHARE * len(present))), min(FEWEST, len(present) // 2))]


def inputs_apart(
    result: Result,
    first: Places,
    ranked: Mapping[str, Floats],
    dependence: Dependence = INDEPENDENT,
) -> list[RankShift] | None:
    """Return the inputs whose values differ between some rows and all, the most different first.

    Parameters
    ----------
    result : Result
        Independent rows of a result.
    first : ndarray of int, shape (k,)
        Places of the rows.
    ranked : dict of str to ndarray, shape (n,)
        Ranks of each input in all rows, from 0 to 1 (`uq.stats.order_statistics.mid_ranks`).
    dependence : Dependence, optional

    Returns
    -------
    list of RankShift or None
        Those whose mean rank [1]_, or mean distance of the rank from the middle, differs with
        95 % confidence for all inputs together (Bonferroni). None where there is no interval.

    References
    ----------
    .. [1] H. B. Mann, D. R. Whitney, "On a test of whether one of two random variables is
       stochastically larger than the other", Ann. Math. Stat. 18, 50-60 (1947). That rows with a
       behaviour of interest are compared with the others, input by input: R. C. Spear, G. M.
       Hornberger, "Eutrophication in Peel Inlet - II", Water Res. 14, 43-49 (1980).
    """
    mask = np.zeros(len(result), dtype=bool)
    mask[first] = True
    # A rank follows its input without a jump.
    dependence = replace(dependence[mask], inputs=None)
    sure = 1 - (1 - CONFIDENCE) / (2 * max(len(ranked), 1))
    columns = independent_inputs(result)
    differences, has_intervals = [], False
    for name, rank in ranked.items():
        away = np.abs(rank - 0.5)
        # Ranks have a range of 1, their distances from the middle 1/2.
        for values, middle, size in ((rank, 0.5, 1.0), (away, float(away.mean()), 0.5)):
            low, high = mean_interval(values[mask], dependence, sure)
            has_intervals |= bool(np.isfinite(low))
            if low > middle or high < middle:
                mean = float(values[mask].mean())
                ends = mean_interval(values[mask], dependence)
                sign = 1 if mean > middle else -1
                column = columns[name]
                difference = RankShift(
                    name,
                    sign if values is rank else 0,
                    0 if values is rank else sign,
                    Estimate(mean, float(ends[0]), float(ends[1])),
                    float(np.median(column[mask])),
                    float(np.median(column[~mask])),
                )
                differences.append((abs(mean - middle) / size, difference))
                break
    if not has_intervals:
        return None
    return [difference for _, difference in sorted(differences, key=lambda pair: -pair[0])]


def regimes_of_first(
    result: Result, first: Places, dependence: Dependence = INDEPENDENT
) -> list[RegimeOfFirst]:
    """Return regimes more frequent in the given rows than in all rows, the most frequent first.

    If there are none, their most frequent regime; nothing where all rows are in one regime.
    """
    regimes = sorted(_regimes(result, first, dependence), key=lambda regime: -regime.share.value)
    more = [regime for regime in regimes if regime.is_more_frequent]
    return more or [regime for regime in regimes[:1] if regime.overall < 1]


def _regimes(result: Result, first: Places, dependence: Dependence) -> Iterator[RegimeOfFirst]:
    if "regime" not in result.dataset:
        return
    mask = np.zeros(len(result), dtype=bool)
    mask[first] = True
    dependence = dependence[mask]
    regimes = [(code, label) for code, label in flags(result.dataset["regime"]) if code >= 0]
    sure = 1 - (1 - CONFIDENCE) / max(len(regimes), 1)
    for code, label in regimes:
        inside = result.dataset["regime"].values == code
        overall = float(inside.mean())
        low, _ = share_interval(inside[mask], dependence, sure)
        share = Estimate(float(inside[mask].mean()), *share_interval(inside[mask], dependence))
        yield RegimeOfFirst(label, share, overall, bool(low > overall))
