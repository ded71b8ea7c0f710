"""Subset simulation: a rare event as a sequence of likely conditional events.

All replicates run together. OpenTURNS 1.27 is not used: it requests a hundred rows at a time, one
replicate after the other, and one run in a few dozen ends with the error "The variance estimate
must be >= 0".
"""

from collections.abc import Callable, Generator
from math import ceil
from typing import NamedTuple

import numpy as np

from uq.contract import Floats
from uq.stats.intervals import Ends, binomial_interval, log_scatter_interval

Margin = Callable[[Floats], Floats]
"""``margin(u)``: points of standard normal space (n, d) -> distance beyond the limit (n,), positive
within the event, -inf for a row without a value."""

LEVEL_SHARE = 0.1
"""Share of a level's rows from which the next level grows."""

SMALLEST = 1e-12
"""Probability below which a replicate stops."""

_ACCEPTED = 0.44  # share of accepted moves at which chains mix fastest
_FIRST_STEP = 0.6
_CORRELATION = 3.0  # autocorrelation factor gamma of a level: n / effective sample size - 1


class SubsetReplicate(NamedTuple):
    """The outcome of one replicate.

    Attributes
    ----------
    probability : float
        0 if no row was within the event.
    levels : int
        Levels sampled.
    inside : ndarray, shape (k, d)
        Its rows within the event, in standard normal space, equally likely.
    last_level : float
        Probability of the last level, of which the event is a part.
    first_hits : int
        Rows within the event among those of the first level, which are independent.
    ended : {"event", "plateau", "smallest"}
        Why it ended.
    """

    probability: float
    levels: int
    inside: Floats
    last_level: float
    first_hits: int
    ended: str


def subset_simulation(
    margin: Margin, d: int, samples: int, generators: list[np.random.Generator]
) -> list[SubsetReplicate]:
    """Estimate the probability that the margin is positive, once per generator.

    Parameters
    ----------
    margin : callable
        See `Margin`. Called with the rows of all replicates at once.
    d : int
        Dimension of standard normal space.
    samples : int
        Rows of each level and replicate.
    generators : list of numpy.random.Generator
        One per replicate.

    Returns
    -------
    list of SubsetReplicate
        One per replicate, independent of each other.

    Notes
    -----
    Levels as in [1]_; chains move by conditional sampling with a step adapted to the share of
    accepted moves [2]_. A margin with its own random numbers, drawn afresh in each call, is sampled
    correctly too: they are part of the state and proposed independently. Levels handle ties: if so
    many rows share the lowest value that a level would contain all rows, the level contains only
    rows strictly above that value. A replicate ends within the event, on a plateau where no row
    exceeds the others, or at a level less likely than `SMALLEST`. A budget is not required: a level
    that does not rise ends the replicate, and each rising level excludes rows.

    References
    ----------
    .. [1] S. K. Au, J. L. Beck, "Estimation of small failure probabilities in high dimensions by
       subset simulation", Probab. Eng. Mech. 16, 263-277 (2001).
    .. [2] I. Papaioannou, W. Betz, K. Zwirglmaier, D. Straub, "MCMC algorithms for subset
       simulation", Probab. Eng. Mech. 41, 89-103 (2015).
    """
    walks = [_walk(d, samples, rng) for rng in generators]
    asked = {number: next(walk) for number, walk in enumerate(walks)}
    outcomes: dict[int, SubsetReplicate] = {}
    while asked:
        margins = margin(np.concatenate(list(asked.values())))
        parts = np.split(margins, np.cumsum([len(u) for u in asked.values()])[:-1])
        for number, part in zip(list(asked), parts, strict=True):
            try:
                asked[number] = walks[number].send(part)
            except StopIteration as ended:
                outcomes[number] = ended.value
                del asked[number]
    return [outcomes[number] for number in range(len(walks))]


def _walk(
    d: int, samples: int, rng: np.random.Generator
) -> Generator[Floats, Floats, SubsetReplicate]:
    """Yield the points of one replicate, receive their margins, return its outcome."""
    u = rng.standard_normal((samples, d))
    g = yield u
    top, first_hits = ceil(LEVEL_SHARE * samples), int((g > 0).sum())
    probability, levels, step = 1.0, 1, _FIRST_STEP
    while True:
        limit, lowest = np.partition(g, -top)[-top], g.min()
        if limit == lowest:  # a tie: go on from the few rows above it, if any
            limit = g[g > lowest].min(initial=np.inf)
        if limit > 0:
            hits = g > 0
            ended = "event" if hits.any() else "plateau"
            within = probability * float(hits.mean())
            return SubsetReplicate(within, levels, u[hits], probability, first_hits, ended)
        probability *= float(np.mean(g >= limit))
        if probability < SMALLEST:
            return SubsetReplicate(0.0, levels, u[:0], probability, first_hits, "smallest")
        inside = np.flatnonzero(g >= limit)
        chosen = rng.choice(inside, top, replace=len(inside) < top)
        chain, margins = [u[chosen]], [g[chosen]]
        for k in range(1, ceil(samples / top)):
            move = np.sqrt(1 - step**2) * chain[-1] + step * rng.standard_normal((top, d))
            proposed = yield move
            accepted = proposed >= limit
            chain.append(np.where(accepted[:, None], move, chain[-1]))
            margins.append(np.where(accepted, proposed, margins[-1]))
            step = min(1.0, step * np.exp((accepted.mean() - _ACCEPTED) / np.sqrt(k)))
        u, g = np.concatenate(chain), np.concatenate(margins)
        levels += 1


def disagreement(replicates: list[SubsetReplicate], samples: int) -> float:
    """Return the ratio of largest to smallest estimate, if chain correlation does not explain it.

    Parameters
    ----------
    replicates : list of SubsetReplicate
    samples : int
        Rows of each level.

    Returns
    -------
    float
        1 if the scatter is at most twice the value of Au and Beck for correlated chains, or if a
        replicate did not reach the event. A larger ratio means that rows entered the event from far
        outside: the output has no trend towards a part of it.
    """
    estimates = np.array([replicate.probability for replicate in replicates])
    if len(replicates) < 2 or not (estimates > 0).all():
        return 1.0
    levels = np.mean([replicate.levels for replicate in replicates])
    explained = levels * (1 / LEVEL_SHARE - 1) * (1 + _CORRELATION) / samples
    scatter = np.log(estimates).var(ddof=1)
    return float(estimates.max() / estimates.min()) if scatter > 4 * explained else 1.0


def subset_interval(replicates: list[SubsetReplicate], samples: int) -> Ends:
    """Return the confidence interval from replicates of subset simulation.

    Parameters
    ----------
    replicates : list of SubsetReplicate
    samples : int
        Rows of each level.

    Returns
    -------
    low, high : float
        If every replicate reached the event: from their scatter or, if all ended at the first level
        with its independent rows, the interval of a proportion. Otherwise the low end is zero, or
        higher if the scatter supports it, and the high end is the smaller of two upper bounds. The
        first is the bound of a proportion in the rows of the first level. The second assigns to
        each replicate that did not reach the event the probability of its last level, of which the
        event is a subset.
    """
    estimates = np.array([replicate.probability for replicate in replicates])
    rows = samples * len(replicates)
    first = binomial_interval(sum(replicate.first_hits for replicate in replicates) / rows, rows)
    if all(replicate.levels == 1 for replicate in replicates):
        return first
    scatter = log_scatter_interval(estimates)
    if (estimates > 0).all():
        return scatter
    at_most = np.array([replicate.probability or replicate.last_level for replicate in replicates])
    high = np.fmin(first[1], log_scatter_interval(at_most)[1])
    return float(np.fmax(scatter[0], 0.0)), float(high)
