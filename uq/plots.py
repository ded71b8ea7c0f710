"""Figures of a result: lifetimes, histograms, and all that a study asks for."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.elements import (
    Element,
    Floats,
    analysis_of,
    independent_rows,
    named_elements,
    shown_outputs,
)
from uq.errors import InputError
from uq.figure import (
    COLOURS,
    LINES,
    file_name,
    is_wide,
    legend,
    logarithmic,
    new_figure,
    place_in_words,
    sentence,
    styled,
    thinned,
    write,
)
from uq.index_plot import bars
from uq.indices import methods, sensitivities
from uq.input_plot import inputs
from uq.lifetime import survival
from uq.time_units import time_unit


def save_all(ds: xr.Dataset, folder: str | Path) -> list[Path]:
    """Draw every figure of a result, as PNG and SVG.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    folder : path-like
        Made if it does not exist.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        When the folder cannot be made or written to.
    """
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot make this folder: {error.strerror}") from None
    try:
        return [path for name, figure in _figures(ds) for path in write(figure, folder / name)]
    except OSError as error:
        raise InputError(f"{folder}: cannot write a figure: {error.strerror}") from None


def _figures(ds: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    kinds = {output: ds[output].attrs["kind"] for output in shown_outputs(ds, analysis_of(ds))}
    numbers = {output: kind for output, kind in kinds.items() if kind != "category"}
    drawn = numbers if independent_rows(ds).sizes["sample"] else {}
    for output, kind in drawn.items():
        if kind == "lifetime":
            yield file_name("lifetime", output), lifetime(ds, output)
        else:
            yield file_name("histogram", output), histogram(ds, output)
    for method in methods(ds):
        for name, entry in sensitivities(ds, method)["outputs"].items():
            if "refused" not in entry:
                yield file_name(method, name), bars(ds, name, entry)
    if numbers and (figure := inputs(ds)) is not None:
        yield "inputs", figure


@styled
def lifetime(ds: xr.Dataset, output: str) -> Figure:
    """Draw the probability that a life has ended against time, with its pointwise 95 % band.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        A lifetime, or one element of it.

    Returns
    -------
    matplotlib.figure.Figure
    """
    chosen = named_elements(independent_rows(ds), output)
    ends = np.concatenate([e.values[np.isfinite(e.values)] for e in chosen])
    unit = time_unit(float(np.median(ends)) if len(ends) else 0.0)
    figure, (axes,) = new_figure(2.3, entries=len(chosen))
    for i, element in enumerate(chosen):
        curve = survival(ds, element.name)
        curve = curve.isel(time=thinned(curve.sizes["time"]))
        time = curve["time"].values / unit.seconds
        colour, line = _look(i, element, chosen)
        label = _label(ds, element, never=float(curve["never"]))
        axes.step(time, 1 - curve["survival"], where="post", color=colour, ls=line, label=label)
        low, high = 1 - curve["high"], 1 - curve["low"]
        if np.isfinite(low).any():
            axes.fill_between(time, low, high, step="post", color=colour, alpha=0.2, lw=0)
    axes.set(ylim=(0, 1.02), ylabel="Probability that\nthe life has ended")
    axes.set_xlabel(sentence(chosen[0].meaning, unit.name))
    if is_wide(ends):
        logarithmic(axes)
    _explain(axes, chosen, *["pointwise 95 % band"] * bool(axes.collections))
    return figure


@styled
def histogram(ds: xr.Dataset, output: str) -> Figure:
    """Draw how the values of an output are distributed.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str
        An output that is not a lifetime or category, or one element of it.

    Returns
    -------
    matplotlib.figure.Figure
    """
    chosen = named_elements(independent_rows(ds), output)
    values = [element.at_least for element in chosen]
    together = np.concatenate(values)
    figure, (axes,) = new_figure(2.1, entries=len(chosen))
    edges, wide = _bins(together)
    for i, (element, own) in enumerate(zip(chosen, values, strict=True)):
        colour, line = _look(i, element, chosen)
        counts = np.histogram(own, edges)[0] / max(len(own), 1)
        alone = len(chosen) == 1
        axes.stairs(
            counts,
            edges,
            fill=alone,
            color=colour,
            ls="-" if alone else line,
            lw=0 if alone else 1.2,
            label=_label(ds, element),
        )
    axes.set(ylim=(0, None), ylabel="Share of rows per bin")
    axes.set_xlabel(sentence(chosen[0].meaning, chosen[0].units))
    if wide:
        logarithmic(axes)
    _explain(axes, chosen)
    return figure


def _bins(values: Floats) -> tuple[Floats, bool]:
    """Return the edges of bins for a histogram, and whether its axis is logarithmic."""
    if len(values) == 0:
        return np.array([0.0, 1.0]), False
    wide = is_wide(values)
    scaled = np.log10(values) if wide else values
    count = len(np.histogram_bin_edges(scaled, "scott")) - 1
    edges = np.histogram_bin_edges(scaled, min(count, 60))
    return (10**edges if wide else edges), wide


def _look(i: int, element: Element, chosen: Sequence[Element]) -> tuple[str, str]:
    """Return colour and line of a curve: of two dimensions the first chooses the line."""
    if len(element.place) < 2:
        return COLOURS[i % len(COLOURS)], LINES[i // len(COLOURS) % len(LINES)]
    firsts = list(dict.fromkeys(next(iter(one.place.values())) for one in chosen))
    per_first = len(chosen) // len(firsts)
    line = firsts.index(next(iter(element.place.values())))
    return COLOURS[i % per_first % len(COLOURS)], LINES[line % len(LINES)]


def _label(ds: xr.Dataset, element: Element, never: float = 0.0) -> str:
    words = place_in_words(element, ds[element.output])
    if never > 0:
        words += f"{', ' if words else ''}never: {never:.1%}"
    return words


def _explain(axes: Axes, chosen: Sequence[Element], *more: str) -> None:
    """Say which curve is which, how many rows take part, and what more there is to say."""
    first = chosen[0]
    counts = [f"{len(first.values)} rows"]
    for state in ("failed", "undefined", "censored"):
        most = max(int(getattr(element, state).sum()) for element in chosen)
        if most:
            counts.append(f"{'up to ' if len(chosen) > 1 else ''}{most} {state}")
    axes.set_title(", ".join([*counts, *more]), loc="left")
    legend(axes)
