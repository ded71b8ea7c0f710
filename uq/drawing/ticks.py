"""The ticks of axes and their numbers."""

import re
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import LogFormatter

from uq.rows.elements import Floats

_CHARACTERS = 6
"""Of a number beside each of the ticks that an axis has room for."""


def roomy(axes: Axes, ticks: int = 6) -> None:
    """Thin out the ticks of a horizontal, linear axis until their numbers do not touch."""
    whole_numbers(axes.xaxis)
    for count in range(ticks, 0, -1):
        axes.locator_params(axis="x", nbins=count)
        low, high = sorted(axes.get_xlim())
        shown = [tick for tick in axes.get_xticks() if low <= tick <= high]
        widths = [len(text) for text in axes.xaxis.get_major_formatter().format_ticks(shown)]
        gaps = np.diff(shown) / (high - low) * _CHARACTERS * ticks
        if all(gap >= (a + b) / 2 + 1 for gap, (a, b) in zip(gaps, pairwise(widths), strict=True)):
            return
    axes.set_xticks([shown[0], shown[-1]])  # steps of round numbers leave at least three


def whole_numbers(axis: Axis) -> None:
    """Write each number in full: a common factor at the end of the axis would cover its label."""

    def short(value: float, _: float) -> str:
        text = re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.6g}")
        return text.replace("-", "\N{MINUS SIGN}")

    axis.set_major_formatter(short)


class _PlainLog(LogFormatter):
    """Plain numbers instead of TeX, at the ticks that matplotlib would label."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}".replace("-", "\N{MINUS SIGN}") if super().__call__(x, pos) else ""


def logarithmic(axes: Axes, vertical: bool = False) -> None:
    """Make the horizontal (or the vertical) axis logarithmic, with plain numbers."""
    axis, scale = (axes.yaxis, axes.set_yscale) if vertical else (axes.xaxis, axes.set_xscale)
    scale("log")
    axis.set_major_formatter(_PlainLog())
    axis.set_minor_formatter(_PlainLog())


def is_wide(values: Floats) -> bool:
    """Whether positive values spread so widely that a logarithmic axis shows them better."""
    if len(values) == 0 or values.min() <= 0:
        return False
    low, middle, high = np.quantile(values, (0.005, 0.5, 0.995))
    return bool(high > 30 * low and middle - low < (high - low) / 4)
