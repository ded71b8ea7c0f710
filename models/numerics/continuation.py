"""Pseudo-arclength continuation of F(y, parameter) = 0, through folds.

In the space of u = (y, parameter) the branch has a unit tangent t even at a fold. The predictor
follows it, and the corrector solves F(u) = 0 with t . (u - u_0) = length of the step (H. B. Keller,
in P. H. Rabinowitz (ed.), Applications of Bifurcation Theory, Academic Press, 1977). The caller
scales y and the parameter so that lengths are meaningful.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from models.numerics.newton import Array, Linear, find_root

Function = Callable[[Array, float], Linear]

_ITERATIONS = 8  # of the corrector
_EASY = 3  # iterations up to which the next step is longer
_LONGER, _SHORTER = 1.6, 0.5
_BEND = 0.8  # cosine of the largest turn of the tangent in one step
_STRAY = 0.5  # longest correction, in lengths of the step


class Steps(NamedTuple):
    """Step lengths along the branch.

    Attributes
    ----------
    first, smallest, largest : float
    tolerance : float
        For the largest component of F in magnitude.
    """

    first: float
    smallest: float
    largest: float
    tolerance: float


class Point(NamedTuple):
    """One point of a branch.

    Attributes
    ----------
    state : ndarray, shape (n,)
    parameter : float
    tangent : ndarray, shape (n + 1,)
        Of unit length, the parameter last.
    linear : Linear
        F here.
    iterations : int
        Of the corrector.
    """

    state: Array
    parameter: float
    tangent: Array
    linear: Linear
    iterations: int


def begin(
    function: Function, state: Array, parameter: float, direction: float, tolerance: float
) -> Point | None:
    """Return the point of a branch at a given parameter.

    Parameters
    ----------
    function : callable
        Returns F and its derivatives at (y, parameter).
    state : ndarray, shape (n,)
        A guess.
    parameter : float
    direction : float
        Has the sign of the tangent's last component.
    tolerance : float
        For the largest component of F in magnitude.

    Returns
    -------
    Point or None
        None if Newton's method does not converge, or at a fold.
    """
    root = find_root(lambda y: function(y, parameter), state, tolerance)
    if root.outcome != "converged":
        return None
    along = np.zeros(len(state) + 1)
    along[-1] = np.copysign(1.0, direction)
    tangent = _tangent(root.linear, along)
    if tangent is None:
        return None
    return Point(root.state, parameter, tangent, root.linear, root.iterations)


def step(function: Function, point: Point, length: float, tolerance: float) -> Point | None:
    """Return the point one step along the tangent, None if the corrector finds none near it.

    Parameters
    ----------
    function : callable
    point : Point
    length : float
    tolerance : float

    Returns
    -------
    Point or None
    """
    u = np.append(point.state, point.parameter) + length * point.tangent
    allowed = _STRAY * abs(length)
    for iteration in range(_ITERATIONS + 1):
        at = function(u[:-1], u[-1])
        if not np.isfinite(at.residual).all():
            return None
        if np.abs(at.residual).max() <= tolerance:
            tangent = _tangent(at, point.tangent)
            if tangent is None or tangent @ point.tangent < _BEND:
                return None
            return Point(u[:-1], float(u[-1]), tangent, at, iteration)
        correction = _solve(at, point.tangent, np.append(-at.residual, 0.0))
        if correction is None:
            return None
        allowed -= float(np.linalg.norm(correction))
        if allowed < 0:
            return None
        u = u + correction
    return None


def follow(function: Function, first: Point, steps: Steps) -> Iterator[Point]:
    """Yield the points of a branch after the first, until even the smallest step fails.

    Parameters
    ----------
    function : callable
    first : Point
    steps : Steps

    Yields
    ------
    Point
    """
    point, length = first, steps.first
    while length >= steps.smallest:
        new = step(function, point, length, steps.tolerance)
        if new is None:
            length *= _SHORTER
            continue
        yield new
        if new.iterations <= _EASY:
            length = min(_LONGER * length, steps.largest)
        point = new


def locate(
    function: Function,
    before: Point,
    after: Point,
    has_changed: Callable[[Point], bool],
    nearness: float,
    tolerance: float,
) -> tuple[Point, Point]:
    """Return the last point before a change and the first after it.

    Parameters
    ----------
    function : callable
    before, after : Point
        Neighbours on the branch; only the second has changed.
    has_changed : callable
        Whether a point between them has changed.
    nearness : float
        Distance between the two points returned.
    tolerance : float
        For the largest component of F in magnitude.

    Returns
    -------
    before, after : Point
        Farther apart than `nearness` if the corrector fails between them.
    """
    while True:
        chord = np.append(after.state, after.parameter) - np.append(before.state, before.parameter)
        length = before.tangent @ chord
        if length <= nearness:
            return before, after
        middle = step(function, before, length / 2, tolerance)
        if middle is None:
            return before, after
        before, after = (before, middle) if has_changed(middle) else (middle, after)


def _tangent(linear: Linear, along: Array) -> Array | None:
    """Return the unit tangent on the same side as `along`."""
    solution = _solve(linear, along, np.append(np.zeros(len(along) - 1), 1.0))
    if solution is not None:
        solution /= np.linalg.norm(solution)
    return solution


def _solve(linear: Linear, along: Array, right: Array) -> Array | None:
    """Solve the equations of F, bordered by one along the branch."""
    upper = np.column_stack([linear.by_state, linear.by_parameter])
    try:
        solution: Any = np.linalg.solve(np.vstack([upper, along]), right)
    except np.linalg.LinAlgError:
        return None
    return solution
