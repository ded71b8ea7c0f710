"""Figures of sensitivity indices: as bars, and along a dimension of an output."""

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite, nan
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.chosen_targets import wholes
from uq.assess.findings import Findings
from uq.assess.sensitivities import TargetIndices, methods, ranking, sensitivities, size
from uq.assess.targets import FORMS, split_name
from uq.errors import InputError
from uq.indices.index import BY_CORRELATION, IndexKind, Null
from uq.render.figures.figure import BARS, INK, LINES, SHADES, styled
from uq.render.figures.panel import (
    arrows,
    column,
    finish,
    heading,
    is_wide,
    logarithmic,
    roomy,
    title,
)
from uq.render.figures.words import (
    as_label,
    element_in_words,
    input_label,
    labelled,
    place_in_words,
)
from uq.result.result import AnyResult, Result
from uq.stats.estimate import Estimate
from uq.text.numbers import counted, threshold
from uq.text.units import unit_of


@styled
def index_bars(
    result: AnyResult,
    output: str,
    *,
    method: str | None = None,
    indices: TargetIndices | None = None,
    every: bool = False,
    axes: Axes | None = None,
) -> Figure:
    """Draw the sensitivity indices of one output as bars, with their 95 % intervals.

    Inputs with a negligible index are counted, not drawn.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        A name that `uq.sensitivity` returns.
    method : str, optional
        By default the first that the study asks for.
    indices : TargetIndices, optional
        The indices, if already computed.
    every : bool
        Draw all inputs.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When there is no such output, the name is ambiguous, or there are no indices.
    """
    result = Result.of(result)
    shown = indices or _only(result, output, method)
    name, of_kinds = shown.name, shown.kinds().items()
    kinds = {kind: values for kind, values in of_kinds if kind.unit != "p-value"}
    last = list(kinds.values())[-1]
    parameters = sorted(last, key=lambda parameter: size(last[parameter]))
    if not every:
        parameters = _that_matter(parameters, kinds, shown.indices.nulls)
    others = [name for name in last if name not in parameters]
    labels = [
        input_label(result.dataset[parameter], width=30)
        + f"\n({BY_CORRELATION})" * (parameter in shown.indices.by_correlation)
        for parameter in parameters
    ]
    lines = np.array([max(1.3 * (1 + label.count("\n")), len(kinds)) for label in labels])
    description = as_label(subject(result, name), width=56)
    (panel,) = column(axes, 0.8 + 0.13 * (lines.sum() + description.count("\n")))
    middle = np.cumsum(lines) - lines / 2
    thickness, ends = 0.8 * lines.min() / len(kinds), []
    for i, (kind, values) in enumerate(kinds.items()):
        y = middle + thickness * (len(kinds) / 2 - i - 0.5)
        value, low, high = np.array([values[parameter].numbers for parameter in parameters]).T
        panel.barh(y, value, thickness, color=BARS[i % len(BARS)], label=kind.words)
        panel.hlines(y, low, high, color=INK, lw=0.8)
        ends.append((y, low, high))
    for kind, null in shown.indices.nulls.items():
        colour = BARS[list(kinds).index(kind) % len(BARS)] if len(kinds) > 1 else INK
        single = f"{100 * (1 - null.exceeded):g} % limit for an input without effect"
        largest = "95 % limit for the largest of them"
        limits = {single: null.limit, largest: null.largest}
        if null.largest == null.limit:
            limits = {f"{single}, or several": null.limit}
        for line, (label, limit) in zip(("--", ":"), limits.items(), strict=False):
            if np.isfinite(limit):
                named = "_" * (label in panel.get_legend_handles_labels()[1])  # each once
                panel.axvline(limit, color=colour, ls=line, lw=0.8, label=named + label)
    panel.axvline(0, color=INK, lw=0.6)
    shares = all(kind.unit != "output" for kind in kinds)
    if shares:
        panel.set_xlim(range_of_indices(panel.get_xlim()))
    for y, low, high in ends:
        arrows(panel, y, low, high, "x", color=INK)
    panel.set_yticks(middle, labels)
    panel.set_ylim(0, lines.sum())
    roomy(panel, ticks=3)  # the labels occupy most of the width
    has_intervals = any(
        np.isfinite(index.low) for values in kinds.values() for index in values.values()
    )
    form, *_ = split_name(name)
    unit = f"Effect on the {FORMS[form]}" if form in FORMS else "Effect [unit of the output]"
    is_alone = len(kinds) == 1 and not shown.indices.nulls
    of_kind = f": {next(iter(kinds)).words}" if is_alone else ""
    axis = f"Sensitivity index{of_kind}" if shares else unit
    rest = ""
    if others:
        most = max(abs(size(values[name])) for values in kinds.values() for name in others)
        rest = f"\n{counted(len(others), 'other input')}: at most {most:.2g}"
    panel.set_xlabel(axis + has_intervals * ",\nwith 95 % interval" + rest)
    if is_alone and shares:
        panel.containers[0].set_label("_")
    heading(panel, description)
    return finish(panel)


def _that_matter(
    parameters: list[str],
    kinds: Mapping[IndexKind, Mapping[str, Estimate]],
    nulls: Mapping[IndexKind, Null],
) -> list[str]:
    """Return the inputs whose indices are not negligible, the largest last; at least a few."""
    limits = {}
    for kind, values in kinds.items():
        largest = max((abs(size(index)) for index in values.values()), default=0.0)
        null = nulls[kind].largest if kind in nulls else nan
        limits[kind] = max(_NEGLIGIBLE * largest, null if isfinite(null) else 0.0)

    def matters(kind: IndexKind, index: Estimate) -> bool:
        if kind.unit == "output":  # an effect may be negative
            return abs(size(index)) > limits[kind]
        return size(index) > limits[kind] and not index.low <= 0

    matter = [
        name
        for name in parameters
        if any(matters(kind, values[name]) for kind, values in kinds.items())
    ]
    return (matter if len(matter) >= _FEWEST_BARS else parameters[-_FEWEST_BARS:])[-_MOST_BARS:]


def range_of_indices(ends: tuple[float, float]) -> tuple[float, float]:
    """Return the axis range of indices; distant interval ends do not compress the bars."""
    return max(ends[0], -0.25), min(ends[1], 1.25)


def _only(result: Result, output: str, method: str | None) -> TargetIndices:
    """Return the indices of the target with a name, which must be unique."""
    targets = sensitivities(result, method, output).targets
    if len(targets) > 1:
        raise InputError(f"'{output}' is ambiguous; name one of: {', '.join(targets)}")
    ((name, target),) = targets.items()
    if target.refused:
        raise InputError(f"{name}: {target.refused}")
    return target


def subject(result: Result, name: str) -> str:
    """Return the description of a target of `uq.assess.sensitivities`."""
    form, inside, at = split_name(name)
    category, _, label = inside.rpartition("=")
    words = output_of(result, name)
    if result.is_category(category.partition("[")[0]):
        return f"whether the {words.removeprefix('the ')}{',' * ('[' in category)} is {label}"
    element, *_ = result.named_elements(inside)
    if at:
        asked = result.analysis.thresholds.get(element.output, ())
        at = threshold(
            next((limit for limit in asked if repr(limit) == at), float(at)), element.units
        )
        side = "below" if "<" in name else "above"
        size = "magnitude of the " * element.is_angle
        noun = f"{size}{words.removeprefix('the ')}{',' * (',' in words)}"
        words = f"whether the {noun} is {side} {at}"
    elif form:
        words = f"{FORMS[form]} of the {words.removeprefix('the ')}"
    return words


def output_of(result: Result, name: str) -> str:
    """Return the description of a target's output, with the coordinates of its element."""
    _, inside, _ = split_name(name)
    category = inside.rpartition("=")[0]
    output, _, place = category.partition("[")
    if result.is_category(output):
        return ", ".join(
            filter(None, (result.dataset[output].attrs["long_name"], place.removesuffix("]")))
        )
    element, *others = result.named_elements(inside)
    if others:
        return f"{element.meaning}, all {1 + len(others)} elements together"
    return element_in_words(result, element)


FEWEST = 3
"""Minimum number of coordinates of a curve."""

_MOST_INPUTS = 4
_FEWEST_BARS, _MOST_BARS = 4, 8
_NEGLIGIBLE = 0.04  # relative to the largest index


def dimension_of(result: Result, output: str) -> str | None:
    """Return the dimension along which indices of an output are drawn; None if there is none.

    Of the dimensions with at least three numeric coordinates, the one with the most is chosen.
    """
    dims = [dim for dim in result.outputs[output].dims if result.dataset[dim].dtype.kind in "iuf"]
    longest = max(dims, key=lambda dim: result.dataset.sizes[dim], default=None)
    return longest if longest is not None and result.dataset.sizes[longest] >= FEWEST else None


@styled
def index_curves(
    result: AnyResult,
    output: str,
    *,
    method: str | None = None,
    findings: Findings | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw the indices of an output along a numeric dimension such as depth, with 95 % bands.

    The legend gives the index of all elements together, the four largest first. Each coordinate
    of the other dimensions has its own panel.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        An output with a dimension of three or more numbers.
    method : str, optional
        A variance-based method; by default the first that the study asks for.
    findings : Findings, optional
        Findings of the result, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The bands are pointwise.

    Raises
    ------
    InputError
        When there is no such output or dimension, or there are no indices of all elements.
    """
    result = Result.of(result)
    findings = findings or Findings(result)
    method = method or methods(result)[0]
    elements = result.first_rows.named_elements(output)
    along = dimension_of(result, elements[0].output)
    if along is None or len(elements) < FEWEST:
        raise InputError(f"'{output}' has no dimension of {FEWEST} or more numbers")
    whole = findings.indices(method, next(wholes(elements)).name)
    if whole.refused:
        raise InputError(f"{whole.name}: {whole.refused}")
    kind, of_all = list(whole.kinds().items())[-1]
    leading = [name for name in ranking({kind: of_all})[:_MOST_INPUTS] if size(of_all[name]) > 0]
    form = split_name(whole.name)[0]
    panels: dict[str, list[tuple[float, TargetIndices]]] = {}
    for element in elements:
        others = {dim: at for dim, at in element.place.items() if dim != along}
        place = place_in_words(result, replace(element, place=others))
        name = f"{form}({element.name})" if form else element.name
        target_indices = findings.indices(method, name)
        panels.setdefault(place, []).append((float(element.place[along]), target_indices))
    unit = unit_of(
        result.dataset[along].attrs.get("units", "1"), float(np.abs(result.dataset[along]).max())
    )
    bands = ", with 95 % bands" if any(index.has_interval for index in of_all.values()) else ""
    drawn = column(axes, 0.6 + 1.5 * len(panels), len(panels))
    for panel, (place, points) in zip(drawn, panels.items(), strict=True):
        at = np.array([where for where, _ in points]) / unit.size
        for i, name in enumerate(leading):
            numbers = [
                target_indices.kinds()[kind][name].numbers
                if not target_indices.refused
                else (np.nan,) * 3
                for _, target_indices in points
            ]
            value, low, high = np.array(numbers).T
            style: Any = {"color": SHADES[i], "ls": LINES[i]}
            called = labelled(result.dataset[name], width=44)
            words = f"{called}: {kind.text(of_all[name].value)} all together"
            panel.plot(at, value, marker=".", ms=4, label=words, **style)
            panel.fill_between(at, low, high, color=SHADES[i], alpha=0.25, lw=0)
        panel.set_ylim(range_of_indices(panel.get_ylim()))
        title(
            panel, as_label(f"{kind.words}{bands}"), place, quantity=as_label(kind.words, width=24)
        )
    (logarithmic if is_wide(at) else roomy)(drawn[-1])
    drawn[-1].set_xlabel(labelled(result.dataset[along], unit.name))
    meaning = elements[0].meaning
    described = f"{FORMS[form]} of the {meaning.removeprefix('the ')}" if form else meaning
    heading(drawn[0], as_label(described, width=48))
    return finish(drawn[-1])
