"""A sample: the rows of an element and the estimates from them, whatever kind of rows they are."""

from typing import Protocol

from uq.assess.counted_rows import CountedRows, Curve
from uq.assess.population import Population
from uq.contract import Floats
from uq.result.element import Element
from uq.stats.estimate import Estimate
from uq.stats.intervals import CONFIDENCE, Replicates


class Sample(Protocol):
    """The rows of an element that take part in its statistics.

    Rows are independent, in replicates of a design or in clusters; they count alike, or have
    weights; each is a number, or the law of a life.
    """

    @property
    def element(self) -> Element:
        """The element."""

    @property
    def part(self) -> Replicates:
        """The replicate or cluster of each row; None where rows are independent."""

    def probability_below(self, threshold: float) -> Estimate:
        """Estimate P(Y < threshold), with the reason where it is unknown."""

    def probability_above(self, threshold: float) -> Estimate:
        """Estimate P(Y > threshold), with the reason where it is unknown."""

    def quantile(self, probability: float) -> Estimate:
        """Estimate a quantile without any assumption on censored rows."""

    def life_quantile(self, probability: float) -> Estimate:
        """Estimate the time by which a share has ended, where needed by Kaplan-Meier."""

    def survival(self, time: Floats) -> Curve:
        """Estimate P(T > t) at times that ascend, with pointwise intervals."""

    def rows_needed(self, probability: float) -> int | None:
        """Return how many rows a quantile needs; None where there are enough, or none."""


def as_sample(element: Element, part: Replicates, confidence: float = CONFIDENCE) -> Sample:
    """Return the rows of an element as a sample.

    Parameters
    ----------
    element : Element
    part : ndarray of int, shape (n,), or None
        The replicate or cluster of each row.
    confidence : float, optional
        Of intervals.
    """
    strategy = CountedRows if element.is_plain else Population
    return strategy(element, part, confidence)
