"""Damped Newton's method for F(y) = 0 with a given Jacobian and steps of bounded length."""

from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_HALVINGS = 8


class Linear(NamedTuple):
    """A function F(y, parameter) and its derivatives at one point.

    Attributes
    ----------
    residual : ndarray, shape (n,)
        F.
    by_state : ndarray, shape (n, n)
        dF/dy.
    by_parameter : ndarray, shape (n,)
        dF/dparameter; not used if the parameter is fixed.
    about : Any
        Anything else found in evaluating F.
    """

    residual: Array
    by_state: Array
    by_parameter: Array
    about: Any = None


class Root(NamedTuple):
    """Where Newton's method ended.

    Attributes
    ----------
    state : ndarray, shape (n,)
    linear : Linear
        F at `state`.
    residual : float
        Largest component of F in magnitude.
    iterations : int
    outcome : str
        ``converged``; ``stalled`` if no shorter step reduced the residual or the iterations ran
        out; ``singular`` if the Jacobian was.
    """

    state: Array
    linear: Linear
    residual: float
    iterations: int
    outcome: Literal["converged", "stalled", "singular"]


def find_root(
    function: Callable[[Array], Linear],
    start: Array,
    tolerance: float,
    longest: float = np.inf,
    iterations: int = 20,
) -> Root:
    """Solve F(y) = 0 from a start.

    Parameters
    ----------
    function : callable
        Returns F and dF/dy at y; values that are not finite mean that y is out of bounds.
    start : ndarray, shape (n,)
    tolerance : float
        For the largest component of F in magnitude.
    longest : float
        Largest Euclidean length of a step.
    iterations : int
        Largest number.

    Returns
    -------
    Root
    """
    y, at = start, function(start)
    size = float(np.linalg.norm(at.residual))
    outcome: Literal["converged", "stalled", "singular"] = "stalled"
    done = 0
    while np.isfinite(size):
        if np.abs(at.residual).max() <= tolerance:
            outcome = "converged"
            break
        if done == iterations:
            break
        try:
            step = np.linalg.solve(at.by_state, -at.residual)
        except np.linalg.LinAlgError:
            outcome = "singular"
            break
        length = float(np.linalg.norm(step))
        step = step * min(1.0, longest / length)
        done += 1
        for halving in range(_HALVINGS):
            trial = function(y + step / 2**halving)
            trial_size = float(np.linalg.norm(trial.residual))
            if trial_size < size:
                y, at, size = y + step / 2**halving, trial, trial_size
                break
        else:
            break
    return Root(y, at, float(np.abs(at.residual).max()), done, outcome)
