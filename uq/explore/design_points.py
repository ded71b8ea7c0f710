"""First-order reliability: design points by OpenTURNS, and importance sampling around them."""

from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from scipy.special import logsumexp

from uq.contract import Floats
from uq.errors import InputError
from uq.explore.subset_simulation import Margin
from uq.files.interrupts import undone

_STARTS = 8
_ITERATIONS = 100
_CALLS = 250  # of the model, in one search
_SAME_WAY = 0.7  # cosine between a start and a point found: a search would find it again
_APART = 0.5  # standard deviations between distinct design points


def design_points(margin: Margin, u: Floats, margins: Floats) -> Floats:
    """Find where the limit comes closest to the origin of standard normal space.

    Parameters
    ----------
    margin : callable
        Points (n, d) -> how far beyond the limit, (n,); not finite where a row has no value.
    u : ndarray, shape (n, d)
        Points already computed.
    margins : ndarray, shape (n,)
        Their margins. Up to eight searches [1]_ start from the largest in distinct directions: from
        the origin alone a search fails on symmetric limits, or finds one of several points.

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
    """Draw from normal laws around design points, with weights for the standard normal law.

    Parameters
    ----------
    points : ndarray, shape (k, d)
        Each is drawn from equally often.
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
    # Density of N(0, 1) over that of the mixture of N(point, 1).
    shifts = u @ points.T - (points**2).sum(axis=1) / 2
    return u, np.exp(np.log(len(points)) - logsumexp(shifts, axis=1))


def _cosine(a: Floats, b: Floats) -> float:
    return float(a @ b / (np.linalg.norm(a) * np.linalg.norm(b)))
