"""Figures of convergence: estimates from ever more of the first rows."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from uq.assess.convergence import running_estimates
from uq.errors import InputError
from uq.indices.index import ST
from uq.render.figures.elements_plot import curve_style, display_unit, drawn_elements
from uq.render.figures.index_plot import range_of_indices, subject
from uq.render.figures.panel import arrows, column, finish, title, whole_numbers
from uq.render.figures.style import INK, LINES, SHADES, styled
from uq.render.figures.words import as_label, label, labelled
from uq.result.elements import Floats
from uq.result.result import AnyResult, Result
from uq.text.numbers import grouped

_MOST_INPUTS = 6
_MARKS = "os^vDP"
_APART = 0.06  # between the intervals of two inputs, over the distance of twice the samples


@styled
def convergence(
    result: AnyResult, output: str, *, running: pd.DataFrame | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the convergence of the mean (or the median) of an output, with 95 % intervals.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        An output other than a category, or one element of it.
    running : pandas.DataFrame, optional
        What `uq.running_estimates` returns, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The intervals are pointwise.

    Raises
    ------
    InputError
        When the first rows of the design do not form a design, or neither estimate is known.
    """
    result = Result.of(result)
    running = running_estimates(result) if running is None else running
    kind, own = followed(result, output, running)
    if not kind:
        raise InputError(f"{output}: neither its mean nor its median can be estimated")
    chosen, part = drawn_elements(result.independent, output)
    unit = display_unit(chosen[0].units, np.concatenate([one.values for one in chosen]))
    (panel,) = column(axes, 2.1)
    for i, element in enumerate(chosen):
        colour, line = curve_style(i, element, chosen)
        _curve(
            panel,
            own[own["output"] == element.name],
            unit.size,
            colour,
            line,
            label(result, element),
        )
    what = "mean" if kind == "mean" else "median"
    known = _over_samples(panel, result)
    if known and not np.isfinite(own[["low", "high"]].astype(float)).all(axis=None):
        known += " where the rows allow one"
    whole_numbers(panel.yaxis)
    title(panel, as_label(f"{what}: {chosen[0].meaning}", unit.name, 46), part, known)
    return finish(panel)


def followed(result: Result, output: str, running: pd.DataFrame) -> tuple[str, pd.DataFrame]:
    """Return the estimate of an output that `convergence` draws ("" for none), and its lines."""
    names = [element.name for element in result.independent.named_elements(output)]
    own = running[running["output"].isin(names)]
    own = own[np.isfinite(own["value"].astype(float))]
    # If a life never ends, the first rows may have a mean although all rows have none.
    of_all = own[own["samples"] == running["samples"].max()].groupby("estimate")["output"].nunique()
    kind = max(("mean", "quantile 0.5"), key=lambda one: of_all.get(one, 0))
    return kind if kind in of_all else "", own[own["estimate"] == kind]


@styled
def index_convergence(
    result: AnyResult, output: str, *, running: pd.DataFrame | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the convergence of the total indices of an output, with 95 % intervals.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of a crossed design.
    output : str
        A name that `uq.sensitivity` returns.
    running, axes
        As in `convergence`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When the output has no total indices.
    """
    result = Result.of(result)
    running = running_estimates(result) if running is None else running
    own = total_indices(running)
    own = own[own["output"] == output]
    if own.empty:
        raise InputError(f"{output}: no total indices of fewer rows are known")
    last = own[own["samples"] == own["samples"].max()].sort_values("value", ascending=False)
    leading = last["input"].tolist()[:_MOST_INPUTS]
    (panel,) = column(axes, 2.1)
    ends = []
    for i, name in enumerate(leading):
        samples, value, low, high = _numbers(own[own["input"] == name])
        samples = samples * 2 ** (_APART * (i - (len(leading) - 1) / 2))
        colour, line = SHADES[i % len(SHADES)], LINES[(i + i // len(SHADES)) % len(LINES)]
        style: Any = {"color": colour, "ls": line, "marker": _MARKS[i], "ms": 3}
        panel.plot(samples, value, label=labelled(result.dataset[name], width=60), **style)
        known = np.isfinite(low)
        panel.vlines(samples[known], low[known], high[known], color=colour, lw=0.8)
        ends.append((samples, low, high))
    panel.set_ylabel("Total index (ST)")
    panel.set_ylim(range_of_indices(panel.get_ylim()))
    said = _over_samples(panel, result)
    for one in ends:
        arrows(panel, *one, "y", color=INK)
    title(panel, as_label(subject(result, output), width=50), said)
    return finish(panel)


def total_indices(running: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of `uq.running_estimates` that are total indices."""
    return running[running["kind"] == ST.key].dropna(subset="value")


def _curve(
    axes: Axes, lines: pd.DataFrame, per: float, colour: str, style: str, words: str
) -> None:
    samples, *numbers = _numbers(lines)
    value, low, high = (one / per for one in numbers)
    axes.plot(samples, value, color=colour, ls=style, marker=".", label=words)
    if np.isfinite(low).any():
        only = 0.8 if len(samples) == 1 else 0  # a band over one place has no width
        axes.fill_between(samples, low, high, color=colour, alpha=0.3, lw=only)


def _numbers(lines: pd.DataFrame) -> list[Floats]:
    """Return samples, values, low and high ends."""
    return [lines[name].to_numpy(float) for name in ("samples", "value", "low", "high")]


def _over_samples(axes: Axes, result: Result) -> str:
    """Draw the axis of samples, and return what the bands are."""
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_locator(LogLocator(base=2, numticks=6))
    axes.xaxis.set_major_formatter(lambda value, _: grouped(round(value)))
    axes.minorticks_off()
    replicates = int(result.dataset.attrs["replicates"])
    axes.set_xlabel("Samples" + (f" of each of {replicates} replicates" if replicates > 1 else ""))
    known = any(len(band.get_paths()) for band in axes.collections)
    return known * "with 95 % intervals"
