"""Registry of the figures of a result, used by `uq plot` and the report, and all plot functions.

A figure is a function ``f(ds, output, *, axes=None)`` that returns a matplotlib figure: a new one,
or the figure of the given axes. To add a figure for results, write its file and add an entry to
`FIGURES`.
"""

import os
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from matplotlib.figure import Figure

from uq.assess.findings import Findings
from uq.errors import InputError, choices, nearest
from uq.files.whole_files import refuse_standard_output
from uq.render.figures import subjects
from uq.render.figures.catalogue import (
    Drawable,
    Entry,
    drawables,
    leading_drawables,
    named_drawables,
)
from uq.render.figures.convergence_plot import convergence as convergence
from uq.render.figures.convergence_plot import index_convergence as index_convergence
from uq.render.figures.distribution_plots import histogram as histogram
from uq.render.figures.distribution_plots import histogram_by_regime as histogram_by_regime
from uq.render.figures.distribution_plots import lifetime as lifetime
from uq.render.figures.figure import FORMATS, drawn_at, write
from uq.render.figures.index_plot import index_bars as index_bars
from uq.render.figures.index_plot import index_curves as index_curves
from uq.render.figures.input_plot import inputs as inputs
from uq.render.figures.life_plots import compared_lives as compared_lives
from uq.render.figures.life_plots import incidence as incidence
from uq.render.figures.life_plots import probability_paper as probability_paper
from uq.render.figures.motion_plot import history as history
from uq.render.figures.motion_plot import motion as motion
from uq.render.figures.motion_plot import phase_portrait as phase_portrait
from uq.render.figures.motion_plot import section as section
from uq.render.figures.panel import untitled
from uq.render.figures.quantile_table import quantile_table as quantile_table
from uq.render.figures.quantile_table import write_table
from uq.render.figures.response_plot import basins as basins
from uq.render.figures.response_plot import bifurcation as bifurcation
from uq.render.figures.response_plot import curve as curve
from uq.render.figures.scatter_plot import pairs as pairs
from uq.render.figures.scatter_plot import scatter as scatter
from uq.render.figures.share_plots import event_probability as event_probability
from uq.render.figures.share_plots import regime_shares as regime_shares
from uq.render.figures.share_plots import shares as shares
from uq.result.result import Result

FIGURES: dict[str, Entry] = {
    "lifetime": Entry(
        lifetime, subjects.outputs, applies=(subjects.is_lifetime,), needs=("summary",)
    ),
    "incidence": Entry(
        incidence,
        subjects.outputs,
        "Cumulative incidence by cause: {what}",
        applies=(subjects.has_causes,),
        leading=subjects.the_first,
    ),
    "paper": Entry(
        probability_paper,
        subjects.outputs,
        "Weibull paper: {what}",
        section="",
        applies=(subjects.has_weibull_law,),
        on_request=True,
    ),
    "histogram": Entry(
        histogram,
        subjects.outputs,
        applies=(subjects.is_no_lifetime,),
        in_report=(subjects.in_one_regime,),
        needs=("summary",),
    ),
    "regimes": Entry(
        histogram_by_regime,
        subjects.outputs,
        "{what}, by regime",
        applies=(subjects.in_regimes,),
        leading=subjects.the_first,
    ),
    "shares": Entry(
        shares,
        subjects.categories,
        "Shares: {what}",
        section="",
        leading=subjects.leading_categories,
    ),
    "events": Entry(
        event_probability,
        subjects.decided_events,
        "Probability that {event}, over its main driver",
        leading=subjects.events_of_the_first,
    ),
    "scatter": Entry(
        scatter,
        subjects.outputs,
        "{what}, against the inputs with which it varies most",
        applies=(subjects.has_plain_rows, subjects.has_inputs),
        leading=subjects.the_first,
    ),
    "convergence": Entry(
        convergence,
        subjects.outputs,
        "Convergence: {what}",
        section="convergence",
        applies=(subjects.has_running_estimate,),
        needs=("running",),
        on_request=True,
    ),
    "regime-shares": Entry(
        regime_shares,
        subjects.the_result,
        "Shares of the regimes over the inputs that best separate them",
        section="rows",
        applies=(subjects.in_regimes, subjects.has_enough_rows, subjects.has_plain_rows),
        leading=subjects.the_result_alone,
    ),
    "pairs": Entry(
        pairs,
        subjects.the_result,
        "Rows by regime, against the inputs that best separate the regimes",
        section="",
        applies=(subjects.in_regimes, subjects.has_several_inputs, subjects.has_plain_rows),
        on_request=True,
    ),
    "indices": Entry(
        index_bars,
        subjects.targets,
        "Sensitivity indices by {method}: {what}",
        section="",
        file=("method", "name"),
        leading=subjects.indices_of_the_first,
    ),
    "index-curves": Entry(
        index_curves,
        subjects.curves,
        "Sensitivity indices by {method}, along its dimension: {what}",
        on_request=True,
    ),
    "convergence-indices": Entry(
        index_convergence,
        subjects.crossed_targets,
        "Convergence of the total indices: {what}",
        section="convergence",
        needs=("running",),
        on_request=True,
    ),
    "inputs": Entry(
        inputs,
        subjects.inputs,
        "Inputs: stated laws and sampled values",
        section="inputs",
        on_request=True,
    ),
}
"""Figures of a result, in the order of `uq plot`; file names begin with their keys."""

TABLES: dict[str, Entry] = {
    "quantiles": Entry(
        quantile_table,
        subjects.outputs,
        "Quantiles: {what}",
        section="",
        needs=("summary",),
        on_request=True,
    ),
}
"""Tables of a result, which `uq plot` writes on request as CSV and LaTeX."""


def save_all(
    result: Result,
    folder: str | Path,
    *,
    only: Sequence[str] = (),
    outputs: Sequence[str] = (),
    every: bool = False,
    formats: Sequence[str] = ("png",),
    width: float | None = None,
    titles: bool = True,
) -> list[Path]:
    """Draw figures of a result into files: by default those about the subject of its study.

    Parameters
    ----------
    result : Result
        Result to draw.
    folder : path-like
        Created if it does not exist.
    only : sequence of str, optional
        Kinds of figures (keys of `FIGURES` and `TABLES`), or names of files without their suffix.
    outputs : sequence of str, optional
        Outputs to draw.
    every : bool
        Draw every figure that applies.
    formats : sequence of str
        Of ``png``, ``svg`` and ``pdf``. Tables are written as CSV and LaTeX.
    width : float, optional
        Width of each figure [m]; by default one or two columns of a journal (84 or 174 mm).
    titles : bool
        Whether to write titles; a journal has captions instead.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        The folder cannot be created or written to, or there is no such figure, output or format.
    """
    folder = Path(folder)
    refuse_standard_output(folder)
    for form in formats:
        if form not in FORMATS:
            raise InputError(f"no format '{form}' (allowed: {choices(FORMATS)})")
    chosen = _chosen(result, only, outputs, every)
    try:
        Path(os.path.realpath(folder)).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot create this folder: {error.strerror}; choose another with -o"
        ) from None
    files = []
    try:
        with drawn_at(None if width is None else width / _INCH):
            for drawable in chosen:
                drawn, path = drawable.draw(), folder / drawable.file
                if not isinstance(drawn, Figure):
                    files += write_table(drawn, path)
                    continue
                if not titles:
                    untitled(drawn)
                files += write(drawn, path, formats)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot write a figure: {error.strerror}; choose another folder with -o"
        ) from None
    return files


_INCH = 0.0254  # [m]


def _chosen(
    result: Result, only: Sequence[str], outputs: Sequence[str], every: bool
) -> list[Drawable]:
    """Return the figures to draw."""
    findings = Findings(result)
    for output in outputs:
        if output not in result.outputs:
            near = nearest(output, result.outputs)
            raise InputError(f"no output '{output}' in this result{near}")
    if only:
        drawn = named_drawables(FIGURES | TABLES, findings, only)
    elif every:
        drawn = list(drawables(FIGURES | TABLES, findings))
    else:
        groups: list[tuple[str, ...]] = [(output,) for output in outputs] or [
            subjects.leading_outputs(findings)
        ]
        leading = (leading_drawables(FIGURES, findings, group) for group in groups)
        return list(chain.from_iterable(leading))
    about = [drawable for drawable in drawn if not outputs or drawable.subject.output in outputs]
    if drawn and not about:
        raise InputError(f"no such figure of {choices(outputs)}")
    return about
