"""Figures of lives: incidence by cause, probability paper, and lives beside simulated ones."""

from math import isfinite
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.comparison import Comparison
from uq.assess.life_fit import MAX_ROWS
from uq.assess.observed_lives import ObservedLives
from uq.assess.statistic import Context
from uq.assess.statistics.causes import at_risk, refusal
from uq.assess.survival import survival
from uq.contract import Floats
from uq.errors import InputError, choices
from uq.render.figures.elements_plot import display_unit
from uq.render.figures.figure import BAND, COLOURS, INK, ROWS, styled, thinned
from uq.render.figures.panel import column, finish, is_wide, logarithmic, title
from uq.render.figures.words import as_label, literal
from uq.result.result import AnyResult, Result
from uq.stats.interval_censoring import LifeIntervals
from uq.stats.life_likelihood import LAWS, NoMaximumError, fit_law
from uq.stats.quantile_functions import normal
from uq.stats.survival_curves import aalen_johansen, incidence_interval
from uq.text.units import unit_of

_PAPERS = ("weibull", "lognormal", "exponential")
_TICKS = (0.001, 0.01, 0.05, 0.2, 0.5, 0.9, 0.999)


@styled
def incidence(result: AnyResult, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw the cumulative incidence of each cause, stacked, with pointwise 95 % bands.

    The upper edge of the stack is the probability that the life has ended by any cause. The band of
    each cause is about its own edge, as if the causes below it were known.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result whose lifetime has causes.
    output : str
        The lifetime, or one element of it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When the lifetime has no causes, or no incidence can be estimated.
    """
    result = Result.of(result)
    rows = result.independent
    element = rows.lifetimes(output)[0]
    if element.causes is None:
        raise InputError(f"'{output}' has no causes")
    if why := refusal(element, Context(rows, result.analysis)):
        raise InputError(f"'{output}': {why}")
    values, codes, entered = at_risk(element)
    ended = (codes >= 0) & np.isfinite(values)
    time = np.unique(values[ended])
    time = np.append(0.0, time[thinned(len(time))])
    unit = display_unit(element.units, time)
    (panel,) = column(axes, 2.3)
    base = np.zeros(len(time))
    style: Any = {"step": "post", "lw": 0}
    for code, cause in enumerate(element.declared.causes):
        if not (codes[ended] == code).any():
            continue
        share = aalen_johansen(values, codes, entered, code, time).share
        low, high = incidence_interval(values, codes, entered, code, time)
        colour = COLOURS[code % len(COLOURS)]
        top = base + share
        panel.fill_between(
            time / unit.size, base, top, color=colour, alpha=0.45, label=literal(cause), **style
        )
        band = (base + np.fmin(low, share), base + np.fmax(high, share))
        panel.fill_between(time / unit.size, *band, color=colour, alpha=0.25, **style)
        panel.step(time / unit.size, top, where="post", color=colour, lw=1.0)
        base = top
    panel.set(ylim=(0, 1.02), xlim=(0, None), ylabel="Probability that\nthe life has ended")
    panel.set_xlabel(as_label(element.meaning, unit.name))
    title(panel, "Cumulative incidence by cause", result.counted_rows(len(rows)))
    return finish(panel)


@styled
def probability_paper(
    result: AnyResult, output: str, *, law: str = "weibull", axes: Axes | None = None
) -> Figure:
    """Draw a lifetime on the probability paper of a law, where the law is a straight line.

    Points are the nonparametric estimate at the steps of its distribution function, with pointwise
    95 % intervals; the line is the law fitted by maximum likelihood. Laws without a paper of their
    own are drawn, curved, on that of Weibull.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of independent rows.
    output : str
        A lifetime, or one element of it.
    law : str
        ``weibull``, ``lognormal``, ``exponential``, ``gamma``, ``weibull-3``, ``weibull-mixture``.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When there is no such law or lifetime, or the law cannot be fitted.
    """
    result = Result.of(result)
    if law not in LAWS:
        raise InputError(f"no law '{law}' (allowed: {choices(LAWS)})")
    rows = result.independent
    element = rows.lifetimes(output)[0]
    lives = LifeIntervals(*(part[:MAX_ROWS] for part in ObservedLives(element).lives))
    try:
        fitted = fit_law(law, lives, {})
    except NoMaximumError as error:
        raise InputError(f"'{output}', {law}: {error}") from None
    curve = survival(rows.dataset, element.name, plain=True)
    time, share = curve["time"].values, 1 - curve["survival"].values
    kept = (time > 0) & (share > 0) & (share < 1)
    if not kept.any():
        raise InputError(f"'{output}': no share of the rows between 0 and 1 is known")
    chosen = np.flatnonzero(kept)[thinned(int(kept.sum()), 60)]
    unit = display_unit(element.units, time)
    (panel,) = column(axes, 2.3)
    paper = law if law in _PAPERS else "weibull"
    ends = [1 - curve[end].values[chosen] for end in ("high", "low")]
    low, high = (_scaled(np.clip(end, 1e-6, 1 - 1e-6), paper) for end in ends)
    at = time[chosen] / unit.size
    panel.vlines(at, low, high, color=ROWS, lw=0.7)
    panel.plot(at, _scaled(share[chosen], paper), "o", ms=2.5, color=INK, label="rows")
    first, last = at.min(), at.max()
    line = np.geomspace(first / 2, last * 1.5, 200)
    below = fitted.ended_by(line * unit.size)
    inside = (below > 1e-5) & (below < 1 - 1e-5)
    panel.plot(line[inside], _scaled(below[inside], paper), color=BAND, lw=1.2, label=law)
    if paper != "exponential":
        panel.set_xscale("log")
    edges = (float(np.nanmin(low)), float(np.nanmax(high)))
    shown = [p for p in _TICKS if edges[0] - 0.5 <= _scaled(np.array(p), paper) <= edges[1] + 0.5]
    panel.set_yticks([float(_scaled(np.array(p), paper)) for p in shown], [f"{p:g}" for p in shown])
    panel.minorticks_off() if paper == "exponential" else panel.yaxis.minorticks_off()
    panel.set_ylabel("Probability that\nthe life has ended")
    panel.set_xlabel(as_label(element.meaning, unit.name))
    title(panel, f"{law} law on probability paper", result.counted_rows(len(rows)))
    return finish(panel)


def _scaled(share: Floats, paper: str) -> Floats:
    """Return the ordinate at which the law of a paper is a straight line."""
    if paper == "lognormal":
        return np.vectorize(normal)(share) if np.ndim(share) else np.asarray(normal(float(share)))
    hazard = -np.log1p(-share)
    return hazard if paper == "exponential" else np.log(hazard)


@styled
def compared_lives(comparison: Comparison, *, axes: Axes | None = None) -> Figure:
    """Draw the survival curves of two results over each other, and their difference below.

    Parameters
    ----------
    comparison : Comparison
        Of lives from the field with a simulated study (`uq.assess.comparison.comparison`).
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
    """
    name, curves = next(iter(comparison.curves.items()))
    upper, lower = column(axes, 3.4, 2)
    unit = unit_of(comparison.outputs[name].units, float(np.median(curves.time)))
    time = curves.time / unit.size
    sides = ((curves.first, comparison.first), (curves.second, comparison.second))
    for (estimates, side), colour in zip(sides, COLOURS, strict=False):
        value, low, high = np.array([estimate.numbers for estimate in estimates], float).T
        upper.step(time, value, where="post", color=colour, lw=1.0, label=literal(side.title))
        upper.fill_between(time, low, high, step="post", color=colour, alpha=0.25, lw=0)
    value, low, high = np.array([apart.numbers for apart in curves.differences], float).T
    lower.step(time, value, where="post", color=INK, lw=1.0)
    lower.fill_between(time, low, high, step="post", color=BAND, alpha=0.35, lw=0)
    lower.axhline(0, color=ROWS, lw=0.8)
    upper.set(ylim=(0, 1.02), ylabel="Survival\nprobability")
    lower.set_ylabel("Difference,\nsecond - first")
    declared = comparison.outputs[name].declared
    lower.set_xlabel(as_label(declared.meaning, unit.name))
    for panel in (upper, lower):
        if is_wide(time) and isfinite(time[0]):
            logarithmic(panel)
    return finish(upper)
