"""The figure of the probability of an event over the input that decides it."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.answer.answer import answer
from uq.assess.answer.parts import Event
from uq.assess.answer.wording import called
from uq.errors import InputError
from uq.render.figures.index_plot import output_of
from uq.render.figures.panel import column, finish, title
from uq.render.figures.style import INK, styled
from uq.render.figures.words import as_label, symbol_of
from uq.result.result import AnyResult, Result


@styled
def event_probability(
    result: AnyResult, output: str, *, event: Event | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the probability of an event in parts of the input that decides it, with 95 % intervals.

    The dashed line is the probability over all rows.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        The event, such as ``P(life<86400.0)`` or ``P(regime=periodic)``.
    event : Event, optional
        What is known of it, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When the study asks for no such event, or no input is known to decide it.
    """
    result = Result.of(result)
    event = event or next(
        (candidate for candidate in answer(result).events if candidate.name == output), None
    )
    if event is None or event.curve is None:
        raise InputError(f"'{output}': no input is known to decide it, or the study does not ask")
    curve, colour = event.curve, INK
    edges = curve.edges / event.over_unit.per
    value, low, high = np.array([share.numbers for share in curve.shares]).T
    clause = f"rows that {event.clause}"
    (panel,) = column(axes, 2.1)
    lower, upper = (np.append(end, end[-1]) for end in (low, high))  # one for each edge
    panel.stairs(value, edges, baseline=None, color=colour, lw=1.4, label="in parts of the input")
    words = "95 % intervals, pointwise"
    panel.fill_between(
        edges, lower, upper, step="post", color=colour, alpha=0.25, lw=0, label=words
    )
    panel.axhline(event.share.value, color="0.4", ls="--", lw=0.9, label="of all rows")
    panel.set(ylim=(-0.02, 1.02), ylabel="Share of rows")
    title(panel, *(as_label(line, width=46) for line in (output_of(result, event.name), clause)))
    over = called(event.over)  # as the sentence beside the figure does
    panel.set_xlabel(
        as_label(over, event.over_unit.name, symbol=symbol_of(result.dataset[event.over]))
    )
    return finish(panel)
