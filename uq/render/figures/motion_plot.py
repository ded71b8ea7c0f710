"""Figures of a machine's motion: time histories, phase portraits and Poincaré sections."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.errors import InputError
from uq.render.figures.figure import (
    COLOURS,
    INK,
    LIMIT,
    LINES,
    MARK,
    PAGE,
    Drawing,
    are_many,
    point_size,
    styled,
)
from uq.render.figures.panel import above, column, figure_of, finish, roomy, whole_numbers
from uq.render.figures.words import (
    axis_unit,
    families,
    find,
    in_unit,
    label_axes,
    labelled,
    pair,
    powers,
    with_quantities,
)
from uq.result.elements import Floats

_LAST = 4  # periods of the drive
_FINEST = 1e-5  # relative to the largest value: smaller changes are rounding errors
_ABOVE = 54  # width of a label above a panel of the left column [characters]
_BESIDE = 32  # width of the label of the vertical axis [characters]


@styled
def history(
    ds: xr.Dataset,
    quantities: Sequence[str | Sequence[str]] | None = None,
    *,
    axes: Axes | None = None,
) -> Figure:
    """Draw quantities against time, one panel each.

    Parameters
    ----------
    ds : xarray.Dataset
        From `uq.simulate`, with a ``trajectory``, or any Dataset with variables along ``time``.
        Select an interval by ``ds.sel(time=slice(3, 4))``.
    quantities : sequence of str or of sequences of str, optional
        Drawn in this order; by default all. Quantities in an inner sequence share a panel, e.g.
        ``["disphasing_angle", ["speed_1", "speed_2"]]`` for a run-up.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When a quantity does not exist, or quantities in one panel have different units.
    """
    ds = with_quantities(ds)
    if quantities is None:
        quantities = [
            str(name) for name, variable in ds.data_vars.items() if variable.dims == ("time",)
        ]
    groups = [[names] if isinstance(names, str) else list(names) for names in quantities]
    if not groups:
        raise InputError("no variable varies along time")
    variables = [[find(ds, name) for name in group] for group in groups]
    units = [axis_unit(group) for group in variables]
    clock = axis_unit([find(ds, "time")])
    time = in_unit(ds["time"].values, clock)
    panels = column(axes, 0.4 + 1.0 * len(groups), len(groups))
    for panel, group, unit in zip(panels, variables, units, strict=True):
        for i, variable in enumerate(group):
            colour, line = COLOURS[i % len(COLOURS)], LINES[i % len(LINES)]
            series, text = in_unit(variable.values, unit), labelled(variable)
            panel.plot(time, series, color=colour, ls=line, lw=0.8, label=text)
        if len(group) > 1:
            panel.set_ylabel(f"[{powers(unit.name)}]")
            panel.legend(loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0)
        else:
            above(panel, labelled(group[0], unit.name))
    panels[-1].set_xlabel(labelled(ds["time"], clock.name))
    return figure_of(panels[0])


@styled
def motion(ds: xr.Dataset) -> Figure:
    """Draw a simulated motion: the complete time history, with its last periods beside it.

    Parameters
    ----------
    ds : xarray.Dataset
        From `uq.simulate`, with a ``trajectory``.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each of at most six quantities. Dashed lines are stops; angles of turning parts
        lie within half a turn to each side.
    """
    trajectory = ds["trajectory"]
    order = trajectory["shown"].values
    places = sorted(np.flatnonzero(order >= 0), key=lambda place: order[place])
    series = with_quantities(ds)
    period = float(trajectory.attrs["period"])
    clock = axis_unit([ds["time"]])
    time = ds["time"].values
    last = time >= time[-1] - _LAST * period
    columns = 2 if 0 < last.sum() < len(time) / 2 else 1
    figure = Drawing(figsize=(PAGE, 0.6 + 0.95 * len(places)), layout="constrained")
    options: dict[str, Any] = {"width_ratios": (3, 2)} if columns == 2 else {}
    panels = figure.subplots(len(places), columns, squeeze=False, sharex="col", **options)
    for row, place in zip(panels, places, strict=True):
        variable = series[str(trajectory["quantity"].values[place])]
        if trajectory["turns"].values[place]:
            variable = variable.copy(data=_wrapped(variable.values))
            variable.attrs["long_name"] = str(variable.attrs["long_name"]).removesuffix(
                ", turns included"
            )
        unit = axis_unit([variable])
        stops = trajectory["lower_stop"].values[place], trajectory["upper_stop"].values[place]
        for panel, part in zip(row, (slice(None), last), strict=False):
            y = in_unit(variable.values[part], unit)
            panel.plot(in_unit(time[part], clock), y, color=INK, lw=0.6)
            for stop in filter(np.isfinite, stops):
                panel.axhline(in_unit(stop, unit), color=LIMIT, ls="--", lw=0.8)
            largest = np.nanmax(np.abs(variable.values), initial=0.0)
            _widen(panel, in_unit(_FINEST * largest, unit))
        text = labelled(variable, unit.name, width=_ABOVE)
        if count := int(np.isfinite(stops).sum()):
            dashed = f"dashed: stop{'s' * (count > 1)}"
            text += (", " if len(text) + len(dashed) < _ABOVE else "\n") + dashed
        above(row[0], text)
    for panel in panels[-1]:
        panel.set_xlabel(labelled(ds["time"], clock.name))
        roomy(panel)
    if columns == 2:
        above(panels[0, 1], f"The last {_LAST} periods of the drive")
    return figure


def _widen(axes: Axes, least: float) -> None:
    """Set a minimum range of the vertical axis, with tick labels in full."""
    low, high = axes.get_ylim()
    if high - low < least:
        axes.set_ylim((low + high - least) / 2, (low + high + least) / 2)
    whole_numbers(axes.yaxis)


def _wrapped(angle: Floats) -> Floats:
    """Return an angle wrapped to [-pi, pi] [rad], NaN where it jumps between the ends."""
    wrapped = (angle + np.pi) % (2 * np.pi) - np.pi
    wrapped[1:][np.abs(np.diff(wrapped)) > np.pi] = np.nan
    return wrapped


@styled
def phase_portrait(
    ds: xr.Dataset,
    output: str = "velocity",
    *,
    against: str = "displacement",
    section: xr.Dataset | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw one quantity of a motion against another, and the points of its Poincaré section.

    Parameters
    ----------
    ds : xarray.Dataset
        From `uq.simulate`, or any Dataset with both quantities along time or phase, the last
        dimension. A preceding dimension, if there is one, gives one curve for each coordinate.
    output, against : str
        The quantities on the vertical and on the horizontal axis.
    section : xarray.Dataset, optional
        The same quantities at the instants of a section.
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
    ds = with_quantities(ds)
    across, up = pair(ds, against, output)
    (axes,) = column(axes, 2.6)
    units = label_axes(axes, across, up, _BESIDE)
    for xs, ys, style in families(across, up, units):
        thin = 0.7 if len(xs) < 5000 else 0.4
        axes.plot(xs, ys, lw=thin, rasterized=are_many(len(xs) // 10), **style)
    if section is not None:
        for xs, ys, style in families(*pair(section, against, output), units):
            name = f"Poincaré section {style['label']}".strip()
            axes.plot(xs, ys, "ko", ms=MARK, mew=0, label=name)
    return finish(axes)


@styled
def section(
    ds: xr.Dataset,
    output: str = "velocity",
    *,
    against: str = "displacement",
    axes: Axes | None = None,
) -> Figure:
    """Draw the points of a Poincaré section.

    Parameters
    ----------
    ds : xarray.Dataset
        Both quantities at the instants of the section, the last dimension. A preceding dimension,
        if there is one, gives one colour for each coordinate.
    output, against, axes
        As in `phase_portrait`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When a quantity does not exist.
    """
    across, up = pair(ds, against, output)
    (axes,) = column(axes, 2.6)
    units = label_axes(axes, across, up, _BESIDE)
    for xs, ys, style in families(across, up, units):
        size, many = point_size("section", _places(xs, ys)), are_many(len(xs))
        axes.plot(xs, ys, "o", ms=size, mew=0, rasterized=many, **style)
    return finish(axes)


def _places(xs: Floats, ys: Floats) -> int:
    """Return the number of distinct points, to a resolution of a hundredth of the figure."""
    points = np.stack([xs, ys], axis=1)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        return 0
    return len(np.unique(np.round(100 * points / np.ptp(points, axis=0).clip(1e-300)), axis=0))
