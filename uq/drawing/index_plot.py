"""The figure of sensitivity indices."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from uq.drawing.figure import (
    COLOURS,
    legend,
    new_figure,
    place_in_words,
    roomy,
    sentence,
    styled,
    with_symbol,
)
from uq.errors import InputError
from uq.indices.ranked import size
from uq.indices.sensitivities import TargetIndices, sensitivities
from uq.indices.targets import FORMS, split_name
from uq.rows.elements import named_elements
from uq.rows.variables import is_category
from uq.wording import time_unit


def index_bars(ds: xr.Dataset, output: str, method: str | None = None) -> Figure:
    """Draw the sensitivity indices of one output as bars, with their 95 % intervals.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        One of the names that `uq.indices.sensitivities` returns.
    method : str, optional
        By default the first that the study asks for.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When there is no such output, it stands for several, or it has no indices.
    """
    found = sensitivities(ds, method, output).targets
    if len(found) > 1:
        raise InputError(f"'{output}' stands for several; name one of: {', '.join(found)}")
    ((name, one),) = found.items()
    if one.refused:
        raise InputError(f"{name}: {one.refused}")
    return bars(ds, one)


@styled
def bars(ds: xr.Dataset, found: TargetIndices) -> Figure:
    """Draw the indices of one target.

    Parameters
    ----------
    ds : xarray.Dataset
    found : TargetIndices
        Not refused.

    Returns
    -------
    matplotlib.figure.Figure
    """
    kinds, name = found.kinds(), found.target.name
    last = list(kinds.values())[-1]
    parameters = sorted(last, key=lambda parameter: size(last[parameter]))
    labels = [_named(ds[parameter]) for parameter in parameters]
    lines = np.array([max(1.3 * (1 + label.count("\n")), len(kinds)) for label in labels])
    figure, (axes,) = new_figure(0.8 + 0.13 * lines.sum(), entries=2)
    middle = np.cumsum(lines) - lines / 2
    thickness = 0.8 * lines.min() / len(kinds)
    for i, (kind, values) in enumerate(kinds.items()):
        y = middle + thickness * (len(kinds) / 2 - i - 0.5)
        drawn = [values[parameter] for parameter in parameters]
        table = np.array([(one.value, one.low, one.high) for one in drawn])
        value, ends = table[:, 0], table[:, 1:].T
        axes.barh(y, value, thickness, color=COLOURS[i], label=kind.words)
        axes.errorbar(value, y, xerr=abs(ends - value), fmt="none", ecolor="black", lw=0.8)
    for null in found.indices.nulls.values():
        label = "largest of inputs that play no part"
        axes.axvline(null.one, color="black", ls="--", lw=0.8, label=label)
        if np.isfinite(null.largest):
            label = "the largest of as many"
            axes.axvline(null.largest, color="black", ls=":", lw=0.8, label=label)
    axes.axvline(0, color="black", lw=0.6)
    # An index lies between 0 and 1; an interval far outside must not squeeze the bars.
    shares = all(kind.unit != "output" for kind in kinds)
    if shares:
        low, high = axes.get_xlim()
        axes.set_xlim(max(low, -0.25), min(high, 1.25))
    axes.set_yticks(middle, labels)
    axes.set_ylim(0, lines.sum())
    roomy(axes, ticks=3)  # the labels take most of the width
    known = any(np.isfinite(one.low) for values in kinds.values() for one in values.values())
    form, *_ = split_name(name)
    unit = f"Effect on the {FORMS[form]}" if form in FORMS else "Effect, in the unit of the output"
    axis = "Sensitivity index [1]" if shares else unit
    axes.set_xlabel(axis + known * ",\nwith 95 % interval")
    figure.suptitle(subject(ds, name), x=0.01, ha="left", fontsize=8)
    legend(axes)
    return figure


def _named(parameter: xr.DataArray) -> str:
    """Return the full name of a parameter; the symbol tells apart those of the same meaning."""
    return sentence(with_symbol(parameter), width=30)


def subject(ds: xr.Dataset, name: str) -> str:
    """Return in words what the indices of a name of `uq.indices.sensitivities` are about."""
    form, inside, threshold = split_name(name)
    category, _, label = inside.partition("=")
    if is_category(ds, category):
        return sentence(f"whether it is {label}: {ds[category].attrs['long_name']}", width=56)
    (element,) = named_elements(ds, inside)
    place = place_in_words(element, ds[element.output])
    words = element.meaning + (f", {place}" if place else "")
    if threshold:
        unit = time_unit(float(threshold))
        words = f"whether it ends before {float(threshold) / unit.seconds:g} {unit.name}: {words}"
    elif form:
        words = f"{FORMS[form]} of the {words.removeprefix('the ')}"
    return sentence(words, width=56)
