"""What figures of the elements of an output share: styles, titles, units, bins and regimes."""

import textwrap
from collections.abc import Sequence
from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from uq.drawing.panel import is_wide
from uq.drawing.style import COLOURS, LINES
from uq.drawing.words import rows_in_words
from uq.rows.elements import Element, Floats, flags
from uq.wording import unit_of


def curve_style(i: int, element: Element, chosen: Sequence[Element]) -> tuple[str, str]:
    """Return the colour and line style of a curve: of two dimensions, the first sets the line."""
    if len(element.place) < 2:
        return COLOURS[i % len(COLOURS)], LINES[i // len(COLOURS) % len(LINES)]
    firsts = list(dict.fromkeys(next(iter(one.place.values())) for one in chosen))
    line = firsts.index(next(iter(element.place.values())))
    return COLOURS[i % (len(chosen) // len(firsts)) % len(COLOURS)], LINES[line % len(LINES)]


def entitle(axes: Axes, chosen: Sequence[Element], *more: str, of: str = "") -> None:
    """Write a wrapped title: the place of the element drawn, how many rows there are, and more."""
    texts = filter(None, (of, rows_in_words(chosen), *more))
    axes.set_title(textwrap.fill(", ".join(texts), 46), loc="left")


def display_unit(units: str, values: Floats) -> tuple[str, float]:
    """Return the unit of an axis and its length, as in `uq.wording.unit_of`.

    Parameters
    ----------
    units : str
        Of the output.
    values : ndarray
        Those to be drawn; only finite ones count.
    """
    known = np.abs(values[np.isfinite(values)])
    return unit_of(units, float(np.median(known)) if len(known) else np.nan)[:2]


def bins(values: Floats) -> tuple[Floats, bool]:
    """Return the edges of bins for a histogram, and whether its axis is logarithmic."""
    if len(values) == 0:
        return np.array([0.0, 1.0]), False
    wide = is_wide(values)
    scaled = np.log10(values) if wide else values
    if np.ptp(scaled) <= 1e-9 * np.abs(scaled).max():  # but for rounding, one value
        scaled = scaled[:1]
    count = len(np.histogram_bin_edges(scaled, "scott")) - 1
    edges = np.histogram_bin_edges(scaled, min(count, 60))
    return (10**edges if wide else edges), wide


def occurring_regimes(rows: xr.Dataset) -> dict[str, tuple[int, str]]:
    """Return code and colour of each regime that occurs, by its label, in the order of the model.

    Parameters
    ----------
    rows : xarray.Dataset
        Rows of a result, of a model with regimes or not.

    Returns
    -------
    dict of str to tuple
        A regime has the same colour in all figures, whichever others occur.
    """
    if "regime" not in rows:
        return {}
    there = set(np.unique(rows["regime"].values).tolist())
    known = [(name, code) for code, name in flags(rows["regime"]) if code >= 0]
    coloured = zip(known, cycle(COLOURS))
    return {name: (code, colour) for (name, code), colour in coloured if code in there}
