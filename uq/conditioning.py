"""A law inside the bounds of its parameter: does it fit, and its quantiles given that it does."""

from functools import lru_cache
from math import isnan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Parameter
from uq.distributions import Beta, Law, LogUniform, Triangular, TruncatedNormal, Uniform

OUTSIDE_AT_MOST = 1e-6
"""Probability a law may have outside its parameter's bounds."""

_LEAST_KEPT = 1e-290
"""A truncation that keeps less of its parent reaches into denormal numbers."""


def ppf_within(
    law: Law, u: NDArray[np.float64], bounds: tuple[float, float]
) -> NDArray[np.float64]:
    """Map the unit interval to a law conditioned on lying within bounds.

    The lower half goes through the distribution function, the upper half through the survival
    function, so that both tails keep their relative accuracy.

    Parameters
    ----------
    law : Law
    u : ndarray, shape (n,)
        Contiguous, in (0, 1); each value is mapped by itself.
    bounds : tuple of float
        Both ends included, in the law's unit.

    Returns
    -------
    ndarray, shape (n,)
        Never outside the bounds.
    """
    to = _condition(law, bounds)
    x = np.empty_like(u)
    with np.errstate(all="ignore"):
        p = to.below + u * (to.not_above - to.below)
        lower_half = p <= 0.5
        upper_half = ~lower_half
        x[lower_half] = to.parent.ppf(p[lower_half])
        q = to.above + (1.0 - u[upper_half]) * (to.not_below - to.above)
        x[upper_half] = to.parent.isf(q)
    return np.clip(x, to.low, to.high)


class _Condition(NamedTuple):
    """Where a law may lie, and how much of its parent lies below and above either end."""

    parent: Any
    low: float
    high: float
    below: float
    not_below: float
    not_above: float
    above: float


@lru_cache(maxsize=1024)  # making a scipy distribution costs more than a thousand quantiles
def _condition(law: Law, bounds: tuple[float, float]) -> _Condition:
    parent, lower, upper = law.parent()
    low, high = max(bounds[0], lower), min(bounds[1], upper)
    with np.errstate(all="ignore"):
        shares = parent.cdf(low), parent.sf(low), parent.cdf(high), parent.sf(high)
    return _Condition(parent, low, high, *map(float, shares))


class LawProblem(NamedTuple):
    """Why a law does not suit a parameter.

    Attributes
    ----------
    text : str
        What is wrong and what to do.
    argument : tuple of str
        The guilty argument, if it is one.
    value : float or None
        Its value.
    """

    text: str
    argument: tuple[str, ...] = ()
    value: float | None = None


def law_problem(law: Law, parameter: Parameter) -> LawProblem | None:
    """Say why a law does not suit a parameter, or return None.

    Parameters
    ----------
    law : Law
    parameter : Parameter

    Returns
    -------
    LawProblem or None
    """
    low, high = parameter.bounds
    bounds = f"the parameter's bounds, {low!r} to {high!r} [{parameter.unit}]"
    for argument in ("mean", "median", "mode"):
        value = getattr(law, argument, None)
        if value is not None and not low <= value <= high and not isinstance(law, TruncatedNormal):
            return LawProblem(f"must lie within {bounds}", (argument,), value)
    with np.errstate(all="ignore"):
        distribution = law.frozen()
        outside = float(distribution.cdf(low) + distribution.sf(high))
        parent, lower, upper = law.parent()
        kept = min(parent.sf(lower), parent.cdf(upper))
    if isnan(outside) or kept < _LEAST_KEPT:
        return LawProblem("these numbers are too extreme to compute with; use others")
    if outside <= OUTSIDE_AT_MOST:
        return None
    if isinstance(law, Uniform | LogUniform | TruncatedNormal | Triangular | Beta):
        remedy = f"lower = {law.lower!r} and upper = {law.upper!r} must lie within them"
    else:
        remedy = "use a truncated-normal with lower and upper within them, or other numbers"
    return LawProblem(
        f"has {outside:.2g} of its probability outside {bounds}"
        f" (allowed: {OUTSIDE_AT_MOST:g}); {remedy}"
    )
