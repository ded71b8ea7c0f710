"""The probability of an event over an input, with its interval in each part of the input."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.estimate import Estimate
from uq.stats.intervals import Replicates, replicates_of_some, share_interval

MOST_PARTS = 12

ROWS_PER_PART = 30


class EventCurve(NamedTuple):
    """P(event | input).

    Attributes
    ----------
    edges : ndarray, shape (k + 1,)
        Ends of parts of the input that hold equally many rows; between values, where values are
        equal, and of each of few values.
    shares : list of Estimate
        The probability in each part.
    of_values : bool
        Whether each part holds one value, so that the probability does not change within it.
    """

    edges: Floats
    shares: list[Estimate]
    of_values: bool = False

    @property
    def least(self) -> int:
        """The part where it is least probable: an end, where that is compatible with the data."""
        low = min(share.value for share in self.shares)
        compatible = [i for i in self._ends if self.shares[i].low <= low]
        return min(compatible or range(len(self.shares)), key=lambda i: self.shares[i].value)

    @property
    def most(self) -> int:
        """The part where it is most probable: an end, where that is compatible with the data."""
        high = max(share.value for share in self.shares)
        compatible = [i for i in self._ends if self.shares[i].high >= high]
        return max(compatible or range(len(self.shares)), key=lambda i: self.shares[i].value)

    def around(self, i: int) -> tuple[float, float]:
        """Return the ends of a part, with the neighbours that have the same share."""
        first = last = i
        value = self.shares[i].value
        while first > 0 and self.shares[first - 1].value == value:
            first -= 1
        while last < len(self.shares) - 1 and self.shares[last + 1].value == value:
            last += 1
        return float(self.edges[first]), float(self.edges[last + 1])

    @property
    def _ends(self) -> tuple[int, int]:
        return 0, len(self.shares) - 1


def event_curve(hits: Floats, x: Floats, replicate: Replicates = None) -> EventCurve | None:
    """Estimate the probability of an event in parts of an input.

    Parameters
    ----------
    hits : ndarray, shape (n,)
        1 where it happened, 0 where not, NaN where that is not known.
    x : ndarray, shape (n,)
        The input.
    replicate : ndarray of int, shape (n,), optional

    Returns
    -------
    EventCurve or None
        Each interval covers the probability given that the input lies in its part, whatever the
        curve within. None with fewer than two parts of `ROWS_PER_PART` rows.
    """
    kept = np.isfinite(hits)
    values, happened = x[kept], hits[kept] > 0
    part = replicates_of_some(replicate, kept)
    parts = min(MOST_PARTS, len(values) // ROWS_PER_PART)
    if parts < 2:
        return None
    distinct, counts = np.unique(values, return_counts=True)
    if len(distinct) == len(values):
        edges = np.quantile(values, np.linspace(0, 1, parts + 1))
    else:
        few = len(distinct) <= MOST_PARTS
        edges = _between(distinct, counts, ROWS_PER_PART if few else len(values) // parts)
    if len(edges) < 3:
        return None
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    shares = []
    for i in range(len(edges) - 1):
        inside = place == i
        low, high = share_interval(happened[inside], replicates_of_some(part, inside))
        value = float(happened[inside].mean()) if inside.any() else np.nan
        shares.append(Estimate(value, float(low), float(high)))
    return EventCurve(edges, shares, len(shares) == len(distinct))


def _between(values: Floats, counts: NDArray[np.intp], least: int) -> Floats:
    """Return ends of parts between ascending values, each of at least so many rows."""
    ends = np.cumsum(counts)
    edges, held = [values[0]], 0
    while ends[-1] - held >= 2 * least:
        last = int(np.searchsorted(ends, held + least))
        held = ends[last]
        if ends[-1] - held < least:
            break
        edges.append((values[last] + values[last + 1]) / 2)
    return np.array([*edges, values[-1]])
