"""Data by which a page weights its rows: laws of inputs, and how they scale lives."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import called
from uq.assess.densities import correlations
from uq.assess.row_inputs import Inputs, inputs_of
from uq.assess.scaling import given_others, scalers
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.law import Law
from uq.sampling.listed_values import IntegerRange
from uq.text.literals import plain
from uq.text.numbers import printed
from uq.text.symbols import readable

KNOWN = (
    *("normal", "truncated-normal", "lognormal", "uniform", "loguniform", "triangular", "pert"),
    *("beta", "weibull", "gamma", "gumbel", "exponential", "histogram", "integer-range"),
)
"""Laws that the scripts know (``live/laws.js``)."""

LISTED = "its values are listed and have neither width nor place"


def tolerances(rows: Result, elements: Sequence[Element]) -> dict[str, Any] | None:
    """Return the laws of inputs, which of them have sliders, and what scales lives.

    Parameters
    ----------
    rows : Result
        The rows inside the page.
    elements : sequence of Element
        Of these rows.

    Returns
    -------
    dict or None
        None where no input has a slider.
    """
    if rows.design.imported:
        return None
    inputs = inputs_of(rows)
    without = {name: why for name in inputs.laws if (why := _why_without(name, inputs))}
    scaled = {
        one.name: scalers(inputs, one.declared)
        for one in elements
        if one.declared.scales and not one.censored.any()
    }
    refused = {name: why for name, one in scaled.items() if (why := _why_refused(one, inputs))}
    integrated = {name: one for name, one in scaled.items() if one and name not in refused}
    known = {name: law for name, law in inputs.laws.items() if _kind(law) in KNOWN}
    if len(without) == len(inputs.laws) or len(refused) == len(elements):
        return None
    return {
        "laws": [_plain_law(name, inputs) for name in known],
        "sliders": [name for name in known if name not in without],
        "without": [[plain(readable(called(name))), why] for name, why in without.items()],
        "correlated": list(_copulas(inputs)),
        "lives": {name: _scales(one, inputs) for name, one in integrated.items()},
        "refused": refused,
    }


def promised(promise: ToleranceBound | None) -> Iterator[dict[str, Any]]:
    """Yield bounds that are promised, and that a quantile of weighted rows could replace."""
    if promise is None:
        return
    for p in (round(1 - promise.coverage, 12), promise.coverage):
        if (one := promise.of_quantile(p)) is not None:
            upper = isfinite(one.upper)
            yield {
                "probability": p,
                "upper": upper,
                "bound": one.upper if upper else one.lower,
                "opening": plain(printed(one.opening())),
                "then": plain(printed(one.end_of_quantile)),
            }


def _kind(law: Law) -> str:
    return str(vars(law)["distribution"])


def _why_without(name: str, inputs: Inputs) -> str:
    """Return why an input has no slider, or ""."""
    law = inputs.laws[name]
    if law.discrete and not isinstance(law, IntegerRange):
        return LISTED
    if _kind(law) not in KNOWN:
        return f"this page cannot compute with its law, {_kind(law)}"
    if isinstance(law, IntegerRange) and law.upper - law.lower < 2:
        return "it has two values only"
    if 0 in getattr(law, "counts", ()):
        return "its histogram has empty bins, in which there are no rows"
    if name in inputs.correlated:
        for other in inputs.correlated:
            if inputs.laws[other].discrete:
                return f"it depends on listed values of {other}"
            if _kind(inputs.laws[other]) not in KNOWN:
                return f"it depends on {other}, with whose law this page cannot compute"
    return ""


def _why_refused(exponents: Mapping[str, float], inputs: Inputs) -> str:
    """Return why the lives that these inputs scale have no answer, or ""."""
    for name in {*exponents, *inputs.correlated} if exponents else ():
        if _kind(inputs.laws[name]) not in KNOWN:
            return f"this page cannot compute with the law of {name}, {_kind(inputs.laws[name])}"
    return ""


def _plain_law(name: str, inputs: Inputs) -> dict[str, Any]:
    law = inputs.laws[name]
    ignored = {"distribution", "source", "times", "level", "truncate"}
    return {
        "name": name,
        "distribution": _kind(law),
        "args": law.model_dump(exclude=ignored, exclude_none=True, mode="json"),
        "pure": law.pure,
        "truncate": law.truncate,
        "times": law.times,
        "bounds": [end if isfinite(end) else None for end in inputs.bounds[name]],
    }


def _copulas(inputs: Inputs) -> Iterator[dict[str, Any]]:
    """Yield how inputs depend on each other, all of them and without each one."""
    for without in (None, *inputs.correlated) if inputs.correlated else ():
        names, matrix = correlations(inputs, () if without is None else (without,))
        excess = np.linalg.inv(matrix) - np.eye(len(names))
        yield {"without": without, "names": names, "excess": excess.tolist()}


def _scales(exponents: Mapping[str, float], inputs: Inputs) -> dict[str, Any]:
    """Return the inputs that scale a life: free ones, and those bound to others."""
    free, bound = [], []
    for name, exponent in exponents.items():
        one: dict[str, Any] = {"name": name, "exponent": exponent}
        if other := inputs.laws[name].times:
            bound.append(one | {"times": other, "deviation": 1.0})
        elif name in inputs.correlated:
            slopes, deviation = given_others(name, inputs)
            bound.append(one | {"slopes": list(slopes.items()), "deviation": deviation})
        else:
            free.append(one)
    return {"free": free, "bound": bound}
