"""What figures of the elements of an output share: which curve is which, and how many rows."""

import textwrap
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from uq.drawing.figure import COLOURS, LINES, is_wide, place_in_words
from uq.drawing.panel import legend
from uq.rows.elements import Element, Floats, flags
from uq.wording import percent, time_unit


def look(i: int, element: Element, chosen: Sequence[Element]) -> tuple[str, str]:
    """Return colour and line of a curve: of two dimensions the first chooses the line."""
    if len(element.place) < 2:
        return COLOURS[i % len(COLOURS)], LINES[i // len(COLOURS) % len(LINES)]
    firsts = list(dict.fromkeys(next(iter(one.place.values())) for one in chosen))
    per_first = len(chosen) // len(firsts)
    line = firsts.index(next(iter(element.place.values())))
    return COLOURS[i % per_first % len(COLOURS)], LINES[line % len(LINES)]


def label(ds: xr.Dataset, element: Element, never: float = 0.0) -> str:
    """Return what a curve is called: its place, and the share of rows that never end."""
    words = place_in_words(element, ds[element.output])
    if never > 0:
        words += f"{', ' if words else ''}never: {percent(never)}"
    return words


def rows_in_words(chosen: Sequence[Element], *more: str) -> str:
    """Say how many rows take part, and what became of the others."""
    counts = [f"{len(chosen[0].values)} rows"]
    for state in ("failed", "undefined", "censored"):
        most = max(int(getattr(element, state).sum()) for element in chosen)
        if most:
            counts.append(f"{'up to ' if len(chosen) > 1 else ''}{most} {state}")
    return ", ".join([*counts, *more])


def explain(axes: Axes, chosen: Sequence[Element], *more: str) -> None:
    """Say which curve is which, how many rows take part, and what more there is to say."""
    axes.set_title(textwrap.fill(rows_in_words(chosen, *more), 46), loc="left")
    legend(axes)


def told_in(units: str, values: Floats) -> tuple[str, float]:
    """Return the unit of an axis, and its length: times are told in hours, days or years.

    Parameters
    ----------
    units : str
        Of the output.
    values : ndarray
        Those to be drawn; what is not finite does not count.
    """
    known = np.abs(values[np.isfinite(values)])
    if units != "s" or not len(known):
        return units, 1.0
    unit = time_unit(float(np.median(known)))
    return unit.name, unit.seconds


def bins(values: Floats) -> tuple[Floats, bool]:
    """Return the edges of bins for a histogram, and whether its axis is logarithmic."""
    if len(values) == 0:
        return np.array([0.0, 1.0]), False
    wide = is_wide(values)
    scaled = np.log10(values) if wide else values
    count = len(np.histogram_bin_edges(scaled, "scott")) - 1
    edges = np.histogram_bin_edges(scaled, min(count, 60))
    return (10**edges if wide else edges), wide


def occurring_regimes(rows: xr.Dataset) -> dict[str, int]:
    """Return label and code of each regime that occurs, in the order of the model.

    Parameters
    ----------
    rows : xarray.Dataset
        Rows of a result, of a model with regimes or not.
    """
    if "regime" not in rows:
        return {}
    there = set(np.unique(rows["regime"].values).tolist())
    return {name: code for code, name in flags(rows["regime"]) if code >= 0 and code in there}


def regime_colours(rows: xr.Dataset) -> dict[str, str]:
    """Return the colour of each regime that a model knows: the same in all figures."""
    names = [name for code, name in flags(rows["regime"]) if code >= 0]
    return {name: COLOURS[i % len(COLOURS)] for i, name in enumerate(names)}
