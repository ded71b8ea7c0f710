"""Scatter plots: an output against its most influential inputs, and inputs by regime."""

from contextlib import suppress
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from uq import intervals, order_statistics
from uq.drawing.elements_plot import display_unit, entitle, occurring_regimes
from uq.drawing.panel import finish, grid, is_wide, logarithmic, roomy, whole_numbers
from uq.drawing.style import COLOURS, point_size, styled, thinned
from uq.drawing.words import as_label, label, named_input
from uq.errors import InputError
from uq.indices.independent_inputs import independent_inputs
from uq.methods.indices import RefusedError
from uq.methods.measures import ks_distances
from uq.rows.elements import Element, Floats, independent_rows, named_elements, replicates_of
from uq.tails import lacks_variance

_MOST_INPUTS = 3
_MOST_POINTS = 3000
_IN_BIN, _MOST_BINS = 20, 24  # rows at least, bins at most


@styled
def scatter(ds: xr.Dataset, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw an output against its most influential inputs, with conditional means.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        An output or one element of it; for an output with several elements, the first is drawn.
        If lives never end or are censored, or values spread over decades, the line is the
        conditional median.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = independent_rows(ds)
    element = named_elements(rows, output)[0]
    inputs = independent_inputs(rows)
    shown = leading(inputs, element)[:_MOST_INPUTS]
    panels = grid(axes, 0.5 + 1.5 * len(shown), len(shown), sharey=True)[:, 0]
    finite = np.isfinite(element.values)
    unit, per = display_unit(element.units, element.values)
    wide = is_wide(element.values[finite])
    independent = replicates_of(rows) is None
    for panel, name in zip(panels, shown, strict=True):
        _points(panel, inputs[name], element, per)
        _conditional(panel, inputs[name], element, per, wide, independent)
        _name_input(panel, rows, name)
        whole_numbers(panel.yaxis)
        panel.set_ylabel(as_label(element.meaning, unit, width=24))
        if wide:
            logarithmic(panel, vertical=True)
    entitle(panels[0], [element], of=label(ds, element))
    return finish(panels[0], entries=0)  # the panels are high enough to make room


def _points(axes: Axes, x: Floats, element: Element, per: float) -> None:
    y, shown = element.values / per, np.zeros(len(x), dtype=bool)
    shown[thinned(len(x), _MOST_POINTS)] = True
    ended = shown & np.isfinite(y) & ~element.censored
    size = point_size("cloud", shown.sum())
    style: Any = {"ls": "", "rasterized": True, "alpha": 0.6, "mew": 0}
    axes.plot(x[ended], y[ended], ".", ms=size, color=COLOURS[4], **style)
    if (going := shown & element.censored & np.isfinite(y)).any():
        words = "censored at the horizon"
        axes.plot(x[going], y[going], "^", ms=size, color=COLOURS[3], label=words, **style)
    if (never := shown & element.never).any():
        edge: Any = {"transform": axes.get_xaxis_transform(), "clip_on": False, "rasterized": True}
        words, top = "never (at the top edge)", np.ones(never.sum())
        axes.plot(x[never], top, "|", ms=5, color=COLOURS[5], label=words, **edge)


def _conditional(
    axes: Axes, x: Floats, element: Element, per: float, wide: bool, independent: bool
) -> None:
    """Draw the mean within slices of the input, or the median where the mean is uninformative."""
    present = element.present
    x, values = x[present], element.at_most / per
    medians = wide or not np.isfinite(values).all() or lacks_variance(values)
    count = min(_MOST_BINS, len(x) // _IN_BIN)
    if count < 2:
        return
    slices = np.array_split(np.argsort(x, kind="stable"), count)
    middle = np.array([x[rows].mean() for rows in slices])
    if medians:
        line = np.array([order_statistics.quantile(values[rows], 0.5) for rows in slices])
        ends = [order_statistics.quantile_interval(values[rows], 0.5) for rows in slices]
    else:
        line = np.array([values[rows].mean() for rows in slices])
        ends = [intervals.mean_interval(values[rows]) for rows in slices]
    line = np.where(np.isfinite(line), line, np.nan)
    words = f"{'median' if medians else 'mean'} in slices of {len(x) // count} rows"
    axes.plot(middle, line, color=COLOURS[1], label=words + independent * ", 95 % band")
    ended = values[np.isfinite(values)]
    if independent and len(ended):
        low, high = np.array(ends, dtype=float).T
        top = ended.max()  # an infinite end would hide all others
        axes.fill_between(middle, low, np.minimum(high, top), color=COLOURS[1], alpha=0.25, lw=0)


def leading(inputs: dict[str, Floats], element: Element) -> list[str]:
    """Return the inputs in order of how much the mean rank of the output varies over slices."""
    from scipy.stats import rankdata

    present = element.present
    ranks = rankdata(element.at_most)
    count = max(1, min(_MOST_BINS, len(ranks) // _IN_BIN))

    def between(x: Floats) -> float:
        slices = np.array_split(ranks[np.argsort(x[present], kind="stable")], count)
        means = np.array([part.mean() if len(part) else 0.0 for part in slices])
        return -float(np.average((means - ranks.mean()) ** 2)) if len(ranks) else 0.0

    return sorted(inputs, key=lambda name: between(inputs[name]))


def _name_input(axes: Axes, rows: xr.Dataset, name: str, width: int = 38, ticks: int = 6) -> None:
    axes.set_xlabel(named_input(rows[name], width))
    roomy(axes, ticks)


@styled
def pairs(ds: xr.Dataset, *, axes: Axes | None = None) -> Figure:
    """Draw the inputs that best separate the regimes against each other, coloured by regime.

    Parameters
    ----------
    ds : xarray.Dataset
        A result of a model with regimes and at least two uncertain inputs.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When there are no regimes, or fewer than two inputs.
    """
    rows = independent_rows(ds)
    regimes = occurring_regimes(rows)
    inputs = independent_inputs(rows)
    if not regimes or len(inputs) < 2:
        raise InputError("pairs by regime need a model with regimes and two uncertain inputs")
    codes = rows["regime"].values
    leading = _deciding(inputs, codes)[:_MOST_INPUTS]
    size = len(leading) - 1
    alone = size == 1
    height = 2.1 if alone else 1.45 * size
    panels = grid(axes, 0.5 + height, size, size, sharex="col", sharey="row")
    shown = thinned(len(codes), _MOST_POINTS)
    points: Any = {
        "ms": point_size("cloud", len(shown)),
        "mew": 0,
        "alpha": 0.7,
        "rasterized": True,
    }
    for i, down in enumerate(leading[1:]):
        for j, across in enumerate(leading[:-1]):
            panel = panels[i, j]
            if j > i:
                panel.set_axis_off()
                continue
            for name, (code, colour) in regimes.items():
                own = shown[codes[shown] == code]
                place = inputs[across][own], inputs[down][own]
                panel.plot(*place, ".", color=colour, label=name, **points)
            panel.locator_params(axis="y", nbins=4)
            whole_numbers(panel.yaxis)
            if i == size - 1:
                _name_input(panel, rows, across, *((38, 6) if alone else (17, 3)))
            if j == 0:
                panel.set_ylabel(named_input(rows[down], width=30 if alone else 20))
    panels[0, 0].set_title(f"{len(codes)} rows by regime", loc="left")
    return finish(panels[0, 0])


def _deciding(inputs: dict[str, Floats], codes: NDArray[Any]) -> list[str]:
    """Return the inputs in order of how well they separate one regime from the others."""
    columns = np.column_stack(list(inputs.values()))
    far = np.zeros(len(inputs))
    for code in np.unique(codes[codes >= 0]):
        with suppress(RefusedError):  # with few rows, a distance may be due to chance
            far = np.maximum(far, ks_distances(columns, (codes == code).astype(float)))
    return [list(inputs)[i] for i in np.argsort(-far, kind="stable")]
