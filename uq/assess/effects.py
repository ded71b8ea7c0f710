"""Average slope of an output over an input, and probability of an event along an input."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.indices.measures import has_many_equal
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import Estimate
from uq.stats.intervals import (
    CONFIDENCE,
    Ends,
    interval_of_mean,
    is_constant,
    share_interval,
    sized,
)

ROWS_PER_INPUT = 10
"""With fewer rows for each input there are no effects."""

PIECES = 5
"""Parts of equal size of an input in which the effect must not turn."""

_SKEWED = 1.0
"""Skewness at which a logarithm is no better than the input itself; of a uniform input it is -2."""

_SURE = 0.99
"""Confidence with which a turn must be seen."""


@dataclass(frozen=True)
class Effect:
    """The average effect of one input.

    Attributes
    ----------
    slope : Estimate
        Of the output, per unit of the input or of its natural logarithm.
    logarithmic : bool
        Whether the slope refers to the logarithm of the input.
    sd : float
        Standard deviation of the input or of its logarithm, in these rows.
    turns : bool
        Whether the effect has one sign in one part of the input and another elsewhere.
    of_values : bool
        Whether many rows have equal values of the input, so that it has no small changes.
    """

    slope: Estimate
    logarithmic: bool
    sd: float
    turns: bool = False
    of_values: bool = False

    @property
    def direction(self) -> int:
        """1 if the output rises with the input, -1 if it falls, 0 where neither is clear."""
        if self.turns or not (self.slope.low > 0 or self.slope.high < 0):
            return 0
        return 1 if self.slope.value > 0 else -1


class Regressors:
    """The inputs of rows as regressors of any output; what depends on them is computed once.

    Parameters
    ----------
    inputs : dict of str to ndarray, shape (n,)

    Attributes
    ----------
    columns : dict of str to ndarray, shape (n,)
        Inputs that vary, or the logarithms of those that `logarithmic` names.
    logarithmic : dict of str to bool
    """

    def __init__(self, inputs: Mapping[str, Floats]):
        self._inputs = inputs
        self._pieces: dict[str, tuple[NDArray[np.intp], NDArray[np.intp]]] = {}
        self.columns, self.logarithmic = dict[str, Floats](), dict[str, bool]()
        for name, column in inputs.items():
            if len(column) and np.isfinite(column).all() and not is_constant(column):
                self.logarithmic[name] = _suits_logarithm(column)
                self.columns[name] = np.log(column) if self.logarithmic[name] else column

    def of_rows(self, kept: Mask) -> "Regressors":
        """Return the regressors of some rows."""
        if kept.all():
            return self
        return Regressors({name: column[kept] for name, column in self._inputs.items()})

    @cached_property
    def sizes(self) -> dict[str, float]:
        """Standard deviation of each."""
        return {name: float(column.std()) for name, column in self.columns.items()}

    @cached_property
    def scaled(self) -> Floats:
        """A column of ones, then each regressor with mean 0 and standard deviation 1."""
        x = np.column_stack([(c - c.mean()) / self.sizes[n] for n, c in self.columns.items()])
        return np.column_stack([np.ones(len(x)), x])

    @cached_property
    def factors(self) -> tuple[Floats, Floats]:
        """The orthogonal and the triangular factor of `scaled`."""
        orthogonal, triangle = np.linalg.qr(self.scaled)
        return orthogonal, triangle

    @cached_property
    def spare(self) -> Floats:
        """1 minus the leverage of each row."""
        orthogonal, _ = self.factors
        return np.asarray(1 - np.einsum("ij,ij->i", orthogonal, orthogonal))

    @cached_property
    def has_many_equal(self) -> dict[str, bool]:
        """Whether many rows share a value of an input."""
        return {name: has_many_equal(column) for name, column in self.columns.items()}

    def pieces(self, name: str) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the piece of an input that each row is in, and the number of rows in each."""
        if name not in self._pieces:
            x = self.scaled[:, 1 + list(self.columns).index(name)]
            edges = np.quantile(x, np.linspace(0, 1, PIECES + 1)[1:-1])
            piece = np.searchsorted(edges, x, side="right")
            self._pieces[name] = piece, np.bincount(piece, minlength=PIECES)
        return self._pieces[name]


def effects(
    values: Floats,
    inputs: Mapping[str, Floats] | Regressors,
    dependence: Dependence = INDEPENDENT,
    names: Collection[str] | None = None,
) -> dict[str, Effect]:
    """Estimate average effects of inputs on an output.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where a row has none.
    inputs : dict of str to ndarray, shape (n,), or Regressors
    dependence : Dependence, optional
    names : collection of str, optional
        The inputs whose effects are returned; by default all.

    Returns
    -------
    dict of str to Effect
        The slopes of the linear function of all inputs that is closest to the output: the average
        of the derivative for normal inputs. Positive inputs enter by their logarithms, unless these
        are very skewed. Intervals are by the influence of each row, the residual divided by one
        less its leverage (HC3 [1]_), which allows for a scatter that varies and for a function that
        is not linear; of replicates, or samples of several rows, by the scatter of their influence.
        Empty with fewer than `ROWS_PER_INPUT` rows for each input.

    References
    ----------
    .. [1] J. G. MacKinnon, H. White, "Some heteroskedasticity-consistent covariance matrix
       estimators with improved finite sample properties", J. Econometrics 29, 305-325 (1985).
    """
    kept = np.isfinite(values)
    dependence = dependence[kept]
    regressors = (inputs if isinstance(inputs, Regressors) else Regressors(inputs)).of_rows(kept)
    columns = regressors.columns
    y, unit = sized(values[kept])  # squares neither overflow nor vanish
    if not columns or len(y) < ROWS_PER_INPUT * (len(columns) + 1) or is_constant(y):
        return {}
    orthogonal, triangle = regressors.factors
    if np.abs(np.diag(triangle)).min() < 1e-6 * len(y) ** 0.5:  # one input repeats others
        return {}
    inverse = np.linalg.inv(triangle)
    slopes = inverse @ (orthogonal.T @ y)
    residual = y - regressors.scaled @ slopes
    weighted = orthogonal * (residual / np.maximum(regressors.spare, 1e-9))[:, None]
    influence = len(y) * weighted @ inverse.T
    by_input = {}
    for i, name in enumerate(columns):
        if names is not None and name not in names:
            continue
        slope = float(slopes[i + 1])
        low, high = _interval(slope, slope + influence[:, i + 1], dependence)
        size = regressors.sizes[name]
        value, low, high = (unit * float(number) / size for number in (slope, low, high))
        of_input = Estimate(value, low, high)
        partial = residual + slope * regressors.scaled[:, i + 1]
        turns = _turns(partial, *regressors.pieces(name), np.sign(slope), dependence)
        logarithmic, equal = regressors.logarithmic[name], regressors.has_many_equal[name]
        by_input[name] = Effect(of_input, logarithmic, size, turns, equal)
    return by_input


def _suits_logarithm(column: Floats) -> bool:
    if column.min() <= 0:
        return False
    logarithms = np.log(column)
    away = (logarithms - logarithms.mean()) / logarithms.std()
    return bool(abs((away**3).mean()) < _SKEWED)


def _turns(
    partial: Floats,
    piece: NDArray[np.intp],
    counts: NDArray[np.intp],
    sign: float,
    dependence: Dependence,
) -> bool:
    """Return whether a partial effect steps against its slope between adjacent fifths."""
    if counts.min() < ROWS_PER_INPUT:
        return False
    means = np.bincount(piece, partial, PIECES) / counts
    around = (partial - means[piece]) * len(partial) / counts[piece]
    for first in range(PIECES - 1):
        step = means[first + 1] - means[first]
        side = np.where(piece == first + 1, 1.0, np.where(piece == first, -1.0, 0.0))
        ends = _interval(step, step + side * around, dependence, _SURE)
        if (sign > 0 and ends[1] < 0) or (sign < 0 and ends[0] > 0):
            return True
    return False


def _interval(
    value: float, rows: Floats, dependence: Dependence, confidence: float = CONFIDENCE
) -> Ends:
    """Return the interval of an estimate from the influence of each row."""
    estimates = dependence.part_means(rows)
    if len(estimates) > 1 and is_constant(estimates):  # no row deviates
        return value, value
    return interval_of_mean(value, rows, dependence, confidence)


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


def event_curve(hits: Floats, x: Floats, dependence: Dependence = INDEPENDENT) -> EventCurve | None:
    """Estimate the probability of an event in parts of an input.

    Parameters
    ----------
    hits : ndarray, shape (n,)
        1 where it happened, 0 where not, NaN where that is not known.
    x : ndarray, shape (n,)
        The input.
    dependence : Dependence, optional

    Returns
    -------
    EventCurve or None
        Each interval covers the probability given that the input is in its part, whatever the
        curve within. None with fewer than two parts of `ROWS_PER_PART` rows.
    """
    kept = np.isfinite(hits)
    values, happened = x[kept], hits[kept] > 0
    dependence = dependence[kept]
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
        low, high = share_interval(happened[inside], dependence[inside])
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
