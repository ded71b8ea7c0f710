"""All the figures that a study asks for, each of which can be had alone for a notebook."""

import os
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from uq.analysis.convergence import running_estimates
from uq.analysis.summary import summarise
from uq.drawing.convergence_plot import convergence, index_convergence
from uq.drawing.elements_plot import occurring_regimes
from uq.drawing.figure import file_name, write
from uq.drawing.histogram_plot import histogram, histogram_by_regime
from uq.drawing.index_plot import bars, index_bars, subject
from uq.drawing.input_plot import inputs
from uq.drawing.lifetime_plot import lifetime
from uq.drawing.quantile_plot import quantile_table
from uq.drawing.scatter_plot import pairs, scatter
from uq.errors import InputError
from uq.indices.independent_inputs import independent_inputs
from uq.indices.sensitivities import methods, sensitivities
from uq.places import refuse_standard_output
from uq.rows.elements import analysis_of, independent_rows, shown_outputs
from uq.rows.variables import outputs_of

__all__ = [
    "convergence",
    "histogram",
    "histogram_by_regime",
    "index_bars",
    "inputs",
    "lifetime",
    "pairs",
    "quantile_table",
    "save_all",
    "scatter",
]


def save_all(ds: xr.Dataset, folder: str | Path) -> list[Path]:
    """Draw every figure of a result, as PNG, SVG and PDF.

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
    refuse_standard_output(folder)
    try:
        Path(os.path.realpath(folder)).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot make this folder: {error.strerror}; choose another with -o"
        ) from None
    try:
        return [path for name, figure in _figures(ds) for path in write(figure, folder / name)]
    except OSError as error:
        raise InputError(
            f"{folder}: cannot write a figure: {error.strerror}; choose another folder with -o"
        ) from None


def _figures(ds: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    declared = outputs_of(ds)
    shown = shown_outputs(ds, analysis_of(ds))
    numbers = [output for output in shown if not declared[output].is_category]
    rows = independent_rows(ds)
    drawn = numbers if rows.sizes["sample"] else []
    several = len(occurring_regimes(rows)) > 1
    entries = summarise(ds).outputs if drawn else {}
    running = running_or_none(ds) if drawn else None
    for output in drawn:
        if declared[output].is_lifetime:
            yield file_name("lifetime", output), lifetime(ds, output)
        else:
            yield file_name("histogram", output), histogram(ds, output)
        if several:
            yield file_name("regimes", output), histogram_by_regime(ds, output)
        yield file_name("quantiles", output), quantile_table(ds, output, entries)
        yield file_name("scatter", output), scatter(ds, output)
        if running is not None and (figure := convergence(ds, output, running)) is not None:
            yield file_name("convergence", output), figure
    if several and len(independent_inputs(rows)) > 1:
        yield "pairs", pairs(ds)
    for method in methods(ds):
        for name, found in sensitivities(ds, method).targets.items():
            if not found.refused:
                yield file_name(method, name), bars(ds, found)
    if running is not None:
        for name in running["output"].unique():
            figure = index_convergence(ds, name, running, subject(ds, name))
            if figure is not None:
                yield file_name("convergence", "indices", name), figure
    if numbers and (figure := inputs(ds)) is not None:
        yield "inputs", figure


def running_or_none(ds: xr.Dataset) -> pd.DataFrame | None:
    """Return estimates as the rows came in; None where the first rows are no design."""
    try:
        return running_estimates(ds)
    except InputError:
        return None
