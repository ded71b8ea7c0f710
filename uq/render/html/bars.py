"""A number as a bar with its interval, in HTML that needs no script."""

from math import isfinite

from markupsafe import Markup

STYLE = Markup("""
.bar { display: block; position: relative; height: .9rem; background: rgba(127, 127, 127, .15);
  -webkit-print-color-adjust: exact; print-color-adjust: exact; }
.bar > * { position: absolute; top: 0; bottom: 0; }
.bar-fill { background: #6b7580; }
.bar-ends { border: solid currentColor; border-width: 0 1px; }
.bar-ends::before { content: ""; position: absolute; left: 0; right: 0;
  top: calc(50% - .5px); border-top: 1px solid currentColor; }
""")
"""Bars have the colour of those in figures, which is none of a regime."""


def bar(value: float, low: float, high: float, scale: tuple[float, float]) -> Markup:
    """Return a bar from zero to a number, with its interval.

    Parameters
    ----------
    value, low, high : float
        NaN for an end that is not known; beyond the scale they stop at its end.
    scale : tuple of float
        The numbers at both ends, zero between them or at one of them.

    Returns
    -------
    Markup
        "" where there is no number to show.
    """
    first, last = scale
    if not isfinite(value) or last <= first:
        return Markup()

    def place(number: float) -> float:
        return 100 * min(max((number - first) / (last - first), 0.0), 1.0)

    parts = [_part("fill", *sorted((place(0.0), place(value))))]
    if low == low and high == high:
        parts.append(_part("ends", place(low), place(high)))
    return Markup('<span class="bar" aria-hidden="true">{}</span>').format(Markup("").join(parts))


def _part(name: str, left: float, right: float) -> Markup:
    return Markup('<span class="bar-{}" style="left:{:.1f}%;width:{:.1f}%"></span>').format(
        name, left, right - left
    )
