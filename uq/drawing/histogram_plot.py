"""Histograms of an output: of all rows, and by regime."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.drawing.elements_plot import (
    bins,
    curve_style,
    display_unit,
    entitle,
    label,
    occurring_regimes,
    regime_colours,
    rows_in_words,
)
from uq.drawing.figure import logarithmic, roomy, sentence, styled
from uq.drawing.panel import column, figure_of, legend
from uq.rows.elements import independent_rows, named_elements

_MOST_PANELS = 4


@styled
def histogram(ds: xr.Dataset, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw a histogram of an output.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        An output other than a lifetime or category, or one element of it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    chosen = named_elements(independent_rows(ds), output)
    values = [element.at_least for element in chosen]
    (panel,) = column(axes, 2.1, entries=len(chosen))
    together = np.concatenate(values)
    unit, per = display_unit(chosen[0].units, together)
    edges, wide = bins(together / per)
    for i, (element, own) in enumerate(zip(chosen, values, strict=True)):
        colour, line = curve_style(i, element, chosen)
        style: Any = {"fill": True, "lw": 0} if len(chosen) == 1 else {"ls": line, "lw": 1.2}
        counts = np.histogram(own / per, edges)[0] / max(len(own), 1)
        panel.stairs(counts, edges, color=colour, label=label(ds, element), **style)
    panel.set(ylim=(0, None), ylabel="Share of rows per bin")
    panel.set_xlabel(sentence(chosen[0].meaning, unit))
    logarithmic(panel) if wide else roomy(panel)
    entitle(panel, rows_in_words(chosen))
    legend(panel)
    return figure_of(panel)


@styled
def histogram_by_regime(ds: xr.Dataset, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw a histogram of an output, stacked by regime.

    Parameters
    ----------
    ds : xarray.Dataset
        A result of a model with regimes.
    output : str
        An output other than a category, or one element of it. At most four elements are drawn,
        and only lives that end.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = independent_rows(ds)
    chosen = named_elements(rows, output)[:_MOST_PANELS]
    codes, colours = rows["regime"].values, regime_colours(rows)
    ended = [np.isfinite(element.values) & ~element.censored for element in chosen]
    drawn = set(codes[np.any(ended, axis=0)].tolist())
    regimes = {name: code for name, code in occurring_regimes(rows).items() if code in drawn}
    together = np.concatenate([e.values[m] for e, m in zip(chosen, ended, strict=True)])
    unit, per = display_unit(chosen[0].units, together)
    edges, wide = bins(together / per)
    panels = column(axes, 0.7 + 1.1 * len(chosen), len(chosen), entries=len(regimes))
    for panel, element, mask in zip(panels, chosen, ended, strict=True):
        base = np.zeros(len(edges) - 1)
        for name, code in regimes.items():
            own = element.values[mask & (codes == code)] / per
            top = base + np.histogram(own, edges)[0] / max(int(mask.sum()), 1)
            panel.stairs(top, edges, baseline=base, fill=True, color=colours[name], label=name)
            base = top
        panel.set(ylim=(0, None), ylabel="Share of rows\nper bin")
        entitle(panel, label(ds, element), rows_in_words([element]))
    panels[-1].set_xlabel(sentence(chosen[0].meaning, unit))
    logarithmic(panels[-1]) if wide else roomy(panels[-1])
    legend(panels[0])
    return figure_of(panels[0])
