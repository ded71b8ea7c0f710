"""A search for parts of a rare event that another method missed: rows far from the centre."""

from math import log
from typing import NamedTuple

import numpy as np
from scipy.special import gammaincinv, logsumexp

from uq.contract import Floats
from uq.explore.subset_simulation import Margin
from uq.stats.intervals import CONFIDENCE, Ends, log_scatter_interval

PLAIN = 0.25
"""Share of rows from the inputs' own law, which bounds the weights by its inverse."""

_OF_ONE_INPUT = 2.5  # factor of the standard deviation of one input, each row another
_MOST_OF_ALL = 2.5
_ENOUGH = 20.0  # effective rows within the event, from which replicates show their scatter


class WideSearch(NamedTuple):
    """Probability of the event from rows drawn wide.

    Attributes
    ----------
    estimates : ndarray, shape (R,)
        Of each replicate.
    weights : ndarray, shape (k,)
        Contribution to the probability of each row within the event.
    plain : int
        Rows from the inputs' own law.
    """

    estimates: Floats
    weights: Floats
    plain: int

    @property
    def probability(self) -> float:
        """The mean of the replicates."""
        return float(self.estimates.mean())

    @property
    def is_enough(self) -> bool:
        """Whether the effective rows within the event suffice for an interval."""
        return self._effective >= _ENOUGH

    @property
    def interval(self) -> Ends:
        """Its 95 % interval; the high end is NaN where too few rows lie within the event.

        Then the low end is that of a weighted sum of Poisson variables (Fay & Feuer, Stat. Med. 16,
        791-801, 1997).
        """
        if self.is_enough:
            return log_scatter_interval(self.estimates)
        if not self._effective:
            return 0.0, np.nan
        share = gammaincinv(self._effective, (1 - CONFIDENCE) / 2) / self._effective
        return float(share * self.weights.sum()), np.nan

    def hidden_high(self, plain: int) -> float:
        """Return the 95 % upper bound of a part that none of these and further plain rows met."""
        return -log(1 - CONFIDENCE) / (self.plain + plain)

    @property
    def _effective(self) -> float:
        return (
            float(self.weights.sum() ** 2 / (self.weights**2).sum()) if len(self.weights) else 0.0
        )


def is_above(wide: float, low: float, high: float) -> bool:
    """Return whether rows drawn wide estimate more than an interval by over a standard error.

    Parameters
    ----------
    wide, low : float
        Their estimate, and the low end of its interval.
    high : float
        The high end of the other interval.
    """
    return (wide * low) ** 0.5 > high


def wide_search(
    margin: Margin, d: int, samples: int, generators: list[np.random.Generator]
) -> WideSearch:
    """Estimate the probability that the margin is positive by importance sampling from wide laws.

    Parameters
    ----------
    margin : callable
        See `uq.explore.subset_simulation.Margin`.
    d : int
        Dimension of standard normal space.
    samples : int
        Rows of each replicate.
    generators : list of numpy.random.Generator
        One per replicate.

    Returns
    -------
    WideSearch

    Notes
    -----
    A quarter of the rows is plain. The others have larger standard deviations [1]_: half of them in
    one input, each row another, by a factor of 2.5; half in all inputs, by 1 + 2/sqrt(d), at most
    2.5, so that the weights do not degenerate in many dimensions. Rows are weighted as drawn from
    the mixture [2]_. No trend of the margin is needed, but a part of the event that needs several
    of many inputs at once is out of reach.

    References
    ----------
    .. [1] C. G. Bucher, "Adaptive sampling - an iterative fast Monte Carlo procedure", Struct. Saf.
       5, 119-126 (1988).
    .. [2] A. Owen, Y. Zhou, "Safe and effective importance sampling", J. Am. Stat. Assoc. 95,
       135-143 (2000).
    """
    plain = round(PLAIN * samples)
    of_one = (samples - plain) // 2
    of_all = min(_MOST_OF_ALL, 1 + 2 / d**0.5)
    drawn = []
    for rng in generators:
        u = rng.standard_normal((samples, d))
        rows = np.arange(plain, plain + of_one)
        u[rows, rng.integers(d, size=of_one)] *= _OF_ONE_INPUT
        u[plain + of_one :] *= of_all
        drawn.append(u)
    u = np.concatenate(drawn)
    shares = np.array([plain, of_one, samples - plain - of_one]) / samples
    squares = u**2 / 2
    of_input = squares * (1 - _OF_ONE_INPUT**-2) - np.log(_OF_ONE_INPUT)
    logs = [
        np.zeros(len(u)),
        logsumexp(of_input, axis=1) - np.log(d),
        squares.sum(axis=1) * (1 - of_all**-2) - d * np.log(of_all),
    ]
    weight = np.exp(-logsumexp(np.stack(logs), axis=0, b=shares[:, None]))
    inside = margin(u) > 0
    estimates = (weight * inside).reshape(-1, samples).mean(axis=1)
    return WideSearch(estimates, weight[inside] / len(u), plain * len(generators))
