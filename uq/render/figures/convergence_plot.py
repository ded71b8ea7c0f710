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
from uq.render.figures.figure import INK, LINES, SHADES, styled
from uq.render.figures.index_plot import range_of_indices, subject
from uq.render.figures.panel import arrows, column, finish, title, whole_numbers
from uq.render.figures.words import as_label, label, labelled
from uq.result.elements import Floats
from uq.result.result import AnyResult, Result
from uq.text.numbers import grouped

_MOST_INPUTS = 6
_MARKS = "os^vDP"
_APART = 0.06  # offset between inputs, as a fraction of the distance of a doubled sample size


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
        Return value of `uq.running_estimates`, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The intervals are pointwise.

    Raises
    ------
    InputError
        When the first rows of the design do not form a design, or neither estimate exists.
    """
    result = Result.of(result)
    running = running_estimates(result) if running is None else running
    kind, estimates = followed(result, output, running)
    if not kind:
        raise InputError(f"{output}: neither its mean nor its median can be estimated")
    chosen, part = drawn_elements(result.independent, output)
    unit = display_unit(chosen[0].units, np.concatenate([element.values for element in chosen]))
    (panel,) = column(axes, 2.1)
    for i, element in enumerate(chosen):
        colour, line = curve_style(i, element, chosen)
        samples, *numbers = _numbers(estimates[estimates["output"] == element.name])
        value, low, high = (series / unit.size for series in numbers)
        words = label(result, element)
        panel.plot(samples, value, color=colour, ls=line, marker=".", label=words)
        if np.isfinite(low).any():
            only = 0.8 if len(samples) == 1 else 0  # a band over a single point has no width
            panel.fill_between(samples, low, high, color=colour, alpha=0.3, lw=only)
    statistic = "mean" if kind == "mean" else "median"
    bands = _over_samples(panel, result)
    if bands and not np.isfinite(estimates[["low", "high"]].astype(float)).all(axis=None):
        bands += " where the rows allow one"
    whole_numbers(panel.yaxis)
    wide, narrow = (
        as_label(f"{statistic}: {chosen[0].meaning}", unit.name, width) for width in (46, 26)
    )
    title(panel, wide, part, bands, quantity=narrow)
    return finish(panel)


def followed(result: Result, output: str, running: pd.DataFrame) -> tuple[str, pd.DataFrame]:
    """Return the estimator that `convergence` draws ("" if none), and its running estimates."""
    names = [element.name for element in result.independent.named_elements(output)]
    estimates = running[running["output"].isin(names)]
    estimates = estimates[np.isfinite(estimates["value"].astype(float))]
    # With lives that never end, the first rows may have a finite mean although all rows have none.
    of_all = (
        estimates[estimates["samples"] == running["samples"].max()]
        .groupby("estimate")["output"]
        .nunique()
    )
    kind = max(("mean", "quantile 0.5"), key=lambda estimate: of_all.get(estimate, 0))
    return kind if kind in of_all else "", estimates[estimates["estimate"] == kind]


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
    totals = total_indices(running)
    totals = totals[totals["output"] == output]
    if totals.empty:
        raise InputError(f"{output}: no total indices of fewer rows are known")
    last = totals[totals["samples"] == totals["samples"].max()].sort_values(
        "value", ascending=False
    )
    leading = last["input"].tolist()[:_MOST_INPUTS]
    (panel,) = column(axes, 2.1)
    ends = []
    for i, name in enumerate(leading):
        samples, value, low, high = _numbers(totals[totals["input"] == name])
        samples = samples * 2 ** (_APART * (i - (len(leading) - 1) / 2))
        colour, line = SHADES[i % len(SHADES)], LINES[(i + i // len(SHADES)) % len(LINES)]
        style: Any = {"color": colour, "ls": line, "marker": _MARKS[i], "ms": 3}
        panel.plot(samples, value, label=labelled(result.dataset[name], width=60), **style)
        bounded = np.isfinite(low)
        panel.vlines(samples[bounded], low[bounded], high[bounded], color=colour, lw=0.8)
        ends.append((samples, low, high))
    panel.set_ylabel("Total index (ST)")
    panel.set_ylim(range_of_indices(panel.get_ylim()))
    bands = _over_samples(panel, result)
    for interval in ends:
        arrows(panel, *interval, "y", color=INK)
    title(panel, as_label(subject(result, output), width=50), bands)
    return finish(panel)


def total_indices(running: pd.DataFrame) -> pd.DataFrame:
    """Return the total indices among the lines of `uq.running_estimates`."""
    return running[running["kind"] == ST.key].dropna(subset="value")


def _numbers(lines: pd.DataFrame) -> list[Floats]:
    """Return the sample sizes, estimates, and lower and upper interval ends."""
    return [lines[name].to_numpy(float) for name in ("samples", "value", "low", "high")]


def _over_samples(axes: Axes, result: Result) -> str:
    """Label the axis of sample size, and return the note on intervals for the title."""
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_locator(LogLocator(base=2, numticks=6))
    axes.xaxis.set_major_formatter(lambda value, _: grouped(round(value)))
    axes.minorticks_off()
    replicates = int(result.dataset.attrs["replicates"])
    axes.set_xlabel("Samples" + (f" of each of {replicates} replicates" if replicates > 1 else ""))
    has_bands = any(len(band.get_paths()) for band in axes.collections)
    return has_bands * "with 95 % intervals"
