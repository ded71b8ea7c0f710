"""What a page needs to weight its rows: the laws of inputs, and those of lives."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

import xarray as xr

from uq.designs.registry import DESIGNS
from uq.drawing.words import in_words
from uq.literals import plain
from uq.population.scale_laws import IndependentScale
from uq.population.scaling import Inputs, inputs_of, integrated
from uq.population.sums import LogTerm, Sum
from uq.report.encoding import encoded
from uq.rows.element import Element

SIMPLE = ("normal", "truncated-normal", "lognormal", "uniform", "loguniform", "triangular")
"""Laws that the scripts know (``live/laws.js``)."""


def tolerances(rows: xr.Dataset, elements: Sequence[Element]) -> dict[str, Any] | None:
    """Return the laws of inputs that have sliders, and the laws of lives.

    Parameters
    ----------
    rows : xarray.Dataset
        The rows inside the page.
    elements : sequence of Element
        Of these rows.

    Returns
    -------
    dict or None
        None where no input has a slider.
    """
    if DESIGNS[rows.attrs["design"]].imported:
        return None
    inputs = inputs_of(rows)
    laws: list[Mapping[str, Any]] = []
    of, refused = {}, {}
    for element in elements:
        if not element.declared.scales or element.censored.any():
            continue
        law = integrated(rows, element.declared, inputs).law
        if law is None:
            continue
        if not isinstance(law, IndependentScale):
            refused[element.name] = "what scales this life depends on other inputs"
            continue
        same = [i for i, one in enumerate(laws) if one["inputs"] == list(law.inputs)]
        of[element.name] = same[0] if same else len(laws)
        if not same:
            laws.append(_life_law(law))
    tabulated = {name for law in laws if "table" in law for name in law["inputs"]}
    without = dict(_without(inputs, tabulated))
    sliders = [_slider(name, inputs) for name in inputs.laws if name not in without]
    if not sliders or len(refused) == len(elements):
        return None
    return {
        "inputs": sliders,
        "without": [[plain(in_words(rows[name])), why] for name, why in without.items()],
        "laws": laws,
        "of": of,
        "refused": refused,
    }


def _without(inputs: Inputs, tabulated: set[str]) -> Iterator[tuple[str, str]]:
    """Yield inputs that have no slider, and why."""
    leaders = {law.times for law in inputs.laws.values()} | set(inputs.tied.values())
    for name, law in inputs.laws.items():
        distribution: str = vars(law)["distribution"]
        if law.times is not None or name in leaders or name in inputs.correlated:
            yield name, "it is joined with other inputs"
        elif distribution not in SIMPLE:
            yield name, f"its law is {distribution}"
        elif name in tabulated:
            yield name, "it scales lives together with other inputs"


def _slider(name: str, inputs: Inputs) -> dict[str, Any]:
    law = inputs.laws[name]
    ignored = {"distribution", "source", "times", "level", "truncate"}
    return {
        "name": name,
        "distribution": vars(law)["distribution"],
        "args": law.model_dump(exclude=ignored, exclude_none=True),
        "truncate": law.truncate,
        "bounds": [end if isfinite(end) else None for end in inputs.bounds[name]],
    }


def _life_law(law: IndependentScale) -> Mapping[str, Any]:
    found: dict[str, Any] = {"inputs": list(law.inputs), "drawn": encoded(law.drawn, "<f8")}
    if isinstance(law.term, LogTerm):
        return found | {"exponent": law.term.exponent}
    assert isinstance(law.term, Sum)
    table = {"ends": law.term.ends.tolist(), "coefficients": law.term.coefficients.tolist()}
    return found | {"table": table}
