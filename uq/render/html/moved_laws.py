"""Arguments of a law with another scatter or another middle: the stops of the sliders of a page."""

from collections.abc import Callable, Iterator, Mapping
from math import ceil, exp, floor, log, log10, pi, sqrt
from typing import Any

from uq.sampling.law import Law

Arguments = Mapping[str, Any]

WIDTHS = (0.5, 0.7, 0.85, 1.15, 1.3)
"""Factors of the scatter; a law with ends can only be narrowed, as no rows are beyond them."""

SHIFTS = (-1.0, -0.5, 0.5, 1.0)
"""Shifts of the middle, in standard deviations."""

ENDS = ((0.5, -1.0), (0.7, -1.0), (0.7, 1.0), (0.5, 1.0))
"""Factor and side: the lower or upper part of a law with ends."""

STOPS = len(WIDTHS) + len(SHIFTS)
"""Maximum number of stops of an input."""

_GUMBEL_SD = pi / sqrt(6)  # standard deviation of the logarithm of a unit exponential


def widths(law: Law) -> Iterator[tuple[float, Arguments]]:
    """Yield each factor of the scatter, with the changed arguments of the law."""
    if _distribution(law) in _SCALE_ONLY:
        return
    for factor in WIDTHS:
        if factor < 1 or not has_ends(law):
            yield factor, _changed(law, factor, 0.0)


def shifts(law: Law) -> Iterator[tuple[float, Arguments]]:
    """Yield each shift of the middle, with the changed arguments of the law."""
    if has_ends(law):
        for factor, side in ENDS:
            yield side * (1 - factor), _changed(law, factor, side)
    else:
        for shift in SHIFTS:
            yield shift, _changed(law, 1.0, shift)


def has_ends(law: Law) -> bool:
    """Return whether a law has bounded support, so that reweighting can only narrow it."""
    return _distribution(law) in _WITH_ENDS


def can_move(law: Law) -> bool:
    """Return whether the scatter or the middle of a law can be changed."""
    return _distribution(law) in _MOVED


def _distribution(law: Law) -> str:
    return str(vars(law)["distribution"])


def _changed(law: Law, factor: float, shift: float) -> Arguments:
    """Return the arguments that differ from the law's, rounded to six digits of the change."""
    moved = _MOVED[_distribution(law)](law, factor, shift)
    changed = {}
    for name, value in moved.items():
        before = getattr(law, name)
        if isinstance(value, list):
            value = [_rounded(*pair) for pair in zip(value, before, strict=True)]
            before = list(before)
        elif isinstance(value, float):
            value = _rounded(value, before)
        if value != before:
            changed[name] = value
    return changed


def _rounded(value: float, before: float) -> float:
    if value in (before, 0.0):
        return value
    places = floor(log10(abs(value))) - floor(log10(abs(value - before))) + 6
    return float(f"{value:.{min(max(places, 6), 17)}g}")


def _normal(law: Any, factor: float, shift: float) -> Arguments:
    return {"mean": law.mean + shift * law.sd, "sd": factor * law.sd}


def _lognormal(law: Any, factor: float, shift: float) -> Arguments:
    if law.cv is None:
        return {"median": law.median * exp(shift * law.sigma), "sigma": factor * law.sigma}
    sigma = sqrt(log(1 + law.cv**2))
    return {"mean": law.mean * exp(shift * sigma), "cv": factor * law.cv}


def _wear_coefficient(law: Any, factor: float, shift: float) -> Arguments:
    return {"share": law.share * exp(shift * law.sigma), "sigma": factor * law.sigma}


def _weibull(law: Any, factor: float, shift: float) -> Arguments:
    scale = law.scale * exp(shift * _GUMBEL_SD / law.shape)
    return {"shape": law.shape / factor, "scale": scale}


def _gamma(law: Any, factor: float, shift: float) -> Arguments:
    scale = law.scale * factor**2 * exp(shift / sqrt(law.shape))
    return {"shape": law.shape / factor**2, "scale": scale}


def _gumbel(law: Any, factor: float, shift: float) -> Arguments:
    return {"mode": law.mode + shift * _GUMBEL_SD * law.scale, "scale": factor * law.scale}


def _exponential(law: Any, factor: float, shift: float) -> Arguments:
    return {"mean": law.mean * exp(shift)}


def _part(lower: float, upper: float, factor: float, side: float) -> tuple[float, float]:
    """Return the ends of a subrange at the middle, lower end or upper end of a range."""
    room = (1 - factor) * (upper - lower)
    if side < 0:
        return lower, upper - room
    return (lower + room, upper) if side > 0 else (lower + room / 2, upper - room / 2)


def _bounded(law: Any, factor: float, side: float) -> Arguments:
    lower, upper = _part(law.lower, law.upper, factor, side)
    mode = getattr(law, "mode", None)
    more = {} if mode is None else {"mode": lower + factor * (mode - law.lower)}
    return {"lower": lower, "upper": upper} | more


def _loguniform(law: Any, factor: float, side: float) -> Arguments:
    ends = log(law.lower), log(law.upper)
    lower, upper = _part(*ends, factor, side)
    return {
        "lower": law.lower if lower == ends[0] else exp(lower),
        "upper": law.upper if upper == ends[1] else exp(upper),
    }


def _histogram(law: Any, factor: float, side: float) -> Arguments:
    first, last = law.edges[0], law.edges[-1]
    lower, _ = _part(first, last, factor, side)
    return {"edges": [lower + factor * (edge - first) for edge in law.edges]}


def _integer_range(law: Any, factor: float, side: float) -> Arguments:
    lower, upper = _part(law.lower, law.upper, factor, side)
    least = min(ceil(lower - 1e-9), law.upper - 1)
    return {"lower": least, "upper": max(floor(upper + 1e-9), least + 1)}


_SCALE_ONLY = ("exponential",)
_WITH_ENDS: Mapping[str, Callable[[Any, float, float], Arguments]] = {
    **dict.fromkeys(("uniform", "triangular", "pert", "beta"), _bounded),
    "loguniform": _loguniform,
    "histogram": _histogram,
    "integer-range": _integer_range,
}
_MOVED: Mapping[str, Callable[[Any, float, float], Arguments]] = {
    **dict.fromkeys(("normal", "truncated-normal"), _normal),
    "lognormal": _lognormal,
    "wear-coefficient": _wear_coefficient,
    "weibull": _weibull,
    "gamma": _gamma,
    "gumbel": _gumbel,
    "exponential": _exponential,
    **_WITH_ENDS,
}
"""Distribution -> function for the arguments with scaled scatter and shifted middle."""
