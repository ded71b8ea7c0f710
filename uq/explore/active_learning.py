"""Active learning of rare events: Gaussian processes choose the rows, and other rows correct them.

Rows are added where the emulator's sign is doubtful [1]_. The probability is then estimated from
further rows, drawn with a density that no longer changes: what the emulator says is corrected by
what these rows show, so that the interval does not depend on the emulator.

References
----------
.. [1] B. Echard, N. Gayton, M. Lemaire, "AK-MCS: an active learning reliability method combining
   Kriging and Monte Carlo simulation", Struct. Saf. 33, 145-154 (2011).
"""

from math import log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2
from scipy.special import logsumexp, ndtr, ndtri
from scipy.stats import qmc

from uq.contract import Floats, Mask
from uq.errors import InputError
from uq.explore.importance_sampling import PLAIN, drawn_wide, log_widened, widest
from uq.explore.limit_state import LimitState, MarginScale, scale_of
from uq.stats.intervals import (
    CONFIDENCE,
    Ends,
    exact_interval,
    weighted_count_interval,
)
from uq.stats.quantile_functions import normal
from uq.stats.regressions import Fit, Predict, openturns, process_of

DOUBT = 0.03
"""Learning ends if less than this share of the event's mass is expected to be misclassified."""

_BATCH = 12  # rows added at once
_CANDIDATES = 400
_APART = 0.3  # scaled distance between rows added at once
_CENTRES = 12
_POPULATION, _FINAL_POPULATION = 4000, 30_000
_REFIT = 1.25  # growth of the rows after which the scales of the kernel are estimated again
_RING = 2.0  # mass of the neighbourhood outside the event, over that of the event
_REACH = 10.0  # the same if rows in it contradicted the emulator when the budget was spent
_FEWEST_OF_RING = 100  # points
_SETTLED = 2  # populations in succession that meet `DOUBT`
_DRAWN = 30  # points drawn wide for each that is far from the event
_RAREST = 1e-12
_UNIT = 3.0  # standard deviations to a unit of the regression's inputs

Score = tuple[Floats, Floats, Floats]
"""Probability of the event, distance beyond the limit, and the distance two standard deviations
further towards the event, (n,) each, as the emulator predicts them."""


class Sizes(NamedTuple):
    """How a budget of rows is divided: a design, searches, and rows that correct the emulator.

    Attributes
    ----------
    design, search, inside, ring, far : int
    """

    design: int
    search: int
    inside: int
    ring: int
    far: int

    @property
    def reserve(self) -> int:
        """Rows kept for the last estimate."""
        return self.inside + self.ring + self.far


def sizes_of(samples: int) -> Sizes:
    """Return the division of a budget of rows, of which a third corrects the emulator."""
    reserve = samples // 3
    inside, ring = int(0.45 * reserve), int(0.35 * reserve)
    return Sizes(samples // 8, samples // 8, inside, ring, reserve - inside - ring)


class Population(NamedTuple):
    """Weighted points of standard normal space, the finite population of two-phase sampling.

    Attributes
    ----------
    u : ndarray, shape (n, d)
    mass : ndarray, shape (n,)
        Probability that each represents.
    """

    u: Floats
    mass: Floats


class EventEmulator:
    """Gaussian processes of the distances beyond each limit, and the event that they predict.

    Parameters
    ----------
    margin : LimitState

    Notes
    -----
    Each limit has a process of its own: the largest of several distances has a kink. The variance
    of rows about the process is estimated too: it serves jumps and rows with random numbers [1]_.

    References
    ----------
    .. [1] R. B. Gramacy, H. K. H. Lee, "Cases for the nugget in modeling computer experiments",
       Stat. Comput. 22, 713-722 (2012).
    """

    def __init__(self, margin: LimitState) -> None:
        self._margin = margin
        self.u = np.empty((0, margin.dimension))
        self._each = np.empty((0, len(margin.parts)))
        self._scales: list[MarginScale] = []
        self._fitted = 0  # rows from which kernels were estimated
        self._fits: list[Fit] = []
        self._predict: list[Predict] = []

    def add(self, u: Floats) -> Mask:
        """Compute rows, learn from them; return which are within the event."""
        each = self._margin.each(u)
        self.u, self._each = np.concatenate([self.u, u]), np.concatenate([self._each, each])
        self._learn()
        return self.is_inside(each)

    def each(self, u: Floats) -> Floats:
        """Compute rows, without learning; return distances beyond each limit, (n, limits)."""
        return self._margin.each(u)

    def is_inside(self, each: Floats) -> Mask:
        """Return which rows are within the event, from the distances beyond each limit."""
        beyond = each > 0
        return np.asarray(beyond.all(axis=1) if self._margin.every else beyond.any(axis=1))

    def _learn(self) -> None:
        renew = len(self.u) >= _REFIT * self._fitted
        if not self._scales:
            self._scales = [
                scale_of(part.limit, column)
                for part, column in zip(self._margin.parts, self._each.T, strict=True)
            ]
        self._predict = []
        fits = list[Fit]()
        for number, (scale, column) in enumerate(zip(self._scales, self._each.T, strict=True)):
            y = scale(column)
            finite = y[np.isfinite(y)]
            if len(finite) < 2 or not np.ptp(finite):
                raise InputError(
                    f"method 'active': '{scale.limit.output}' has no two different values in"
                    f" {len(y)} rows, nothing to learn from; use method 'subset'"
                )
            kept = ~np.isnan(y)
            y = np.clip(y, finite.min(), finite.max())[kept]
            y[y == 0] = -np.abs(y[y != 0]).min() / 2  # on the threshold is outside
            start = self._fits[number] if self._fits else None
            fit, predict = process_of(self.u[kept] / _UNIT, y, True, start, renew)
            fits.append(fit)
            self._predict.append(predict)
        self._fits = fits
        self._fitted = len(self.u) if renew else self._fitted

    def __call__(self, u: Floats) -> Score:
        """Predict the event at points of standard normal space, shape (n, d)."""
        means, sds = np.stack([predict(u / _UNIT) for predict in self._predict], axis=1)
        each, most = ndtr(means / sds), means + 2 * sds
        if self._margin.every:
            return each.prod(axis=0), means.min(axis=0), most.min(axis=0)
        return 1 - (1 - each).prod(axis=0), means.max(axis=0), most.max(axis=0)


def population_of(centres: Floats, d: int, count: int, rng: np.random.Generator) -> Population:
    """Draw from a mixture of widened laws and, half of the points, normal laws at centres."""
    near = count // 2 if len(centres) else 0
    wide, weight = drawn_wide(d, count - near, [rng])
    if not near:
        return Population(wide, weight / count)
    u = centres[rng.integers(len(centres), size=near)] + rng.standard_normal((near, d))
    u = np.concatenate([wide, u])
    # Densities over that of the input law: of the widened laws, and of normal laws at the centres.
    shifts = u @ centres.T - (centres**2).sum(axis=1) / 2
    logs = [log_widened(u, count - near), logsumexp(shifts, axis=1) - log(len(centres))]
    shares = np.array([count - near, near])[:, None] / count
    return Population(u, np.exp(-logsumexp(np.stack(logs), axis=0, b=shares)) / count)


def _centres(population: Population, probability: Floats, rng: np.random.Generator) -> Floats:
    """Return centres of the event, by k-means of points drawn from it as it is predicted."""
    chances = population.mass * probability
    if not chances.sum() > 0:
        return population.u[:0]
    u = population.u[rng.choice(len(chances), 600, p=chances / chances.sum())]
    different = len(np.unique(u, axis=0))
    centres, labels = kmeans2(u, min(_CENTRES, different), minit="++", rng=rng, missing="warn")
    return centres[np.unique(labels)]


def _added(
    emulator: EventEmulator, population: Population, score: Score, rng: np.random.Generator
) -> Floats:
    """Return points to compute next: the least certain of those likely to be misclassified."""
    doubt = misclassified(score)
    chances = population.mass * doubt
    drawn = np.unique(rng.choice(len(chances), _CANDIDATES, p=chances / chances.sum()))
    drawn = drawn[np.argsort(-doubt[drawn], kind="stable")]
    u, apart = population.u[drawn], list[Floats]()
    for point in u:
        if all(np.linalg.norm(point - other) > _APART for other in apart):
            apart.append(point)
        if len(apart) == _BATCH:
            break
    return np.array(apart)


def misclassified(score: Score) -> Floats:
    """Return the probability that the sign predicted is wrong: ``Phi(-U)`` for a single limit."""
    return np.where(score[1] > 0, 1 - score[0], score[0])


class ActiveEstimate(NamedTuple):
    """Outcome of active learning.

    Attributes
    ----------
    probability : float
    interval : Ends
        Of the part of the event that the rows reach.
    failed_high : float
        High end if the rows without a value were within the event.
    emulated : float
        Probability by the emulator alone.
    doubt : float
        Share of it that the emulator expects to misclassify.
    checks : int
        Rows that the last estimate is from.
    contradicted : int
        Those among them that contradict the emulator.
    plain : int
        Rows from the input law, which exclude an isolated part of the event.
    """

    probability: float
    interval: Ends
    failed_high: float
    emulated: float
    doubt: float
    checks: int
    contradicted: int
    plain: int


def active_learning(margin: LimitState, samples: int, rng: np.random.Generator) -> ActiveEstimate:
    """Estimate the probability of an event from few rows, which Gaussian processes choose.

    Parameters
    ----------
    margin : LimitState
    samples : int
        Largest number of rows.
    rng : numpy.random.Generator

    Returns
    -------
    ActiveEstimate

    Raises
    ------
    InputError
        When OpenTURNS is missing, or an output has the same value in all rows of the design.

    Notes
    -----
    A Latin hypercube, two thirds of it widened, is the first design. Batches are added where ``U =
    |mean| / sd`` is least [1]_ among points drawn from the input law times the probability of
    misclassification; a system takes a process for each limit [2]_. Learning stops when the mass
    expected to be misclassified is below `DOUBT` of that of the event [3]_, then rows
    within the event, beside it, on the axes and drawn wide look for contradictions, from which it
    goes on.

    A third of the rows is kept for the estimate, as in importance sampling from a metamodel [4]_.
    It is the mass of the event of the emulator, from 30,000 weighted points, less the mass of its
    part that rows contradict, plus the masses of the parts beside it and far from it that rows find
    within the event. Rows inside and beside it, a neighbourhood of at least twice its mass, ten
    times after contradictions there, are
    drawn in proportion to mass, hence each mass is a binomial share with exact limits; rows far
    from it are drawn wide, and their weighted count has gamma limits. The limits are combined by
    the method of variance estimates recovery [5]_. A far part that no row hits is not in the
    interval.

    References
    ----------
    .. [1] B. Echard, N. Gayton, M. Lemaire, "AK-MCS: an active learning reliability method
       combining Kriging and Monte Carlo simulation", Struct. Saf. 33, 145-154 (2011), eq. (14).
    .. [2] W. Fauriat, N. Gayton, "AK-SYS: an adaptation of the AK-MCS method for system
       reliability", Reliab. Eng. Syst. Saf. 123, 137-144 (2014).
    .. [3] Z. Wang, A. Shafieezadeh, "ESC: an efficient error-based stopping criterion for
       kriging-based reliability analysis methods", Struct. Multidiscip. Optim. 59, 1621-1637
       (2019).
    .. [4] V. Dubourg, B. Sudret, F. Deheeger, "Metamodel-based importance sampling for structural
       reliability analysis", Probab. Eng. Mech. 33, 47-57 (2013).
    .. [5] G. Y. Zou, A. Donner, "Construction of confidence limits about effect measures: a general
       approach", Stat. Med. 27, 1693-1702 (2008).
    """
    openturns()
    d, sizes = margin.dimension, sizes_of(samples)
    emulator = EventEmulator(margin)
    plain = sizes.design // 3
    u = ndtri(qmc.LatinHypercube(d, rng=rng).random(sizes.design))
    u[plain:] *= widest(d)
    emulator.add(u)
    budget, centres = samples - sizes.reserve, u[:0]
    contradicted, reach = True, _REACH
    while contradicted:
        settled = 0
        while True:
            population = population_of(centres, d, _POPULATION, rng)
            score = emulator(population.u)
            centres = _centres(population, score[0], rng)
            doubt = _doubt(population, score)
            settled = settled + 1 if doubt <= DOUBT else 0
            left = budget - sizes.search - margin.rows
            certain = not (population.mass * misclassified(score)).any()
            if settled == _SETTLED or certain or left <= 0:
                break
            if not settled:
                emulator.add(_added(emulator, population, score, rng)[:left])
        if left < 0:
            break
        limit, ring = _ring(population, score, _RING)
        fifth = sizes.search // 5
        star = _star(population, score, rng)[: 2 * fifth]
        near = _drawn(population, ring, fifth, rng)
        within = _drawn(population, score[1] > 0, fifth, rng)
        rest = sizes.search - len(star) - len(near) - len(within)
        far, _ = _far(emulator, limit, rest, d, rng)
        u = np.concatenate([population.u[near], population.u[within], star, far])
        wrong = emulator(u)[1] > 0
        wrong ^= emulator.add(u)
        contradicted = bool(wrong.any())
        reach = _REACH if wrong[: len(near)].any() else _RING
        plain += round(PLAIN * len(far))
    final = population_of(centres, d, _FINAL_POPULATION, rng)
    return _corrected(emulator, final, sizes, reach, doubt, plain, rng)


def _doubt(population: Population, score: Score) -> float:
    """Return the mass expected to be misclassified over that of the event."""
    mass = float(population.mass[score[1] > 0].sum())
    return float((population.mass * misclassified(score)).sum()) / mass if mass else np.inf


def _drawn(
    population: Population, part: Mask, count: int, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Draw points of a part of the population in proportion to mass; none if it is empty."""
    chances = population.mass * part
    total = chances.sum()
    return rng.choice(len(part), count, p=chances / total) if total > 0 else np.empty(0, np.int64)


def _ring(population: Population, score: Score, reach: float) -> tuple[float, Mask]:
    """Return the distance, and the points, of the neighbourhood outside the event.

    It has `reach` times the mass of the event, and more if the event is expected to reach further.
    """
    inside, expected = score[1] > 0, population.mass * score[0]
    order = np.argsort(np.where(inside, np.inf, -score[2]), kind="stable")[: int((~inside).sum())]
    counts = (
        _FEWEST_OF_RING,
        np.searchsorted(
            np.cumsum(population.mass[order]), reach * float(population.mass[inside].sum())
        ),
        np.searchsorted(np.cumsum(expected[order]), expected[order].sum() - DOUBT * expected.sum()),
    )
    count = min(int(max(counts)) + 1, len(order))
    limit = float(score[2][order[count - 1]]) if count else np.inf
    return limit, ~inside & (score[2] >= limit)


def _star(population: Population, score: Score, rng: np.random.Generator) -> Floats:
    """Return points on both sides of each axis, as far away as a plane with the event's mass.

    An event of a single input, without any sign of it in the others, contains one of them if it is
    as likely.
    """
    mass = float((population.mass * score[0]).sum())
    axes = np.eye(population.u.shape[1])
    return -ndtri(np.clip(mass, _RAREST, 0.1)) * rng.permutation(np.concatenate([axes, -axes]))


def _far(
    emulator: EventEmulator, limit: float, count: int, d: int, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Draw points wide, outside the event and its neighbourhood, and their weights over `count`."""
    u, weight = drawn_wide(d, _DRAWN * count, [rng])
    score = emulator(u)
    far = np.flatnonzero((score[1] <= 0) & (score[2] < limit))
    chosen = rng.permutation(far)[:count]
    return u[chosen], weight[chosen] * len(far) / (len(u) * max(len(chosen), 1))


def _corrected(
    emulator: EventEmulator,
    population: Population,
    sizes: Sizes,
    reach: float,
    doubt: float,
    plain: int,
    rng: np.random.Generator,
) -> ActiveEstimate:
    """Return the estimate of the emulator, corrected by further rows."""
    u, mass = population
    score = emulator(u)
    inside = score[1] > 0
    limit, ring = _ring(population, score, reach)
    picked = [
        _drawn(population, inside, sizes.inside, rng),
        _drawn(population, ring, sizes.ring, rng),
    ]
    far, weight = _far(emulator, limit, sizes.far, u.shape[1], rng)
    first, second = len(picked[0]), len(picked[0]) + len(picked[1])
    each = emulator.each(np.concatenate([u[np.concatenate(picked)], far]))
    hits, lost = emulator.is_inside(each), np.isnan(each).any(axis=1)
    masses = float(mass[inside].sum()), float(mass[ring].sum())
    scatter = float(np.sqrt((mass[inside] ** 2).sum()))

    def estimated(hits: Mask) -> tuple[float, Ends]:
        of_far = weight[hits[second:]]
        error = float(normal(1 - (1 - CONFIDENCE) / 2)) * scatter
        parts = [
            (masses[0], (masses[0] - error, masses[0] + error)),
            _mass(masses[0], ~hits[:first], -1.0),
            _mass(masses[1], hits[first:second], 1.0),
            (
                float(of_far.sum()),
                weighted_count_interval(of_far, float(of_far.max(initial=0.0))),
            ),
        ]
        value = sum(estimate for estimate, _ in parts)
        below = sum((estimate - low) ** 2 for estimate, (low, _) in parts) ** 0.5
        above = sum((high - estimate) ** 2 for estimate, (_, high) in parts) ** 0.5
        # Masses are estimates: their sum may exceed that of all points.
        ends = np.clip([value, value - below, value + above], 0.0, 1.0).tolist()
        return ends[0], (ends[1], ends[2])

    plain += round(PLAIN * len(far))
    wrong = int((~hits[:first]).sum() + hits[first:].sum())
    value, ends = estimated(hits)
    failed_high = estimated(hits | lost)[1][1]
    alone = min(masses[0], 1.0)
    return ActiveEstimate(value, ends, failed_high, alone, doubt, len(hits), wrong, plain)


def _mass(mass: float, contradicted: Mask, sign: float) -> tuple[float, Ends]:
    """Return the mass of the contradicted part of a stratum, with its sign, and its interval."""
    if not len(contradicted):
        return 0.0, (0.0, 0.0)
    share = float(contradicted.mean())
    low, high = (float(end) * mass for end in exact_interval(share, len(contradicted), CONFIDENCE))
    return sign * share * mass, (low, high) if sign > 0 else (-high, -low)
