"""Figures of the distribution of an output: histograms and a lifetime's."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.answer.wording import rounded
from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.summary import Described, Summary, summarise
from uq.assess.survival import survival
from uq.render.figures.elements_plot import (
    bins,
    curve_style,
    densities,
    density_label,
    display_unit,
    drawn_elements,
    entitle,
    mark_thresholds,
    occurring_regimes,
    shares_in_bins,
)
from uq.render.figures.figure import BAND, BARS, LIMIT, MARK, styled, thinned
from uq.render.figures.line_labels import (
    LineLabel,
    label_lines,
    label_two_curves,
    note_assumed_scale,
)
from uq.render.figures.panel import (
    arrows,
    column,
    finish,
    is_wide,
    logarithmic,
    roomy,
    whole_numbers,
)
from uq.render.figures.words import as_label, label, literal, typeset, unbroken
from uq.result.elements import Element
from uq.result.result import AnyResult, Result
from uq.text.numbers import minus, percent, threshold
from uq.text.units import ReadableUnit

_MOST_PANELS = 4
_MOST_SHARES = 2
_BANDS = (("", 0.45, "pointwise 95 % band"), ("band_", 0.18, "simultaneous band"))


@styled
def histogram(
    result: AnyResult, output: str, *, summary: Summary | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the probability density of an output, as a histogram.

    Over decades it is the density of the logarithm: the area of a bar is the share of its rows.
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
    names: list[LineLabel] = []
    for i, element in enumerate(chosen):
        colour, line = curve_style(i, element, chosen)
        names += _mark_bounds(panel, result, element, outputs.get(element.name), unit, colour)
        style: Any = {"color": colour, "ls": line, "lw": 1.2}
        if len(chosen) == 1:
            style = {"color": BARS[1], "fill": True, "lw": 0}
        shares = shares_in_bins(element, element.present, edges, unit)
        heights = densities(shares, edges, wide)
        panel.stairs(heights, edges, label=label(result, element), **style)
    panel.set(ylim=(0, None), ylabel=density_label(unit, wide))
    panel.set_xlabel(as_label(chosen[0].meaning, unit.name))
    logarithmic(panel) if wide else None
    whole_numbers(panel.yaxis)
    lines = mark_thresholds(panel, result, chosen[0], unit, named=False)
    names += _thresholds_named(chosen, outputs, lines)
    None if wide else roomy(panel)
    entitle(panel, result, chosen, part)
    label_lines(panel, names)
    return finish(panel)


@styled
def histogram_by_regime(result: AnyResult, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw the probability density of an output as a histogram, stacked by regime.

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
            shares = shares_in_bins(element, mask, edges, unit, codes == code)
            top = base + densities(shares, edges, wide)
            panel.stairs(top, edges, baseline=base, fill=True, color=colour, label=name)
            base = top
        panel.set(ylim=(0, None), ylabel=density_label(unit, wide).replace(" [", "\n["))
        whole_numbers(panel.yaxis)
        panel.locator_params(axis="y", nbins=4)
        if len(chosen) > 1:
            place: Any = {"transform": panel.transAxes, "va": "top", "size": 7}
            panel.text(0.02, 0.98, label(result, element), **place)
    entitle(panels[0], result, chosen)
    below = "" if chosen == every else f"\nthe first and the last of {len(every)} elements"
    panels[-1].set_xlabel(as_label(chosen[0].meaning, unit.name) + below)
    if wide:
        logarithmic(panels[-1])
    for panel in panels:
        mark_thresholds(panel, result, chosen[0], unit)
    if not wide:
        roomy(panels[-1])
    note_assumed_scale(panels[-1], result, chosen[0])
    return finish(panels[0])


@styled
def lifetime(
    result: AnyResult, output: str, *, summary: Summary | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the cumulative failure probability of a lifetime, with its 95 % bands.

    If the end of a life is a success, the axes name the event instead of a failure.

    The dark band is pointwise; the light band, if present, is simultaneous: it covers the entire
    curve. Marks with intervals show B1, B10 and B50, the times by which 1, 10 and 50 % have
    ended. Dotted lines are the tolerance bounds requested by the study, dashed lines its
    thresholds; labels above them give the numbers. The right axis shows the survival probability.
    A life that an assumed quantity scales is no prediction, which the figure states.

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
    names: list[LineLabel] = []
    curves, texts, colours = [], [], []
    outputs = (summary or summarise(result)).outputs
    for i, element in enumerate(chosen):
        curve = survival(result, element.name)
        curve = curve.isel(time=thinned(curve.sizes["time"]))
        time = curve["time"].values / unit.size
        colour, line = curve_style(i, element, chosen)
        words = label(result, element) or "estimate"
        if (never := float(curve["never"])) > 0:
            words += literal(f", never: {percent(never)}")
        failed = 1 - curve["survival"].values
        panel.step(time, failed, where="post", color=colour, ls=line, lw=0.8, label=words)
        curves.append((time, failed))
        texts.append(words)
        colours.append(colour)
        for which, alpha, meaning in _BANDS:
            low, high = (1 - curve[which + end].values for end in ("high", "low"))
            # The last interval is that of later times, which are not drawn.
            low[-1:], high[-1:] = low[-2:][:1], high[-2:][:1]
            if np.isfinite(low).any():
                band: Any = {"step": "post", "color": BAND, "alpha": alpha, "lw": 0.6, "zorder": 1}
                panel.fill_between(time, low, high, label="_" * (i > 0) + meaning, **band)
        names += _mark_bounds(panel, result, element, outputs.get(element.name), unit, colour)
    success = chosen[0].declared.success
    event = typeset(literal(success)) if success else "the life has ended"
    panel.set(ylim=(0, 1.02), ylabel=f"Probability that\n{event}")
    panel.set_xlabel(as_label(chosen[0].meaning, unit.name))
    if is_wide(ends):
        logarithmic(panel)
    if len(ends) == 0:
        panel.set_xticks([])
    lines = mark_thresholds(panel, result, chosen[0], unit, named=False)
    names += _thresholds_named(chosen, outputs, lines)
    panel.set_xlim(panel.get_xlim())
    marked: set[str] = set()
    for i, element in enumerate(chosen):
        colour, _ = curve_style(i, element, chosen)
        marked |= _mark(panel, outputs.get(element.name), unit, colour)
    if marked:
        b_lives = ", ".join(name for name in B_LIVES if name in marked)
        words = f"{b_lives.replace('B', '')} % quantiles" if success else b_lives
        next(line for line in panel.lines if line.get_marker() == "o").set_label(words)
    if label_two_curves(panel, curves, texts, colours, [name.at for name in names]):
        for drawn in panel.lines:
            if drawn.get_label() in texts:
                drawn.set_label("_")
    other = panel.secondary_yaxis("right", functions=(lambda share: 1 - np.asarray(share),) * 2)
    not_yet = "Probability that it has\nnot happened yet"
    other.set_ylabel(not_yet if success else "Survival probability")
    entitle(panel, result, chosen, part)
    label_lines(panel, names)
    note_assumed_scale(panel, result, chosen[0])
    return finish(panel)


def _mark_bounds(
    axes: Axes,
    result: Result,
    element: Element,
    described: Described | None,
    unit: ReadableUnit,
    colour: str,
) -> list[LineLabel]:
    """Draw the tolerance bounds of an element, and return their labels."""
    if described is None or element.is_angle:
        return []
    wanted = result.analysis.wanted.get(element.output)
    if element.is_lifetime:
        wanted = "below" if element.declared.success else "above"
    sides = {"above": ["lower"], "below": ["upper"], None: ["lower", "upper"]}[wanted]
    asked = result.analysis.tolerance
    size = f"{100 * asked.coverage:g}/{100 * asked.confidence:g} " if asked else "tolerance "
    names = []
    for side in sides:
        statistic = described.find("tolerance", side)
        if statistic is None or not np.isfinite(statistic.estimate.value):
            continue
        bound = statistic.estimate.value / unit.size
        axes.axvline(bound, color=colour, ls=":", lw=1.2)
        safe = minus(rounded(bound, -np.inf if side == "lower" else np.inf))
        noun = "life" if element.is_lifetime and side == "lower" else "bound"
        names.append(LineLabel(bound, f"{size}{noun} {_with_unit(safe, unit)}", colour))
    return names


def _thresholds_named(
    chosen: Sequence[Element], outputs: Mapping[str, Described], lines: list[tuple[float, float]]
) -> list[LineLabel]:
    """Return the labels of thresholds: the share of rows beyond, or of lives that end within."""
    side, words = ("below", "within") if chosen[0].is_lifetime else ("above", "beyond")
    names = []
    for asked, at in lines:
        text = threshold(asked, chosen[0].units)
        shares = [
            statistic.best.estimate.value
            for element in chosen
            if element.name in outputs
            for statistic in outputs[element.name].parts["thresholds"]
            if statistic.at == asked and statistic.key[-1] == side
        ]
        if chosen[0].is_angle and at < 0:
            text = f"-{text}"
        elif 0 < len(shares) <= _MOST_SHARES and np.isfinite(shares).all():
            text = f"{' and '.join(map(percent, shares))} {words} {text}"
        names.append(LineLabel(at, minus(text), LIMIT))
    return names


def _with_unit(number: str, unit: ReadableUnit) -> str:
    return f"{number} {unbroken(unit.name)}" if unit.name != "1" else number


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
