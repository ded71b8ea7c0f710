"""The figure of a lifetime: its distribution function and survival probability."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from uq.analysis.life_quantiles import B_LIVES, life_quantiles
from uq.analysis.lifetime import survival
from uq.drawing.elements_plot import curve_style, entitle, label, rows_in_words
from uq.drawing.figure import is_wide, logarithmic, sentence, styled, thinned
from uq.drawing.panel import column, figure_of, legend
from uq.intervals import Replicates
from uq.rows.elements import Element, independent_rows, named_elements, replicates_of
from uq.wording import TimeUnit, time_unit

_BANDS = (("", 0.2, "pointwise 95 % band"), ("band_", 0.1, "light: simultaneous band"))


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
    (panel,) = column(axes, 2.3, entries=len(chosen))
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
    panel.set_xlabel(sentence(chosen[0].meaning, unit.name))
    other = panel.secondary_yaxis("right", functions=(_rest, _rest))
    other.set_ylabel("Survival probability")
    if is_wide(ends):
        logarithmic(panel)
    entitle(panel, rows_in_words(chosen), *bands)
    legend(panel)
    return figure_of(panel)


def _mark(axes: Axes, element: Element, replicate: Replicates, unit: TimeUnit, colour: str) -> None:
    for name, found in life_quantiles(element, B_LIVES, replicate).items():
        if np.isfinite(found.value):
            at = found.value / unit.seconds
            ends = [end if np.isfinite(end) else found.value for end in (found.low, found.high)]
            reach = np.abs(np.array(ends)[:, None] / unit.seconds - at)
            axes.errorbar(
                at, B_LIVES[name], xerr=reach, fmt="o", ms=2.5, lw=1.0, capsize=2.0, color=colour
            )


def _rest(share: ArrayLike) -> ArrayLike:
    return 1 - np.asarray(share)
