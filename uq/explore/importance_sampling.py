"""Importance sampling of rare events, around design points and from widened laws."""

from contextlib import suppress
from functools import partial
from math import log
from typing import Any, NamedTuple

import numpy as np
from scipy.special import gammaincinv, logsumexp

from uq.contract import Floats
from uq.errors import InputError
from uq.explore.subset_simulation import Margin
from uq.files.interrupts import undone
from uq.stats.intervals import CONFIDENCE, Ends, log_scatter_interval

_STARTS = 8
_ITERATIONS = 100
_CALLS = 250  # of the model, in one search
_SAME_WAY = 0.7  # cosine between a start and a known design point: skip a duplicate search
_APART = 0.5  # standard deviations between distinct design points

PLAIN = 0.25
"""Share of rows from the input law; its inverse bounds the weights (defensive mixture)."""

_OF_ONE_INPUT = 2.5  # factor of the standard deviation of one input, which alternates between rows
_MOST_OF_ALL = 2.5
_ENOUGH = 20.0  # effective rows within the event, sufficient for the scatter of replicates


def design_points(margin: Margin, u: Floats, margins: Floats) -> Floats:
    """Find the design points: limit-state points closest to the origin of standard normal space.

    Parameters
    ----------
    margin : callable
        Points (n, d) -> distance beyond the limit, (n,); not finite where a row has no value.
    u : ndarray, shape (n, d)
        Points already computed.
    margins : ndarray, shape (n,)
        Their margins. Up to eight searches [1]_ start from the points with the largest margins in
        distinct directions. A single search from the origin fails on symmetric limits, or finds
        only one of several points.

    Returns
    -------
    ndarray, shape (k, d)
        The nearest first; none if no search ends on the limit.

    Raises
    ------
    InputError
        When OpenTURNS is not installed.

    References
    ----------
    .. [1] T. Abdo, R. Rackwitz, "A new beta-point algorithm for large time-invariant and
       time-variant reliability problems", Reliability and Optimization of Structural Systems '90,
       1-12 (1991).
    """
    try:
        import openturns as ot
    except ImportError:
        raise InputError(
            "method 'importance' needs OpenTURNS: pip install 'vibrolife[reliability]', or use"
            " method 'subset'"
        ) from None
    refused: list[Exception] = []
    calls = 0

    def sample(points: Any) -> Floats:
        nonlocal calls
        calls += 1
        if calls > _CALLS:
            raise ValueError("too long a search")
        try:
            values = margin(np.array(points))
        except Exception as error:  # OpenTURNS would turn it into text
            refused.append(error)
            raise
        if not np.isfinite(values).all():
            raise ValueError("a row without a value")
        return values[:, None]

    function = ot.PythonFunction(u.shape[1], 1, func_sample=sample)
    limit = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(u.shape[1])))
    event = ot.ThresholdEvent(limit, ot.Greater(), 0.0)
    candidates: list[Floats] = []
    with undone(partial(ot.Log.Show, ot.Log.Flags())):
        ot.Log.Show(ot.Log.NONE)  # a failed search is reported in our own words
        searches = 0
        for start in np.argsort(-margins, kind="stable")[: max(_STARTS, len(u) // 10)]:
            if searches == _STARTS:
                break
            if any(_cosine(u[start], point) > _SAME_WAY for point in candidates):
                continue
            searches += 1
            calls = 0
            solver = ot.AbdoRackwitz()
            solver.setMaximumIterationNumber(_ITERATIONS)
            solver.setStartingPoint(u[start])
            search = ot.FORM(solver, event)
            with suppress(TypeError, RuntimeError, ValueError):  # no gradient, no value, no end
                search.run()
                point = np.array(search.getResult().getStandardSpaceDesignPoint())
                if solver.getResult().getConstraintError() < 1e-3 * (1 + np.ptp(margins)):
                    candidates.append(point)
            if refused:
                raise refused[0]
    candidates.sort(key=lambda point: float(np.linalg.norm(point)))
    apart: list[Floats] = []
    for point in candidates:
        if all(np.linalg.norm(point - other) > _APART for other in apart):
            apart.append(point)
    return np.array(apart).reshape(-1, u.shape[1])


def drawn_around(points: Floats, count: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Draw from a mixture of normal laws at design points; return points and importance weights.

    Parameters
    ----------
    points : ndarray, shape (k, d)
        Design points, with equal mixture weights.
    count : int
    rng : numpy.random.Generator

    Returns
    -------
    u : ndarray, shape (count, d)
    weight : ndarray, shape (count,)
        The mean of weight times event estimates the probability of the event.
    """
    centre = points[rng.integers(len(points), size=count)]
    u = centre + rng.standard_normal(centre.shape)
    # Ratio of the density of N(0, 1) to the mixture density of N(point, 1).
    shifts = u @ points.T - (points**2).sum(axis=1) / 2
    return u, np.exp(np.log(len(points)) - logsumexp(shifts, axis=1))


def _cosine(a: Floats, b: Floats) -> float:
    return float(a @ b / (np.linalg.norm(a) * np.linalg.norm(b)))


class WideSearch(NamedTuple):
    """Importance-sampling estimate of the event probability from widened laws.

    Attributes
    ----------
    estimates : ndarray, shape (R,)
        Of each replicate.
    weights : ndarray, shape (k,)
        Contribution to the probability of each row within the event.
    plain : int
        Number of rows from the input law.
    """

    estimates: Floats
    weights: Floats
    plain: int

    @property
    def probability(self) -> float:
        """Mean of the replicates."""
        return float(self.estimates.mean())

    @property
    def is_enough(self) -> bool:
        """Whether the effective rows within the event suffice for an interval."""
        return self._effective >= _ENOUGH

    @property
    def interval(self) -> Ends:
        """95 % confidence interval of the probability.

        If too few rows are within the event, the high end is NaN, and the low end is the bound for
        a weighted sum of Poisson variables (Fay & Feuer, Stat. Med. 16, 791-801, 1997).
        """
        if self.is_enough:
            return log_scatter_interval(self.estimates)
        if not self._effective:
            return 0.0, np.nan
        share = gammaincinv(self._effective, (1 - CONFIDENCE) / 2) / self._effective
        return float(share * self.weights.sum()), np.nan

    def hidden_high(self, plain: int) -> float:
        """Return the 95 % upper bound of a part missed by these and `plain` further plain rows."""
        return -log(1 - CONFIDENCE) / (self.plain + plain)

    @property
    def _effective(self) -> float:
        return (
            float(self.weights.sum() ** 2 / (self.weights**2).sum()) if len(self.weights) else 0.0
        )


def is_above(wide: float, low: float, high: float) -> bool:
    """Return whether a wide estimate exceeds an interval by more than one standard error.

    Parameters
    ----------
    wide, low : float
        The wide estimate, and the low end of its interval.
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
    A quarter of the rows follows the input law. The others have larger standard deviations [1]_.
    Half of them widen a single input, which alternates between rows, by a factor of 2.5. The other
    half widen all inputs by 1 + 2/sqrt(d), at most 2.5, so that the weights do not degenerate in
    high dimensions. Weights are those of a mixture density [2]_. No trend of the margin is needed,
    but a part of the event that requires several of many inputs at once is missed.

    References
    ----------
    .. [1] C. G. Bucher, "Adaptive sampling - an iterative fast Monte Carlo procedure", Struct. Saf.
       5, 119-126 (1988).
    .. [2] A. Owen, Y. Zhou, "Safe and effective importance sampling", J. Am. Stat. Assoc. 95,
       135-143 (2000).
    """
    u, weight = drawn_wide(d, samples, generators)
    plain = round(PLAIN * samples)
    inside = margin(u) > 0
    estimates = (weight * inside).reshape(-1, samples).mean(axis=1)
    return WideSearch(estimates, weight[inside] / len(u), plain * len(generators))


def drawn_wide(
    d: int, samples: int, generators: list[np.random.Generator]
) -> tuple[Floats, Floats]:
    """Draw from widened laws, see `wide_search`; return points and importance weights.

    Parameters
    ----------
    d : int
        Dimension of standard normal space.
    samples : int
        Rows of each replicate.
    generators : list of numpy.random.Generator
        One per replicate.

    Returns
    -------
    u : ndarray, shape (n, d)
        The rows of all replicates, one replicate after the other.
    weight : ndarray, shape (n,)
    """
    plain, of_one, _ = _shared_out(samples)
    drawn = []
    for rng in generators:
        u = rng.standard_normal((samples, d))
        rows = np.arange(plain, plain + of_one)
        u[rows, rng.integers(d, size=of_one)] *= _OF_ONE_INPUT
        u[plain + of_one :] *= widest(d)
        drawn.append(u)
    u = np.concatenate(drawn)
    return u, np.exp(-log_widened(u, samples))


def log_widened(u: Floats, samples: int) -> Floats:
    """Return the logarithm of the density of widened laws over that of the input law.

    Parameters
    ----------
    u : ndarray, shape (n, d)
        Points of standard normal space.
    samples : int
        Rows that are shared out among the widened laws.

    Returns
    -------
    ndarray, shape (n,)
    """
    d = u.shape[1]
    of_all = widest(d)
    shares = np.array(_shared_out(samples)) / samples
    squares = u**2 / 2
    of_input = squares * (1 - _OF_ONE_INPUT**-2) - np.log(_OF_ONE_INPUT)
    logs = [
        np.zeros(len(u)),
        logsumexp(of_input, axis=1) - np.log(d),
        squares.sum(axis=1) * (1 - of_all**-2) - d * np.log(of_all),
    ]
    return np.asarray(logsumexp(np.stack(logs), axis=0, b=shares[:, None]))


def _shared_out(samples: int) -> tuple[int, int, int]:
    """Return how many rows are plain, widened in a single input, and widened in all inputs."""
    plain = round(PLAIN * samples)
    of_one = (samples - plain) // 2
    return plain, of_one, samples - plain - of_one


def widest(d: int) -> float:
    """Return the factor by which the standard deviations of all d inputs are widened at once."""
    return min(_MOST_OF_ALL, 1 + 2 / d**0.5)
