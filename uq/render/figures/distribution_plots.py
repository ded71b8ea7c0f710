"""Figures of the distribution of an output: histograms and a lifetime's."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.summary import Described, Summary, summarise
from uq.assess.survival import survival
from uq.render.figures.elements_plot import (
    bins,
    curve_style,
    display_unit,
    drawn_elements,
    entitle,
    mark_thresholds,
    occurring_regimes,
    shares_in_bins,
)
from uq.render.figures.figure import MARK, ROWS, styled, thinned
from uq.render.figures.panel import arrows, column, finish, is_wide, logarithmic, roomy
from uq.render.figures.words import as_label, label, literal, typeset
from uq.result.elements import Element
from uq.result.result import AnyResult, Result
from uq.text.units import ReadableUnit

_MOST_PANELS = 4
_BOUND = "dotted: tolerance bound"
_BANDS = (("", 0.35, "pointwise 95 % band"), ("band_", 0.15, "light: simultaneous band"))


@styled
def histogram(
    result: AnyResult, output: str, *, summary: Summary | None = None, axes: Axes | None = None
) -> Figure:
    """Draw a histogram of an output.

    Dotted lines are the tolerance bounds requested by the study, on the requested side. An angle
    has none, because bounds of the signed angle do not bound its magnitude.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        An output other than a lifetime or category, or one element of it.
    summary : Summary, optional
        What `uq.assess.summary.summarise` returns, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    result = Result.of(result)
    chosen, part = drawn_elements(result.independent, output)
    (panel,) = column(axes, 2.1)
    together = np.concatenate([element.at_least for element in chosen])
    unit = display_unit(chosen[0].units, together)
    edges, wide = bins(together / unit.size)
    outputs = (summary or summarise(result)).outputs
    marked = False
    for i, element in enumerate(chosen):
        colour, line = curve_style(i, element, chosen)
        marked |= _mark_bounds(panel, result, element, outputs.get(element.name), unit, colour)
        style: Any = {"color": colour, "ls": line, "lw": 1.2}
        if len(chosen) == 1:
            style = {"color": ROWS, "fill": True, "lw": 0}
        shares = shares_in_bins(element, element.present, edges, unit)
        panel.stairs(shares, edges, label=label(result, element), **style)
    panel.set(ylim=(0, None), ylabel="Share of rows per bin")
    panel.set_xlabel(as_label(chosen[0].meaning, unit.name))
    logarithmic(panel) if wide else None
    mark_thresholds(panel, result, chosen[0], unit)
    None if wide else roomy(panel)
    entitle(panel, chosen, part, *[_BOUND] * marked)
    return finish(panel)


@styled
def histogram_by_regime(result: AnyResult, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw a histogram of an output, stacked by regime.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of a model with regimes.
    output : str
        An output other than a category, or one element of it. If there are more than four
        elements, only the first and the last are drawn. Only finite lives are drawn.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    result = Result.of(result)
    rows = result.independent
    every = rows.named_elements(output)
    chosen = every if len(every) <= _MOST_PANELS else [every[0], every[-1]]
    codes = rows.dataset["regime"].values
    ended = [np.isfinite(element.values) & ~element.censored for element in chosen]
    drawn = set(codes[np.any(ended, axis=0)].tolist())
    regimes = {
        name: regime for name, regime in occurring_regimes(rows).items() if regime[0] in drawn
    }
    together = np.concatenate([e.values[m] for e, m in zip(chosen, ended, strict=True)])
    unit = display_unit(chosen[0].units, together)
    edges, wide = bins(together / unit.size)
    height = 1.1 if len(chosen) < 3 else 0.75
    panels = column(axes, 0.7 + height * len(chosen), len(chosen))
    for panel, element, mask in zip(panels, chosen, ended, strict=True):
        base = np.zeros(len(edges) - 1)
        for name, (code, colour) in regimes.items():
            top = base + shares_in_bins(element, mask, edges, unit, codes == code)
            panel.stairs(top, edges, baseline=base, fill=True, color=colour, label=name)
            base = top
        panel.set(ylim=(0, None), ylabel="Share of\nrows per bin")
        entitle(panel, [element], place=label(result, element))
    below = "" if chosen == every else f"\nthe first and the last of {len(every)} elements"
    panels[-1].set_xlabel(as_label(chosen[0].meaning, unit.name) + below)
    if wide:
        logarithmic(panels[-1])
    for panel in panels:
        mark_thresholds(panel, result, chosen[0], unit)
    if not wide:
        roomy(panels[-1])
    return finish(panels[0])


@styled
def lifetime(
    result: AnyResult, output: str, *, summary: Summary | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the cumulative failure probability of a lifetime, with its 95 % bands.

    If the end of a life is a success, the axes name the event instead of a failure.

    The dark band is pointwise; the light band, if present, is simultaneous: it covers the entire
    curve. Marks with intervals show B1, B10 and B50, the times by which 1, 10 and 50 % have
    ended. Dotted lines are the tolerance bounds requested by the study. The right axis shows
    the survival probability.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        A lifetime, or one element of it.
    summary : Summary, optional
        What `uq.assess.summary.summarise` returns, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    result = Result.of(result)
    rows = result.independent
    chosen, part = drawn_elements(rows, output)
    ends = np.concatenate([e.values[np.isfinite(e.values)] for e in chosen])
    unit = display_unit(chosen[0].declared.unit, ends)
    (panel,) = column(axes, 2.3)
    bands: dict[str, bool] = {}  # in drawing order
    outputs = (summary or summarise(result)).outputs
    for i, element in enumerate(chosen):
        curve = survival(result, element.name)
        curve = curve.isel(time=thinned(curve.sizes["time"]))
        time = curve["time"].values / unit.size
        colour, line = curve_style(i, element, chosen)
        words = label(result, element, never=float(curve["never"]))
        panel.step(time, 1 - curve["survival"], where="post", color=colour, ls=line, label=words)
        for which, alpha, meaning in _BANDS:
            low, high = 1 - curve[f"{which}high"], 1 - curve[f"{which}low"]
            if np.isfinite(low).any():
                panel.fill_between(time, low, high, step="post", color=colour, alpha=alpha, lw=0)
                bands[meaning] = True
        if _mark_bounds(panel, result, element, outputs.get(element.name), unit, colour):
            bands[_BOUND] = True
    success = chosen[0].declared.success
    event = typeset(literal(success)) if success else "the life has ended"
    panel.set(ylim=(0, 1.02), ylabel=f"Probability that\n{event}")
    panel.set_xlabel(as_label(chosen[0].meaning, unit.name))
    if is_wide(ends):
        logarithmic(panel)
    if len(ends) == 0:
        panel.set_xticks([])
    mark_thresholds(panel, result, chosen[0], unit)
    panel.set_xlim(panel.get_xlim())
    marked: set[str] = set()
    for i, element in enumerate(chosen):
        colour, _ = curve_style(i, element, chosen)
        marked |= _mark(panel, outputs.get(element.name), unit, colour)
    if marked:
        bands[f"marks: {', '.join(name for name in B_LIVES if name in marked)}"] = True
    other = panel.secondary_yaxis("right", functions=(lambda share: 1 - np.asarray(share),) * 2)
    not_yet = "Probability that it has\nnot happened yet"
    other.set_ylabel(not_yet if success else "Survival probability")
    entitle(panel, chosen, part, *bands)
    return finish(panel)


def _mark_bounds(
    axes: Axes,
    result: Result,
    element: Element,
    described: Described | None,
    unit: ReadableUnit,
    colour: str,
) -> bool:
    """Draw the tolerance bounds of an element, and return whether any exist."""
    if described is None or element.is_angle:
        return False
    wanted = result.analysis.wanted.get(element.output)
    if element.is_lifetime:
        wanted = "below" if element.declared.success else "above"
    sides = {"above": ["lower"], "below": ["upper"], None: ["lower", "upper"]}[wanted]
    statistics = [described.find("tolerance", side) for side in sides]
    bounds = [statistic.estimate.value for statistic in statistics if statistic]
    for bound in filter(np.isfinite, bounds):
        axes.axvline(bound / unit.size, color=colour, ls=":", lw=1.2)
    return any(map(np.isfinite, bounds))


def _mark(axes: Axes, described: Described | None, unit: ReadableUnit, colour: str) -> set[str]:
    """Mark the B-lives of an element with intervals, and return the names of finite B-lives."""
    if described is None:
        return set()
    statistics = {name: described.find("b_lives", name) for name in B_LIVES}
    lives = {name: statistic.best.estimate for name, statistic in statistics.items() if statistic}
    finite = {name: estimate for name, estimate in lives.items() if np.isfinite(estimate.value)}
    if not finite:
        return set()
    shares = np.array([B_LIVES[name] for name in finite])
    value, low, high = np.array([estimate.numbers for estimate in finite.values()]).T / unit.size
    edges = axes.get_xlim()
    axes.plot(value, shares, "o", ms=MARK, color=colour)
    axes.hlines(shares, np.clip(low, *edges), np.clip(high, *edges), color=colour, lw=1.0)
    for ends in (low, high):
        axes.plot(ends, shares, "|", ms=5, mew=1.0, color=colour)
    arrows(axes, shares, low, high, "x", color=colour)
    return set(finite)
