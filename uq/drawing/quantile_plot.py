"""A table of quantiles as a figure for a paper."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.analysis.summary import Summary, summarise
from uq.drawing.elements_plot import display_unit, label, rows_in_words
from uq.drawing.figure import WIDTH, Drawing, sentence, styled
from uq.drawing.panel import figure_of
from uq.rows.elements import independent_rows, named_elements
from uq.wording import interval

_LINE = 0.15  # inch


@styled
def quantile_table(
    ds: xr.Dataset,
    output: str,
    *,
    summary: Summary | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw a table of the quantiles of an output, with their 95 % intervals.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        An output other than a category.
    summary : Summary, optional
        What `uq.analysis.summary.summarise` returns, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    chosen = named_elements(independent_rows(ds), output)
    outputs = (summary or summarise(ds)).outputs
    found = [outputs[element.name].parts["quantiles"] for element in chosen]
    values = [one.estimate.finite.value for quantiles in found for one in quantiles]
    unit, per = display_unit(chosen[0].units, np.array(values))
    words = [label(ds, element) for element in chosen]
    lines = 3 if any(words) else 2
    height = _LINE * (4.2 + (lines + 0.4) * len(chosen))
    if axes is None:
        axes = Drawing(figsize=(WIDTH, height)).add_axes((0.02, 0.0, 0.96, 1.0))
    axes.set_axis_off()
    axes.set(xlim=(0, 1), ylim=(height / _LINE, 0))
    axes.text(0, 0.3, sentence(chosen[0].meaning, unit, 60), va="top")
    axes.text(0, 1.5, f"{rows_in_words(chosen)}; 95 % intervals", va="top", color="0.35", size=7)
    places = [(k + 1) / len(found[0]) for k in range(len(found[0]))]
    for place, one in zip(places, found[0], strict=True):
        axes.text(place, 3.6, f"{100 * float(one.key[-1]):g} %", ha="right")
    for y in (2.6, 3.9, height / _LINE - 0.1):
        axes.axhline(y, color="black", lw=0.6)
    for i, (name, quantiles) in enumerate(zip(words, found, strict=True)):
        y = 5.0 + (lines + 0.4) * i
        if lines == 3:
            axes.text(0, y, name)
            y += 1
        for place, one in zip(places, quantiles, strict=True):
            axes.text(place, y, one.words(per), ha="right")
            axes.text(place, y + 0.95, interval(one.estimate, per), ha="right", size=6)
    return figure_of(axes)
