"""Scatter plots: an output against its most influential inputs, and inputs by regime."""

from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from uq.assess.answer.wording import called
from uq.assess.row_inputs import independent_inputs
from uq.errors import InputError
from uq.indices.index import RefusedError
from uq.indices.measures import ks_distances
from uq.render.figures.elements_plot import (
    display_unit,
    input_axis,
    mark_thresholds,
    occurring_regimes,
)
from uq.render.figures.figure import (
    INK,
    PAGE,
    ROWS,
    SHADES,
    WIDTH,
    point_size,
    styled,
    thinned,
    width_or,
)
from uq.render.figures.panel import finish, grid, is_wide, logarithmic, roomy, title, whole_numbers
from uq.render.figures.words import as_label, input_label, label, row_counts
from uq.result.elements import (
    Element,
    Floats,
    Mask,
)
from uq.result.result import AnyResult, Result
from uq.stats import intervals, order_statistics
from uq.stats.tails import lacks_variance
from uq.text.numbers import grouped

_MOST_INPUTS = 3
_MOST_POINTS = 3000
_IN_BIN, _MOST_BINS = 20, 24  # minimum rows per bin, maximum bins
_EMPTY = 0.05  # gap around a mean that breaks a line, relative to the panel's height
_RARELY = 3  # in mean spacings: a gap that occurs by chance once in hundreds of cases
_TORN = 8  # in mean spacings: a gap rare by chance within a median's interval
_SHORTEST = 3  # minimum number of slices of a line
_IN_A_ROW = 5.0  # width from which panels stand side by side [inch]
_GAP = 0.1  # gap between rows that breaks a line, relative to the panel's width


@styled
def scatter(result: AnyResult, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw an output against its most influential inputs, with conditional means.

    If the rows are in several regimes, each regime has its own line over the range of its rows.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
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
    result = Result.of(result)
    result.refuse_if_weighted("a scatter plot")
    rows = result.independent
    element = rows.named_elements(output)[0]
    inputs = independent_inputs(rows)
    first = leading(inputs, element)[:_MOST_INPUTS]
    wide_enough = len(first) > 1 and width_or(PAGE) > _IN_A_ROW
    alone = not wide_enough
    width = PAGE if wide_enough else WIDTH
    if alone and len(first) > 1 and axes is None:
        panels = grid(axes, 0.4 + 1.7 * len(first), len(first), 1, width, sharey=True)[:, 0]
    else:
        panels = grid(axes, 2.4, 1, len(first), width, sharey=True)[0]
    unit = display_unit(element.units, element.values)
    shown = replace(
        element,
        values=element.values / unit.size,
    )
    wide = is_wide(shown.values[np.isfinite(shown.values)])
    parts = _parts(rows, len(element.values))
    medians = wide or any(_needs_median(shown, mask) for mask, _ in parts.values())
    for panel, name in zip(panels, first, strict=True):
        per = input_axis(panel, result, name, width=46 if alone else 30)
        x = inputs[name] / per
        across = is_wide(x)
        if across:
            logarithmic(panel)
        _points(panel, x, shown)
        for words, (mask, colour) in parts.items():
            _conditional(panel, x, shown, mask, colour, words, medians, rows.dependence.is_none)
        if not across:
            roomy(panel, 6 if alone else 4)
        whole_numbers(panel.yaxis)
        if wide:
            logarithmic(panel, vertical=True)
        if not np.isfinite(shown.values).any():
            panel.set_yticks([])
        mark_thresholds(panel, result, element, unit, vertical=True)
        if alone and len(first) > 1:
            panel.set_ylabel(as_label(called(element.output), unit.name, 20))
    above = [as_label(element.meaning, unit.name, 46 if alone else 96), label(result, element)]
    statistic = "median" if medians else "mean"
    of_each = f"lines: {statistic} in slices of each regime" if len(parts) > 1 else ""
    remarks = [row_counts(result, [element]), of_each]
    if alone and len(first) > 1:
        subtitle = ", ".join(filter(None, (label(result, element), row_counts(result, [element]))))
        above, remarks = [subtitle], [of_each]
    elif not alone:
        above, remarks = [", ".join(filter(None, above))], ["; ".join(filter(None, remarks))]
    quantity = "" if panels[0].get_ylabel() else as_label(element.meaning, unit.name, 24)
    title(panels[0], *above, *remarks, quantity=quantity)
    return finish(panels[0])


def _parts(rows: Result, count: int) -> dict[str, tuple[Mask, str]]:
    """Return the mask of rows and the colour of each line: one per regime, or one for all rows."""
    regimes = occurring_regimes(rows)
    if len(regimes) < 2:
        return {"": (np.ones(count, dtype=bool), INK)}
    codes = rows.dataset["regime"].values
    return {name: (codes == code, colour) for name, (code, colour) in regimes.items()}


def _points(axes: Axes, x: Floats, element: Element) -> None:
    y, shown = element.values, np.zeros(len(x), dtype=bool)
    shown[thinned(len(x), _MOST_POINTS)] = True
    ended = shown & np.isfinite(y) & ~element.censored
    size = point_size("cloud", shown.sum())
    style: Any = {"ls": "", "rasterized": True, "color": ROWS, "mew": 0}
    axes.plot(x[ended], y[ended], ".", ms=size, alpha=0.7, **style)
    if (going := shown & element.censored & np.isfinite(y)).any():
        axes.plot(x[going], y[going], "^", ms=size, label="censored at the horizon", **style)
    if (never := shown & element.never).any():
        edge: Any = {"transform": axes.get_xaxis_transform(), "clip_on": False, "rasterized": True}
        words, top = "never (at the top edge)", np.ones(never.sum())
        axes.plot(x[never], top, "|", ms=5, color=SHADES[2], label=words, **edge)


def _needs_median(element: Element, mask: Mask) -> bool:
    """Return whether the mean of the rows is infinite or uninformative."""
    values = element.at_most[mask[element.present]]
    return not np.isfinite(values).all() or lacks_variance(values)


def _conditional(
    axes: Axes,
    x: Floats,
    element: Element,
    mask: Mask,
    colour: str,
    regime: str,
    medians: bool,
    independent: bool,
) -> None:
    """Draw the conditional mean (or median) within slices of the input, with its 95 % band."""
    selected = mask[element.present]
    values, x = element.at_most[selected], x[element.present][selected]
    count = min(_MOST_BINS, len(x) // _IN_BIN)
    if count < 2:
        return
    order = order_statistics.ascending_order(x)
    slices = np.array_split(order, count)
    middle = np.array([x[rows].mean() for rows in slices])
    if medians:
        line = np.array([order_statistics.quantile(values[rows], 0.5) for rows in slices])
        ends = [order_statistics.quantile_interval(values[rows], 0.5) for rows in slices]
    else:
        line = np.array([values[rows].mean() for rows in slices])
        ends = [intervals.mean_interval(values[rows]) for rows in slices]
    empty = np.array(
        [_is_empty(values[rows], at, axes) for rows, at in zip(slices, line, strict=True)]
    )
    if medians:
        empty |= [
            _is_torn(values[rows], *interval, axes)
            for rows, interval in zip(slices, ends, strict=True)
        ]
    empty |= _fragments(~empty)
    seen = np.isfinite(line) & ~empty
    line = np.where(seen & ~_fragments(seen), line, np.nan)
    low, high = np.where(empty, np.nan, np.array(ends, dtype=float).T)
    # A gap between neighbouring rows breaks the line, because it contains no information.
    inside = x[order]
    edges = np.array(axes.get_xlim())
    along, width = (np.log, np.log(edges)) if axes.get_xscale() == "log" else (np.array, edges)
    jumps = np.flatnonzero(np.diff(along(inside)) > _GAP * np.ptp(width))
    gaps = np.searchsorted(middle, (inside[jumps] + inside[jumps + 1]) / 2)
    middle, line, low, high = (
        np.insert(series, gaps, np.nan) for series in (middle, line, low, high)
    )
    line_label = f"{'median' if medians else 'mean'} in slices of {grouped(len(x) // count)}"
    if independent:
        line_label += ", 95 % band"
    if np.isfinite(line).any():
        axes.plot(middle, line, color=colour, label=regime or line_label)
    ended = values[np.isfinite(values)]
    if independent and len(ended):
        top = ended.max()  # an infinite end would hide all others
        band: Any = {"facecolor": (colour, 0.25), "edgecolor": (colour, 0.8), "lw": 0.4}
        axes.fill_between(middle, low, np.minimum(high, top), **band)


def _is_empty(values: Floats, at: float, axes: Axes) -> bool:
    """Return whether the rows of a slice leave a gap around their mean or median."""
    if not np.isfinite(at):
        return False
    ended = values[np.isfinite(values)]
    by_chance = _RARELY * np.ptp(ended) / len(ended)
    away = np.min(np.abs(ended - at))
    return bool(away > max(_EMPTY * np.ptp(axes.get_ylim()), by_chance))


def _is_torn(values: Floats, low: float, high: float, axes: Axes) -> bool:
    """Return whether the interval of a median spans a gap between rows."""
    ended = np.sort(values[np.isfinite(values)])
    inside = ended[(low <= ended) & (ended <= high)]
    by_chance = _TORN * np.ptp(ended) / len(ended) if len(ended) else 0.0
    widest = np.diff(inside).max(initial=0.0)
    return bool(widest > max(2 * _EMPTY * np.ptp(axes.get_ylim()), by_chance))


def _fragments(mask: Mask) -> Mask:
    """Return the mask of slices in runs too short for a line."""
    run = np.cumsum(np.diff(mask, prepend=False))
    return mask & (np.bincount(run)[run] < _SHORTEST)


def leading(inputs: dict[str, Floats], element: Element) -> list[str]:
    """Return the inputs ranked by the variance of the output's mean rank over slices."""
    present = element.present
    # Not scipy.stats.rankdata, whose import takes longer than most figures.
    _, place, counts = np.unique(element.at_most, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(counts) - (counts - 1) / 2)[place]
    count = max(1, min(_MOST_BINS, len(ranks) // _IN_BIN))

    def between(x: Floats) -> float:
        slices = np.array_split(ranks[order_statistics.ascending_order(x[present])], count)
        means = np.array([part.mean() if len(part) else 0.0 for part in slices])
        return -float(np.average((means - ranks.mean()) ** 2)) if len(ranks) else 0.0

    return sorted(inputs, key=lambda name: between(inputs[name]))


@styled
def pairs(result: AnyResult, *, axes: Axes | None = None) -> Figure:
    """Draw the inputs that best separate the regimes against each other, coloured by regime.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
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
    result = Result.of(result)
    result.refuse_if_weighted("pairs of inputs by regime")
    rows = result.independent
    regimes = occurring_regimes(rows)
    inputs = independent_inputs(rows)
    if not regimes or len(inputs) < 2:
        raise InputError("pairs by regime need a model with regimes and two uncertain inputs")
    codes = rows.dataset["regime"].values
    leading = _deciding(inputs, codes)[:_MOST_INPUTS]
    units = {name: result.input_unit(name) for name in leading}
    side = len(leading) - 1
    alone = side == 1
    height = 2.1 if alone else 1.45 * side
    panels = grid(axes, 0.5 + height, side, side, sharex="col", sharey="row")
    shown = thinned(len(codes), _MOST_POINTS)
    size = point_size("cloud", len(shown))
    points: Any = {"s": size**2, "lw": 0, "alpha": 0.7, "rasterized": True}
    colour_of = dict(regimes.values())
    # In the order of the rows: drawn regime by regime, the last would cover the others.
    seen = shown[np.isin(codes[shown], list(colour_of))]
    colours = [colour_of[code] for code in codes[seen]]
    for i, down in enumerate(leading[1:]):
        for j, across in enumerate(leading[:-1]):
            panel = panels[i, j]
            if j > i:
                panel.set_axis_off()
                continue
            x, y = (inputs[name][seen] / units[name].size for name in (across, down))
            panel.scatter(x, y, marker=".", c=colours, **points)
            panel.locator_params(axis="y", nbins=4)
            whole_numbers(panel.yaxis)
            roomy(panel, 6 if alone else 3)
            if i == side - 1:
                panel.set_xlabel(
                    input_label(rows.dataset[across], units[across].name, 38 if alone else 17)
                )
            if j == 0:
                panel.set_ylabel(
                    input_label(rows.dataset[down], units[down].name, 30 if alone else 20)
                )
    for name, (_, colour) in regimes.items():
        panels[0, 0].plot([], [], ".", ms=size, mew=0, color=colour, label=name)
    panels[0, 0].set_title(f"{result.counted_rows(len(codes))} by regime", loc="left")
    return finish(panels[0, 0])


def _deciding(inputs: dict[str, Floats], codes: NDArray[Any]) -> list[str]:
    """Return the inputs ranked by how well they separate one regime from the others."""
    columns = np.column_stack(list(inputs.values()))
    far = np.zeros(len(inputs))
    for code in np.unique(codes[codes >= 0]):
        with suppress(RefusedError):  # with few rows, a distance may be due to chance
            far = np.maximum(far, ks_distances(columns, (codes == code).astype(float)))
    return [list(inputs)[i] for i in np.argsort(-far, kind="stable")]
