"""Laws truncated to the bounds of their parameter: validity, quantiles, probabilities, density."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from uq.contract import Floats, Parameter
from uq.sampling.input_faults import InputFault
from uq.sampling.law import Law
from uq.sampling.listed_values import Listed
from uq.sampling.named_values import bounds_of
from uq.sampling.scipy_laws import Normal, TruncatedNormal

OUTSIDE_AT_MOST = 1e-6
"""Largest probability of a law outside the bounds of its parameter."""

TOO_EXTREME = "these numbers are too extreme to compute with; use others"

_LEAST_KEPT = 1e-290
"""Smallest probability of a truncation interval; below it denormal numbers would be needed."""


def ppf_within(law: Law, u: Floats, bounds: tuple[float, float]) -> Floats:
    """Return quantiles of a law truncated to bounds.

    The lower half uses the distribution function and the upper half the survival function, so that
    both tails keep their relative accuracy.

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
    return _quantiles(_condition(law, bounds), u)


def ppf_between(law: Law, u: Floats, low: Floats, high: Floats) -> Floats:
    """Return quantiles of a law truncated to limits that differ between rows.

    Parameters
    ----------
    law : Law
    u, low, high : ndarray, shape (n,)
        As in `ppf_within`.

    Returns
    -------
    ndarray, shape (n,)
    """
    return _quantiles(_shares(law, *_tightened(law, low, high)), u)


def cdf_within(law: Law, x: Floats, bounds: tuple[float, float]) -> Floats:
    """Return the distribution function P(X <= x) of a law truncated to bounds.

    Parameters
    ----------
    law : Law
    x : ndarray, shape (n,)
    bounds : tuple of float

    Returns
    -------
    ndarray, shape (n,)
    """
    return _probabilities(_condition(law, bounds), x)


def cdf_between(law: Law, x: Floats, low: Floats, high: Floats) -> Floats:
    """Return the distribution function P(X <= x) of a law truncated to limits of each row.

    Parameters
    ----------
    law : Law
    x, low, high : ndarray, shape (n,)
        As in `ppf_between`.

    Returns
    -------
    ndarray, shape (n,)
    """
    return _probabilities(_shares(law, *_tightened(law, low, high)), x)


def cell_of(law: Law, u: Floats, bounds: tuple[float, float]) -> tuple[Floats, Floats]:
    """Return the subinterval of the unit interval that a discrete law maps to the same value.

    Parameters
    ----------
    law : Law
    u : ndarray, shape (n,)
    bounds : tuple of float
        As in `ppf_within`.

    Returns
    -------
    below, up_to : ndarray, shape (n,)
        P(X < x) and P(X <= x) for the value x of each u.
    """
    x = ppf_within(law, u, bounds)
    below, up_to = (cdf_within(law, end, bounds) for end in (np.nextafter(x, -np.inf), x))
    return np.minimum(below, u), np.maximum(up_to, u)


def log_density_between(law: Law, x: Floats, low: Any, high: Any) -> Floats:
    """Return the log density of a law truncated to limits; -inf outside.

    Parameters
    ----------
    law : Law
    x : ndarray, shape (n,)
    low, high : float or ndarray, shape (n,)
        Both ends included.

    Returns
    -------
    ndarray, shape (n,)
        For a discrete law, the logarithm of the probability of each value.
    """
    to = _shares(law, *_tightened(law, low, high))
    with np.errstate(divide="ignore"):
        if law.discrete:
            density = np.log(to.parent.cdf(x) - to.parent.cdf(np.nextafter(x, -np.inf)))
        else:
            density = to.parent.logpdf(x)
        kept = np.maximum(to.not_above - to.below, to.not_below - to.above)
        return np.where((to.low <= x) & (x <= to.high), density - np.log(kept), -np.inf)


def factor_ends(other: Any, bounds: tuple[float, float]) -> tuple[Any, Any]:
    """Return the limits of a factor that keep its product with another parameter within bounds."""
    ends = bounds[0] / other, bounds[1] / other
    return np.minimum(*ends), np.maximum(*ends)


def factor_of(law: Law, product: Floats, other: Any) -> Floats:
    """Return a factor from its product with another parameter; exact for listed values."""
    ratio = product / other
    return law.nearest(ratio) if isinstance(law, Listed) else ratio


def support(law: Law, bounds: tuple[float, float]) -> tuple[float, float]:
    """Return the support: the smallest and the largest possible value."""
    ends = ppf_within(law, np.array([2.0**-54, 1.0 - 2.0**-53]), bounds)
    return float(ends[0]), float(ends[1])


class _Condition(NamedTuple):
    """Truncation interval of a law, and the probability of its parent below and above each end.

    Each field is a number, or an array with one number per row.
    """

    parent: Any
    low: Any
    high: Any
    below: Any
    not_below: Any
    not_above: Any
    above: Any


def _quantiles(to: _Condition, u: Floats) -> Floats:
    x = np.empty_like(u)
    with np.errstate(all="ignore"):
        p = to.below + u * (to.not_above - to.below)
        q = to.above + (1.0 - u) * (to.not_below - to.above)
        lower_half = p <= 0.5
        upper_half = ~lower_half
        x[lower_half] = to.parent.ppf(p[lower_half])
        x[upper_half] = to.parent.isf(q[upper_half])
    return np.clip(x, to.low, to.high)


def _probabilities(to: _Condition, x: Floats) -> Floats:
    if np.all(to.below < 0.5):
        share = (to.parent.cdf(x) - to.below) / (to.not_above - to.below)
    else:  # in the upper tail only the survival function is accurate
        share = (to.not_below - to.parent.sf(x)) / (to.not_below - to.above)
    return np.clip(np.where(x < to.low, 0.0, share), 0.0, 1.0)


@lru_cache(maxsize=1024)  # creating a scipy distribution takes longer than a thousand quantiles
def _condition(law: Law, bounds: tuple[float, float]) -> _Condition:
    low, high = map(float, _tightened(law, *bounds))
    if isinstance(law, Listed):  # rounded quantiles must coincide with listed values
        low, high = law.between(low, high) or (low, high)
    condition = _shares(law, low, high)
    return _Condition(condition.parent, *map(float, condition[1:]))


def _tightened(law: Law, low: Any, high: Any) -> tuple[Any, Any]:
    """Return the intersection of the given limits and the law's own truncation."""
    lower, upper = law.ends
    return np.maximum(low, lower), np.minimum(high, upper)


def _shares(law: Law, low: Any, high: Any) -> _Condition:
    parent = law.frozen()
    # The lower end is included, which matters if it has a positive probability.
    end = np.nextafter(low, -np.inf) if law.discrete else low
    with np.errstate(all="ignore"):
        shares = parent.cdf(end), parent.sf(end), parent.cdf(high), parent.sf(high)
    return _Condition(parent, low, high, *shares)


def law_problem(law: Law, parameter: Parameter) -> InputFault | None:
    """Return the fault of a law that is invalid for a parameter; None if it is valid.

    Parameters
    ----------
    law : Law
    parameter : Parameter

    Returns
    -------
    InputFault or None
        Its path is the invalid argument, or empty.
    """
    if law.unit and law.unit != parameter.unit and law.times is None:
        of = f"of a parameter in {law.unit}, not in {parameter.unit}"
        return InputFault(("distribution",), f"is {of}", vars(law)["distribution"])
    low, high = parameter.bounds
    bounds = f"the parameter's bounds, {bounds_of(parameter)}"
    cut = law.truncate is not None or isinstance(law, TruncatedNormal)
    for argument in ("mean", "median", "mode"):
        value = getattr(law, argument, None)
        if value is not None and not low <= value <= high and not cut:
            return InputFault((argument,), f"must be within {bounds}", value)
    if isinstance(law, Listed) and law.between(*map(float, _tightened(law, low, high))) is None:
        return InputFault((), f"has no value within {bounds}")
    outside = outside_share(law, low, high)
    if outside is None:
        return InputFault((), TOO_EXTREME)
    if outside <= OUTSIDE_AT_MOST:
        return None
    share = f"{outside:.2g} of its probability outside {bounds} (allowed: {OUTSIDE_AT_MOST:g})"
    return InputFault((), f"has {share}; {_remedy(law)}")


def outside_share(law: Law, low: Any, high: Any) -> Any:
    """Return the probability of a law, after its own truncation, outside given limits.

    Parameters
    ----------
    law : Law
    low, high : float or ndarray, shape (n,)

    Returns
    -------
    float, ndarray of shape (n,), or None
        None if it cannot be computed.
    """
    lower, upper = law.ends
    truncated = _shares(law, lower, upper)
    ends = _shares(law, *_tightened(law, low, high))
    with np.errstate(all="ignore"):
        kept = np.maximum(
            truncated.not_above - truncated.below, truncated.not_below - truncated.above
        )
        outside = ((ends.below - truncated.below) + (ends.above - truncated.above)) / kept
        extreme = (
            min(truncated.parent.sf(lower), truncated.parent.cdf(upper)) < _LEAST_KEPT
            or not kept > 0
        )
    return None if extreme or np.isnan(outside).any() else np.minimum(outside, 1.0)


def _remedy(law: Law) -> str:
    if law.truncate is not None:
        return f"truncate = [{law.truncate[0]!r}, {law.truncate[1]!r}] must be within them"
    lower, upper = (getattr(law, end, None) for end in ("lower", "upper"))
    if lower is not None and upper is not None and not law.discrete:
        return f"lower = {lower!r} and upper = {upper!r} must be within them"
    if isinstance(law, Normal):
        return "use a truncated-normal with lower and upper within them, or other numbers"
    return "add truncate = [lower, upper] within them, or use other numbers"
