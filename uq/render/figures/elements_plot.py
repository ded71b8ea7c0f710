"""Common parts of figures of elements: styles, titles, units, bins and regimes."""

import textwrap
from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from uq.render.figures.figure import COLOURS, LIMIT, LINES, SHADES, thinned
from uq.render.figures.panel import is_wide
from uq.render.figures.words import input_label, literal, row_counts, unbroken
from uq.result.elements import Element, Floats, Mask, flags
from uq.result.result import Result
from uq.text.numbers import minus, printed, threshold
from uq.text.units import ReadableUnit, typical, unit_of

_MOST_BINS = 60
_MOST_CURVES = 12


def drawn_elements(rows: Result, output: str) -> tuple[list[Element], str]:
    """Return the elements of an output that fit in a figure, and the number drawn.

    Parameters
    ----------
    rows : Result
    output : str

    Returns
    -------
    list of Element
        If there are too many, an evenly spaced selection including both ends.
    str
        "" if all elements are drawn.
    """
    every = rows.named_elements(output)
    chosen = [every[i] for i in thinned(len(every), _MOST_CURVES)]
    all_drawn = len(chosen) == len(every)
    return chosen, "" if all_drawn else f"{len(chosen)} of {len(every)} elements"


def curve_style(i: int, element: Element, chosen: Sequence[Element]) -> tuple[str, str]:
    """Return the shade and line style of a curve; of two dimensions, the first sets the style."""
    if len(element.place) < 2:
        return SHADES[i % len(SHADES)], LINES[(i + i // len(SHADES)) % len(LINES)]
    firsts = [next(iter(other.place.values())) for other in chosen]
    line = list(dict.fromkeys(firsts)).index(firsts[i])
    return SHADES[firsts[:i].count(firsts[i]) % len(SHADES)], LINES[line % len(LINES)]


def entitle(
    axes: Axes, result: Result, chosen: Sequence[Element], *more: str, place: str = ""
) -> None:
    """Write a wrapped title: coordinates of the element, number of rows, and further text."""
    texts = filter(None, (place, row_counts(result, chosen), *more))
    text = printed(", ".join(texts))  # no line breaks within a number
    axes.set_title(textwrap.fill(text, 44).replace("\u00a0", " "), loc="left")


_LONG = 0.9  # quantile of times that their axis has the unit of


def display_unit(units: str, values: Floats) -> ReadableUnit:
    """Return the unit of an axis for these values of an output.

    Times take the unit of long ones: seconds would be far from thresholds in hours.
    """
    ends = values[np.isfinite(values)]
    size = np.quantile(ends, _LONG) if units == "s" and len(ends) else typical(values)
    return unit_of(units, float(size))


def input_axis(axes: Axes, result: Result, name: str, width: int = 44) -> float:
    """Label the horizontal axis with an input, and return the size of the axis unit."""
    unit = result.input_unit(name)
    axes.set_xlabel(input_label(result.dataset[name], unit.name, width))
    return unit.size


def mark_thresholds(
    axes: Axes,
    result: Result,
    element: Element,
    unit: ReadableUnit,
    vertical: bool = False,
    named: bool = True,
) -> list[tuple[float, float]]:
    """Draw the study's thresholds of an output as lines; for an angle, on both sides.

    A threshold so far away that it would compress the data is drawn as an arrow at the edge.

    Parameters
    ----------
    axes : Axes
        Axes with the data already drawn.
    result : Result
    element : Element
    unit : ReadableUnit
        Unit of the axis.
    vertical : bool
        Whether the output is on the vertical axis.
    named : bool
        Whether the legend names a line within the frame.

    Returns
    -------
    list of tuple of float
        Of each line: the threshold [CF units], and its place on the axis.
    """
    lines = []
    ends, scale = (axes.get_ylim, axes.get_yscale) if vertical else (axes.get_xlim, axes.get_xscale)
    line = axes.axhline if vertical else axes.axvline
    for asked in result.analysis.thresholds.get(element.output, ()):
        at = asked / unit.size
        sign = "±" if element.is_angle else ""
        words = minus(f"threshold {sign}{threshold(asked, element.units)}")
        low, high = ends()
        for place in (-at, at) if element.is_angle else (at,):
            style: Any = {"color": LIMIT, "label": words}
            if _is_near(place, low, high, scale() == "log"):
                style["label"] = style["label"] if named else None
                line(place, lw=1.0, ls=(0, (4, 1.5)), **style)
                lines.append((asked, place))
            else:
                edge = float(place > high)
                arrow = ("v^" if vertical else "<>")[int(edge)]
                spot = (0.5, edge) if vertical else (edge, 0.5)
                style["label"] += ", outside the frame"
                axes.plot(*spot, arrow, ms=5, transform=axes.transAxes, clip_on=False, **style)
            words = f"_{words}"  # one line of the legend
    return lines


def _is_near(place: float, low: float, high: float, logarithmic: bool) -> bool:
    if logarithmic and place <= 0:
        return False
    place, low, high = np.log10([place, low, high]) if logarithmic else (place, low, high)
    return bool(low - (high - low) / 2 <= place <= high + (high - low) / 2)


def bins(values: Floats) -> tuple[Floats, bool]:
    """Return the bin edges of a histogram, and whether its axis is logarithmic."""
    if len(values) == 0:
        return np.array([0.0, 1.0]), False
    wide = is_wide(values)
    scaled = np.log10(values) if wide else values
    if np.ptp(scaled) <= 1e-9 * np.abs(scaled).max():  # a single value, apart from rounding
        scaled = scaled[:1]
    low, high = scaled.min(), scaled.max()
    if high - low <= _MOST_BINS and not wide and (scaled == np.round(scaled)).all():
        return np.arange(low - 0.5, high + 1.0), False  # counts: one bin per value
    edges = np.histogram_bin_edges(scaled, _bin_count(scaled))
    if wide:
        edges = 10**edges
        edges[0], edges[-1] = values.min(), values.max()  # exact: many rows may lie there
    return edges, wide


def shares_in_bins(
    element: Element, kept: Mask, edges: Floats, unit: ReadableUnit, part: Mask | None = None
) -> Floats:
    """Return the share of the kept rows in each bin, or the share contributed by a subset."""
    worth = np.ones(len(kept)) if element.weights is None else element.weights
    selected = kept if part is None else kept & part
    counts = np.histogram(element.values[selected] / unit.size, edges, weights=worth[selected])[0]
    total = worth[kept].sum()
    return np.asarray(counts / total if total > 0 else counts)


def densities(shares: Floats, edges: Floats, wide: bool) -> Floats:
    """Return the densities of shares in bins: per unit of the axis, or per decade of a wide one."""
    return np.asarray(shares / np.diff(np.log10(edges) if wide else edges))


def density_label(unit: ReadableUnit, wide: bool) -> str:
    """Return the label of an axis of densities."""
    per = "decade" if wide else unbroken(unit.name) if unit.name != "1" else ""
    return f"Density [per {per}]" if per else "Density"


def _bin_count(values: Floats) -> int:
    """Return the number of bins by Scott's rule, or by Freedman and Diaconis' for long tails."""
    middle = np.subtract(*np.quantile(values, (0.75, 0.25)))
    widths = [width for width in (3.49 * values.std(), 2 * middle) if width > 0]
    if not widths:
        return 1
    return int(min(np.ceil(np.ptp(values) * np.cbrt(len(values)) / min(widths)), _MOST_BINS))


def occurring_regimes(rows: Result) -> dict[str, tuple[int, str]]:
    """Return the code and colour of each occurring regime by label, in the order of the model.

    Parameters
    ----------
    rows : Result
        Rows of a result; the model need not have regimes.

    Returns
    -------
    dict of str to tuple
        The colour of a regime is the same in all figures, independent of other regimes.
    """
    if "regime" not in rows.dataset:
        return {}
    occurring = set(np.unique(rows.dataset["regime"].values).tolist())
    regimes = [(name, code) for code, name in flags(rows.dataset["regime"]) if code >= 0]
    coloured = zip(regimes, cycle(COLOURS))
    return {literal(name): (code, colour) for (name, code), colour in coloured if code in occurring}
