"""Figures of the distribution of an output: histograms, a lifetime's, a table of quantiles."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.analysis.life_quantiles import B_LIVES, life_quantiles
from uq.analysis.lifetime import survival
from uq.analysis.summary import Summary, summarise
from uq.drawing.elements_plot import bins, curve_style, display_unit, entitle, occurring_regimes
from uq.drawing.figure import Drawing
from uq.drawing.panel import column, figure_of, finish, is_wide, logarithmic, roomy
from uq.drawing.style import MARK, WIDTH, styled, thinned
from uq.drawing.words import as_label, label, rows_in_words
from uq.intervals import Replicates
from uq.rows.elements import Element, independent_rows, named_elements, replicates_of
from uq.wording import TimeUnit, interval, time_unit

_MOST_PANELS = 4
_LINE = 0.15  # of the table [inch]
_BANDS = (("", 0.2, "pointwise 95 % band"), ("band_", 0.1, "light: simultaneous band"))


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
    (panel,) = column(axes, 2.1)
    together = np.concatenate(values)
    unit, per = display_unit(chosen[0].units, together)
    edges, wide = bins(together / per)
    for i, (element, own) in enumerate(zip(chosen, values, strict=True)):
        colour, line = curve_style(i, element, chosen)
        style: Any = {"fill": True, "lw": 0} if len(chosen) == 1 else {"ls": line, "lw": 1.2}
        counts = np.histogram(own / per, edges)[0] / max(len(own), 1)
        panel.stairs(counts, edges, color=colour, label=label(ds, element), **style)
    panel.set(ylim=(0, None), ylabel="Share of rows per bin")
    panel.set_xlabel(as_label(chosen[0].meaning, unit))
    logarithmic(panel) if wide else roomy(panel)
    entitle(panel, chosen)
    return finish(panel, entries=len(chosen))


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
    codes = rows["regime"].values
    ended = [np.isfinite(element.values) & ~element.censored for element in chosen]
    drawn = set(codes[np.any(ended, axis=0)].tolist())
    regimes = {name: one for name, one in occurring_regimes(rows).items() if one[0] in drawn}
    together = np.concatenate([e.values[m] for e, m in zip(chosen, ended, strict=True)])
    unit, per = display_unit(chosen[0].units, together)
    edges, wide = bins(together / per)
    panels = column(axes, 0.7 + 1.1 * len(chosen), len(chosen))
    for panel, element, mask in zip(panels, chosen, ended, strict=True):
        base = np.zeros(len(edges) - 1)
        for name, (code, colour) in regimes.items():
            own = element.values[mask & (codes == code)] / per
            top = base + np.histogram(own, edges)[0] / max(int(mask.sum()), 1)
            panel.stairs(top, edges, baseline=base, fill=True, color=colour, label=name)
            base = top
        panel.set(ylim=(0, None), ylabel="Share of rows\nper bin")
        entitle(panel, [element], of=label(ds, element))
    panels[-1].set_xlabel(as_label(chosen[0].meaning, unit))
    logarithmic(panels[-1]) if wide else roomy(panels[-1])
    return finish(panels[0])


@styled
def lifetime(ds: xr.Dataset, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw the probability that a life has ended against time, with its 95 % bands.

    The dark band is pointwise; the light one, where there is one, is simultaneous: it covers the
    whole curve. Marks with intervals show B1, B10 and B50, the times by which 1, 10 and 50 % have
    ended. The right axis shows the survival probability.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        A lifetime, or one element of it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = independent_rows(ds)
    chosen = named_elements(rows, output)
    ends = np.concatenate([e.values[np.isfinite(e.values)] for e in chosen])
    unit = time_unit(float(np.median(ends)) if len(ends) else 0.0)
    (panel,) = column(axes, 2.3)
    bands: dict[str, bool] = {}  # in the order in which they are drawn
    for i, element in enumerate(chosen):
        curve = survival(ds, element.name)
        curve = curve.isel(time=thinned(curve.sizes["time"]))
        time = curve["time"].values / unit.seconds
        colour, line = curve_style(i, element, chosen)
        words = label(ds, element, never=float(curve["never"]))
        panel.step(time, 1 - curve["survival"], where="post", color=colour, ls=line, label=words)
        for which, alpha, meaning in _BANDS:
            low, high = 1 - curve[f"{which}high"], 1 - curve[f"{which}low"]
            if np.isfinite(low).any():
                panel.fill_between(time, low, high, step="post", color=colour, alpha=alpha, lw=0)
                bands[meaning] = True
        _mark(panel, element, replicates_of(rows), unit, colour)
    panel.set(ylim=(0, 1.02), ylabel="Probability that\nthe life has ended")
    panel.set_xlabel(as_label(chosen[0].meaning, unit.name))
    other = panel.secondary_yaxis("right", functions=(lambda share: 1 - np.asarray(share),) * 2)
    other.set_ylabel("Survival probability")
    if is_wide(ends):
        logarithmic(panel)
    entitle(panel, chosen, *bands)
    return finish(panel, entries=len(chosen))


def _mark(axes: Axes, element: Element, replicate: Replicates, unit: TimeUnit, colour: str) -> None:
    for name, found in life_quantiles(element, B_LIVES, replicate).items():
        if np.isfinite(found.value):
            at = found.value / unit.seconds
            ends = [end if np.isfinite(end) else found.value for end in (found.low, found.high)]
            reach = np.abs(np.array(ends)[:, None] / unit.seconds - at)
            axes.errorbar(
                at, B_LIVES[name], xerr=reach, fmt="o", ms=MARK, lw=1.0, capsize=2.0, color=colour
            )


@styled
def quantile_table(
    ds: xr.Dataset, output: str, *, summary: Summary | None = None, axes: Axes | None = None
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
    axes.text(0, 0.3, as_label(chosen[0].meaning, unit, 60), va="top")
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
