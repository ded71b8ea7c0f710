"""The figure of sensitivity indices."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.drawing.figure import (
    COLOURS,
    place_in_words,
    roomy,
    sentence,
    styled,
    with_symbol,
)
from uq.drawing.panel import column, figure_of, heading, legend
from uq.errors import InputError
from uq.indices.sensitivities import sensitivities
from uq.indices.targets import FORMS, split_name
from uq.rows.elements import named_elements
from uq.rows.variables import is_category
from uq.wording import time_unit

MEANING = {
    "S1": "alone (S1)",
    "ST": "with all interactions (ST)",
    "delta": "Borgonovo's delta",
    "pawn": "PAWN, median",
    "mu": "mean effect (mu)",
    "sigma": "scatter of effects (sigma)",
    "mu_star": "mean magnitude of effects (mu*)",
    "shapley": "Shapley effect",
    "KS": "Kolmogorov's distance of the rows where it happens",
}


def _is_bar(kind: str, value: Any) -> bool:
    return isinstance(value, dict) and kind not in ("S2", "dummy", "noise")


@styled
def index_bars(
    ds: xr.Dataset,
    output: str,
    *,
    method: str | None = None,
    found: Mapping[str, Any] | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw the sensitivity indices of one output as bars, with their 95 % intervals.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        One of the names that `uq.sensitivity` returns.
    method : str, optional
        By default the first that the study asks for.
    found : dict, optional
        The entry of this output in what `uq.indices.sensitivities` returns, if that is known
        already.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When there is no such output, it stands for several, or it has no indices.
    """
    name, entry = (output, found) if found else _only(ds, output, method)
    kinds = [kind for kind, value in entry.items() if _is_bar(kind, value)]
    parameters = sorted(entry[kinds[-1]], key=lambda p: entry[kinds[-1]][p]["value"] or 0.0)
    labels = [_named(ds[parameter]) for parameter in parameters]
    lines = np.array([max(1.3 * (1 + label.count("\n")), len(kinds)) for label in labels])
    (panel,) = column(axes, 0.8 + 0.13 * lines.sum(), entries=2)
    middle = np.cumsum(lines) - lines / 2
    thickness = 0.8 * lines.min() / len(kinds)
    for i, kind in enumerate(kinds):
        y = middle + thickness * (len(kinds) / 2 - i - 0.5)
        drawn = [entry[kind][parameter] for parameter in parameters]
        table = np.array([(one["value"], one["low"], one["high"]) for one in drawn], dtype=float)
        value, ends = table[:, 0], table[:, 1:].T
        panel.barh(y, value, thickness, color=COLOURS[i], label=MEANING.get(kind, kind))
        panel.errorbar(value, y, xerr=abs(ends - value), fmt="none", ecolor="black", lw=0.8)
    for kind, limit in entry.get("dummy", {}).items():
        of_all = kind.endswith("_any")
        label = "the largest of as many" if of_all else "largest of inputs that play no part"
        panel.axvline(limit, color="black", ls=":" if of_all else "--", lw=0.8, label=label)
    panel.axvline(0, color="black", lw=0.6)
    # An index lies between 0 and 1; an interval far outside must not squeeze the bars.
    shares = "mu_star" not in kinds
    if shares:
        low, high = panel.get_xlim()
        panel.set_xlim(max(low, -0.25), min(high, 1.25))
    panel.set_yticks(middle, labels)
    panel.set_ylim(0, lines.sum())
    roomy(panel, ticks=3)  # the labels take most of the width
    known = any(one["low"] is not None for kind in kinds for one in entry[kind].values())
    form, *_ = split_name(name)
    unit = f"Effect on the {FORMS[form]}" if form in FORMS else "Effect, in the unit of the output"
    axis = "Sensitivity index [1]" if shares else unit
    panel.set_xlabel(axis + known * ",\nwith 95 % interval")
    heading(panel, subject(ds, name))
    legend(panel)
    return figure_of(panel)


def _only(ds: xr.Dataset, output: str, method: str | None) -> tuple[str, Mapping[str, Any]]:
    """Return name and entry of the only target that a name stands for."""
    found = sensitivities(ds, method, output)["outputs"]
    if len(found) > 1:
        raise InputError(f"'{output}' stands for several; name one of: {', '.join(found)}")
    ((name, entry),) = found.items()
    if "refused" in entry:
        raise InputError(f"{name}: {entry['refused']}")
    return name, entry


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
