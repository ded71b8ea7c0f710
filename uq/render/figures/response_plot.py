"""Figures of a machine's response: curves, bifurcation diagrams and basins of attraction."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from uq.errors import InputError
from uq.render.figures.figure import COLOURS, LINES, are_many, point_size, styled
from uq.render.figures.panel import column, finish
from uq.render.figures.words import (
    as_label,
    axis_unit,
    families,
    find,
    in_unit,
    label_axes,
    literal,
    pair,
    powers,
)
from uq.result.result import AnyResult, Result
from uq.text import numbers
from uq.text.numbers import minus, percent

_MOST_CHANGES = 12  # maximum number of regime changes marked along a curve
_WIDE, _NARROW = 60, 36  # characters per line of the legend, of a figure and of a panel
_OTHERS, _FAILED = "#BBBBBB", "#FFFFFF"


@styled
def curve(
    result: AnyResult, output: str, *, against: str | None = None, axes: Axes | None = None
) -> Figure:
    """Draw one quantity against another, such as work-rate against gap or gap against time of wear.

    Dotted lines mark changes of ``ds["regime"]``, if present, along the curve. They are omitted
    if they are too many and would cover the curve.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
    output : str
        A variable along one dimension, and optionally a second one, for instance ``site``, with
        one curve for each coordinate.
    against : str, optional
        A variable along the first dimension, and optionally the second; by default the first
        dimension.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The figure of `axes`, if given.

    Raises
    ------
    InputError
        When a quantity does not exist.
    """
    result = Result.of(result)
    across, up = pair(result.dataset, against or _first_dimension(result, output), output)
    (axes,) = column(axes, 2.2)
    units = label_axes(axes, across, up)
    along = across.dims[0]
    across, up = across.transpose(..., along), up.transpose(..., along)
    for i, (xs, ys, style) in enumerate(families(across, up, units)):
        axes.plot(xs, ys, ls=LINES[i % len(LINES)], **style)
    if "regime" in result.dataset and result.dataset["regime"].dims == (along,):
        kinds = result.dataset["regime"].values
        changed = np.flatnonzero(kinds[1:] != kinds[:-1]) + 1
        changes = in_unit(np.unique(across.values[..., changed]), units[0])
        for i, where in enumerate(changes if len(changed) <= _MOST_CHANGES else ()):
            text = "" if i else "change of regime"
            axes.axvline(where, color="black", ls=":", lw=0.7, zorder=0, label=text)
    return finish(axes)


@styled
def bifurcation(
    result: AnyResult,
    output: str,
    *,
    against: str | None = None,
    by: str | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw a bifurcation diagram: the values of a quantity at each value of a parameter.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
    output : str
        A variable along the dimension of the parameter and others, NaN where it has no value.
    against : str, optional
        The parameter, a variable along one dimension; by default the first dimension of `output`.
    by : str, optional
        A variable of text along the same dimension, for instance ``regime``, that sets the colour.
        If its attribute ``flag_meanings`` lists the regimes of a model, each has the colour that it
        has in figures of results.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The figure of `axes`, if given.

    Raises
    ------
    InputError
        When a quantity does not exist.
    """
    result = Result.of(result)
    up, across = (
        find(result.dataset, output),
        find(result.dataset, against or _first_dimension(result, output)),
    )
    kinds = find(result.dataset, by) if by else xr.full_like(across, "", dtype=object)
    declared = str(kinds.attrs.get("flag_meanings", "")).split()
    (axes,) = column(axes, 2.4)
    units = label_axes(axes, across, up)
    up, across, kinds = xr.broadcast(up, across, kinds)
    finite = np.isfinite(up.values)
    places, values = in_unit(across.values, units[0]), in_unit(up.values, units[1])
    for word, colour in _coloured(kinds.values[finite], declared):
        chosen = finite & (kinds.values == word)
        points = places[chosen], values[chosen]
        size = point_size("diagram", finite.sum())
        many = are_many(int(chosen.sum()))
        axes.plot(*points, "o", ms=size, mew=0, color=colour, label=literal(word), rasterized=many)
    return finish(axes)


def _coloured(words: NDArray[Any], declared: Sequence[str]) -> list[tuple[str, str]]:
    """Return the occurring labels with their colours; declared labels keep their colours."""
    occurring = {str(word) for word in np.unique(words)}
    order = [*declared, *sorted(occurring - set(declared))]
    return [pair for pair in zip(order, cycle(COLOURS)) if pair[0] in occurring]


@styled
def basins(ds: xr.Dataset, outputs: Sequence[str] = (), *, axes: Axes | None = None) -> Figure:
    """Draw the basins of attraction over a grid of two parameters.

    Parameters
    ----------
    ds : xarray.Dataset
        From `uq.basins`, over two parameters.
    outputs : sequence of str
        The legend lists their values at the first point of each basin, besides the categories and
        the share of the grid.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The figure of `axes`, if given.

    Raises
    ------
    InputError
        When there are not two parameters, or an output does not exist.
    """
    attractor = find(ds, "attractor")
    if attractor.ndim != 2:
        raise InputError(f"basins are drawn over two parameters, not {attractor.ndim}")
    across, up = (ds[dim] for dim in attractor.dims)
    width = _WIDE if axes is None else _NARROW
    texts = [_basin(ds.isel(basin=i), outputs, width) for i in range(ds.sizes["basin"])]
    (axes,) = column(axes, 2.6)
    units = label_axes(axes, across, up)
    # If there are more attractors than colours, rare attractors share the last colour.
    shown = np.where(attractor.values < 0, len(COLOURS) + 1, attractor.values)
    shown = np.where(attractor.values >= len(COLOURS), len(COLOURS), shown)
    axes.pcolormesh(
        in_unit(across.values, units[0]),
        in_unit(up.values, units[1]),
        shown.T,
        cmap=ListedColormap([*COLOURS, _OTHERS, _FAILED]),
        vmin=-0.5,
        vmax=len(COLOURS) + 1.5,
        rasterized=True,
    )
    entries = list(zip(COLOURS, texts, strict=False))
    rare = float(ds["share"][len(COLOURS) :].sum())
    if len(texts) > len(COLOURS):
        entries.append((_OTHERS, f"{len(texts) - len(COLOURS)} others, {percent(rare)}"))
    if (attractor.values < 0).any():
        entries.append((_FAILED, f"invalid, {percent(float((attractor < 0).mean()))}"))
    for colour, text in entries:
        axes.plot([], [], "s", color=colour, mec="black", mew=0.4, label=text)
    return finish(axes)


def _first_dimension(result: Result, output: str) -> str:
    return str(next(iter(find(result.dataset, output).dims), output))


def _basin(basin: xr.Dataset, outputs: Sequence[str], width: int) -> str:
    """Return the description of an attractor: categories, chosen outputs and share of the grid.

    The text is wrapped to a width [characters].
    """
    parts = []
    for name, value in basin.data_vars.items():
        output = str(name).removeprefix("representative_")
        if output != name and value.dtype.kind in "UO" and not value.ndim:
            text = str(value.item())
            parts.append(f"{output.replace('_', ' ')} {text}" if text.isdecimal() else text)
    for name in outputs:
        value = find(basin, f"representative_{name}")
        rounded = float(f"{value.item():.3g}")
        text = powers(numbers.in_unit(rounded, axis_unit([value])))
        parts.append(minus(text))
    return as_label(", ".join([*parts, percent(float(basin["share"]))]), width=width)
