"""Registry of the figures of a result, used by `uq plot` and the report, and all plot functions.

A figure is a function ``f(ds, output, *, axes=None)`` that returns a matplotlib figure: a new one,
or the figure of the given axes. To add a figure for results, write its file and add an entry to
`FIGURES`.
"""

import os
from pathlib import Path

from uq.assess.findings import Findings
from uq.errors import InputError
from uq.files.whole_files import refuse_standard_output
from uq.render.figures import subjects
from uq.render.figures.catalogue import Entry, drawables
from uq.render.figures.convergence_plot import convergence as convergence
from uq.render.figures.convergence_plot import index_convergence as index_convergence
from uq.render.figures.distribution_plots import histogram as histogram
from uq.render.figures.distribution_plots import histogram_by_regime as histogram_by_regime
from uq.render.figures.distribution_plots import lifetime as lifetime
from uq.render.figures.distribution_plots import quantile_table as quantile_table
from uq.render.figures.figure import write
from uq.render.figures.index_plot import index_bars as index_bars
from uq.render.figures.index_plot import index_curves as index_curves
from uq.render.figures.input_plot import inputs as inputs
from uq.render.figures.motion_plot import history as history
from uq.render.figures.motion_plot import motion as motion
from uq.render.figures.motion_plot import phase_portrait as phase_portrait
from uq.render.figures.motion_plot import section as section
from uq.render.figures.response_plot import basins as basins
from uq.render.figures.response_plot import bifurcation as bifurcation
from uq.render.figures.response_plot import curve as curve
from uq.render.figures.scatter_plot import pairs as pairs
from uq.render.figures.scatter_plot import scatter as scatter
from uq.render.figures.share_plots import event_probability as event_probability
from uq.render.figures.share_plots import shares as shares
from uq.result.result import Result

FIGURES: dict[str, Entry] = {
    "lifetime": Entry(
        lifetime, subjects.outputs, applies=(subjects.is_lifetime,), needs=("summary",)
    ),
    "histogram": Entry(
        histogram,
        subjects.outputs,
        applies=(subjects.is_no_lifetime,),
        in_report=(subjects.in_one_regime,),
        needs=("summary",),
    ),
    "regimes": Entry(
        histogram_by_regime, subjects.outputs, "{what}, by regime", applies=(subjects.in_regimes,)
    ),
    "quantiles": Entry(
        quantile_table, subjects.outputs, "Quantiles: {what}", section="", needs=("summary",)
    ),
    "shares": Entry(shares, subjects.categories, "Shares: {what}", section=""),
    "events": Entry(
        event_probability,
        subjects.decided_events,
        "Probability that {event}, over its main driver",
    ),
    "scatter": Entry(
        scatter,
        subjects.outputs,
        "{what}, against the inputs with which it varies most",
        applies=(subjects.has_plain_rows,),
    ),
    "convergence": Entry(
        convergence,
        subjects.outputs,
        "Convergence: {what}",
        section="convergence",
        applies=(subjects.has_running_estimate,),
        needs=("running",),
    ),
    "pairs": Entry(
        pairs,
        subjects.the_result,
        "Rows by regime, against the inputs that best separate the regimes",
        section="rows",
        applies=(subjects.in_regimes, subjects.has_several_inputs, subjects.has_plain_rows),
    ),
    "indices": Entry(
        index_bars,
        subjects.targets,
        "Sensitivity indices by {method}: {what}",
        section="",
        file=("method", "name"),
    ),
    "index-curves": Entry(
        index_curves,
        subjects.curves,
        "Sensitivity indices by {method}, along its dimension: {what}",
    ),
    "convergence-indices": Entry(
        index_convergence,
        subjects.crossed_targets,
        "Convergence of the total indices: {what}",
        section="convergence",
        needs=("running",),
    ),
    "inputs": Entry(
        inputs,
        subjects.inputs,
        "Inputs: stated laws and sampled values",
        section="inputs",
    ),
}
"""Figures of a result, in the order of `uq plot`; file names begin with their keys."""


def save_all(result: Result, folder: str | Path) -> list[Path]:
    """Draw every figure of a result, as PNG, SVG and PDF.

    Parameters
    ----------
    result : Result
        Result to draw.
    folder : path-like
        Created if it does not exist.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        The folder cannot be created or written to.
    """
    folder = Path(folder)
    refuse_standard_output(folder)
    try:
        Path(os.path.realpath(folder)).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot create this folder: {error.strerror}; choose another with -o"
        ) from None
    try:
        return [
            path
            for drawable in drawables(FIGURES, Findings(result))
            for path in write(drawable.draw(), folder / drawable.file)
        ]
    except OSError as error:
        raise InputError(
            f"{folder}: cannot write a figure: {error.strerror}; choose another folder with -o"
        ) from None
