"""Estimators: the rows that take part, and the influence of each."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from uq.contract import Floats, Mask, Status
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.result import Result
from uq.stats import order_statistics


class SelectedRows(NamedTuple):
    """Numbers of the rows of a result, and which of them take part."""

    kept: Mask
    numbers: Floats


def with_value(element: Element) -> SelectedRows:
    """Return the values of an element, censored rows never ending."""
    return SelectedRows(element.present, np.where(element.censored, np.inf, element.values))


def whole(element: Element) -> SelectedRows:
    """Return value and censoring of each row."""
    return SelectedRows(element.present, np.column_stack([element.values, element.censored]))


def in_categories(rows: Result, name: str) -> dict[str, SelectedRows]:
    """Return which rows are in each category, of those that did not fail without.

    The name is that of an output, or of one element of it.
    """
    codes = rows.codes(name)[name]
    kept = (codes >= 0) | (rows.dataset["status"].values == Status.OK)
    return {
        label: SelectedRows(kept, (codes == code).astype(float))
        for code, label in flags(rows.dataset[name.partition("[")[0]])
        if code >= 0
    }


@dataclass(frozen=True)
class Estimator:
    """A function of the rows that take part, and the influence of each row on it.

    Attributes
    ----------
    of : callable
        Rows -> estimate.
    pull : callable
        Rows -> the influence of each, up to a factor; they sum to zero.
    sample : callable
        Element -> its rows; None where censored rows leave open which they are.
    is_share : bool
        Whether it is a share of rows, or the value beyond which such a share lies.
    counts_hits : bool
        Whether the numbers of the rows are 0 and 1.
    averages : bool
        Whether the estimate is the mean of the rows' numbers, probabilities between 0 and 1.
    is_scale : bool
        Whether two of them are also compared by their ratio.
    """

    of: Callable[[Floats], float]
    pull: Callable[[Floats], Floats]
    sample: Callable[[Element], SelectedRows | None] = with_value
    is_share: bool = False
    counts_hits: bool = False
    averages: bool = False
    is_scale: bool = False

    def influence(self, x: Floats) -> Floats:
        """Return the influence of each row on the estimate, a mean or a standard deviation."""
        pull = self.pull(x)
        return pull / (2 * x.std()) if self.is_scale else pull


def _centred(x: Floats) -> Floats:
    return x - x.mean()


def _sd(x: Floats) -> float:
    return float(x.std(ddof=1)) if len(x) > 1 else np.nan


MEAN = Estimator(np.mean, _centred)
SD = Estimator(_sd, lambda x: (x - x.mean()) ** 2 - x.var(), is_scale=True)


def share(sample: Callable[[Element], SelectedRows | None] = with_value) -> Estimator:
    """Return the estimator of the share of ones among the rows of a sample."""
    return Estimator(np.mean, _centred, sample, is_share=True, counts_hits=True)


def quantile(probability: float) -> Estimator:
    """Return the estimator of a quantile; the influence of a row is its side alone."""

    def of(x: Floats) -> float:
        return order_statistics.quantile(x, probability)

    def pull(x: Floats) -> Floats:
        below = x <= of(x)
        return below - below.mean()

    return Estimator(of, pull, is_share=True)
