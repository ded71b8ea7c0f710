"""Figures of shares of the rows: by label, and of an event over its leading input."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.answer.answer import answer
from uq.assess.answer.events import Event
from uq.assess.answer.wording import called
from uq.assess.summary import REGIME, category_shares
from uq.errors import InputError
from uq.render.figures.elements_plot import occurring_regimes
from uq.render.figures.figure import BARS, INK, styled
from uq.render.figures.index_plot import output_of
from uq.render.figures.panel import column, finish, title
from uq.render.figures.words import as_label, literal, symbol_of
from uq.result.result import AnyResult, Result
from uq.text.numbers import counted


@styled
def shares(result: AnyResult, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw the share of rows with each label of a category, with 95 % intervals.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        A category, such as ``regime``, or one element of it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When the output is not a category.
    """
    result = Result.of(result)
    name = output.partition("[")[0]
    if not result.is_category(name):
        raise InputError(f"'{output}' is no category of this result")
    rows = result.independent
    by_element = {
        element: category_shares(rows, element, rows.weights) for element in rows.codes(output)
    }
    labels = [
        label
        for label in next(iter(by_element.values()))
        if any(statistics[label].facts["count"] for statistics in by_element.values())
    ]
    regimes = occurring_regimes(rows) if name == REGIME else {}
    (panel,) = column(axes, 0.9 + 0.22 * len(labels) * max(len(by_element), 1.5))
    thickness = 0.8 / len(by_element)
    for i, (element, statistics) in enumerate(by_element.items()):
        y = np.arange(len(labels))[::-1] + thickness * ((len(by_element) - 1) / 2 - i)
        numbers = [statistics[label].estimate.numbers for label in labels]
        value, low, high = np.array(numbers, dtype=float).T
        colours = [
            regimes[literal(label)][1] if literal(label) in regimes else BARS[i % len(BARS)]
            for label in labels
        ]
        place = element.partition("[")[2].removesuffix("]")
        panel.barh(y, value, thickness, color=colours, label=place.replace(",", ", "))
        panel.hlines(y, low, high, color=INK, lw=0.8)
    panel.set_yticks(np.arange(len(labels))[::-1], list(map(literal, labels)))
    has_intervals = any(
        statistics[label].estimate.has_interval
        for statistics in by_element.values()
        for label in labels
    )
    panel.set(xlim=(0, 1), xlabel="Share of rows" + has_intervals * ", with 95 % interval")
    meaning = as_label(str(result.dataset[name].attrs["long_name"]), width=46)
    title(panel, meaning, counted(len(rows), "row"))
    return finish(panel)


@styled
def event_probability(
    result: AnyResult, output: str, *, event: Event | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the probability of an event in bins of its main driver, with 95 % intervals.

    The dashed line is the probability over all rows.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        The event, such as ``P(life<86400.0)`` or ``P(regime=periodic)``.
    event : Event, optional
        Estimates for this event, if already computed.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When the study does not request this event, or no main driver is identified.
    """
    result = Result.of(result)
    event = event or next(
        (candidate for candidate in answer(result).events if candidate.name == output), None
    )
    if event is None or event.curve is None:
        raise InputError(f"'{output}': it has no main driver, or the study does not ask")
    curve, colour = event.curve, INK
    edges = curve.edges / event.over_unit.per
    value, low, high = np.array([share.numbers for share in curve.shares]).T
    clause = f"rows that {event.clause}"
    (panel,) = column(axes, 2.1)
    lower, upper = (np.append(end, end[-1]) for end in (low, high))  # one per edge
    panel.stairs(value, edges, baseline=None, color=colour, lw=1.4, label="in parts of the input")
    words = "95 % intervals, pointwise"
    panel.fill_between(
        edges, lower, upper, step="post", color=colour, alpha=0.25, lw=0, label=words
    )
    panel.axhline(event.share.value, color="0.4", ls="--", lw=0.9, label="of all rows")
    panel.set(ylim=(-0.02, 1.02), ylabel="Share of rows")
    title(panel, *(as_label(line, width=46) for line in (output_of(result, event.name), clause)))
    over = called(event.over)  # consistent with the sentence beside the figure
    panel.set_xlabel(
        as_label(over, event.over_unit.name, symbol=symbol_of(result.dataset[event.over]))
    )
    return finish(panel)
