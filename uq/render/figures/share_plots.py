"""Figures of shares of the rows: by label, by regime over inputs, of an event over its driver."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.answer.answer import answer
from uq.assess.answer.events import Event
from uq.assess.answer.wording import called
from uq.assess.row_inputs import independent_inputs
from uq.assess.summary import REGIME, category_shares
from uq.errors import InputError
from uq.render.figures.elements_plot import occurring_regimes
from uq.render.figures.figure import BAND, BARS, INK, WIDTH, styled, width_or
from uq.render.figures.index_plot import output_of
from uq.render.figures.panel import (
    column,
    finish,
    grid,
    is_wide,
    logarithmic,
    roomy,
    title,
)
from uq.render.figures.words import as_label, input_label, literal, symbol_of
from uq.result.result import AnyResult, Result
from uq.text.numbers import percent

_MOST_SLICES, _ROWS_OF_SLICE = 12, 20
_ROOM = 1.2  # height of an axis of shares relative to the largest
_SIDE_BY_SIDE = 5.0  # width from which panels stand side by side [inch]


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
    xlabel = f"Share of {result.row_name[1]}" + has_intervals * ", with 95 % interval"
    panel.set(xlim=(0, 1), xlabel=xlabel)
    meaning = as_label(str(result.dataset[name].attrs["long_name"]), width=46)
    title(panel, meaning, result.counted_rows(len(rows)))
    return finish(panel)


@styled
def regime_shares(result: AnyResult, *, axes: Axes | None = None) -> Figure:
    """Draw the share of each regime over the two inputs that best separate the regimes.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of a model with regimes and at least one uncertain input.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When there are no regimes, no input varies, or there are too few rows.
    """
    result = Result.of(result)
    result.refuse_if_weighted("shares of regimes over inputs")
    rows = result.independent
    regimes, inputs = occurring_regimes(rows), independent_inputs(rows)
    if not regimes or not inputs:
        raise InputError("shares of regimes need a model with regimes and an uncertain input")
    codes = rows.dataset["regime"].values
    has_regime = np.isin(codes, [code for code, _ in regimes.values()])
    count = min(_MOST_SLICES, int(has_regime.sum()) // _ROWS_OF_SLICE)
    if count < 2:
        raise InputError(f"shares of regimes need at least {2 * _ROWS_OF_SLICE} rows")
    slices_of = {
        name: np.array_split(np.argsort(x[has_regime], kind="stable"), count)
        for name, x in inputs.items()
    }
    shares_of = {
        name: {
            words: np.array([np.mean(codes[has_regime][part] == code) for part in slices])
            for words, (code, _) in regimes.items()
        }
        for name, slices in slices_of.items()
    }

    def spread(name: str) -> float:
        return float(sum(np.var(share) for share in shares_of[name].values()))

    names = sorted(inputs, key=spread, reverse=True)[:2]
    side_by_side = width_or(WIDTH) > _SIDE_BY_SIDE
    shape = (1, len(names)) if side_by_side else (len(names), 1)
    panels = grid(axes, 0.4 + 1.55 * shape[0], *shape).ravel()
    for panel, name in zip(panels, names, strict=True):
        x = inputs[name][has_regime] / result.input_unit(name).size
        slices = slices_of[name]
        edges = [x[rows_of_slice[0]] for rows_of_slice in slices] + [x[slices[-1][-1]]]
        base = np.zeros(count)
        for words, (_, colour) in regimes.items():
            top = base + shares_of[name][words]
            panel.stairs(top, edges, baseline=base, fill=True, color=colour, label=words)
            base = top
        wide = is_wide(x)
        logarithmic(panel) if wide else roomy(panel, 4 if side_by_side else 6)
        panel.set(xlim=(edges[0], edges[-1]), ylim=(0, 1))
        panel.set_ylabel(f"Share of {result.row_name[1]}")
        unit = result.input_unit(name).name
        panel.set_xlabel(input_label(result.dataset[name], unit, 40))
    of_each = int(has_regime.sum()) // count
    title(panels[0], f"{result.counted_rows(len(rows))}, in slices of {of_each}")
    return finish(panels[0])


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
    clause = f"{result.row_name[1]} that {event.clause}"
    (panel,) = column(axes, 2.1)
    lower, upper = (np.append(end, end[-1]) for end in (low, high))  # one per edge
    panel.stairs(value, edges, baseline=None, color=colour, lw=1.4, label="slices of the input")
    words = "95 % intervals"
    panel.fill_between(edges, lower, upper, step="post", color=BAND, alpha=0.35, lw=0, label=words)
    panel.axhline(
        event.share.value,
        color="0.4",
        ls="--",
        lw=0.9,
        label=f"all {result.row_name[1]}: {percent(event.share.value)}",
    )
    top = min(1.02, _ROOM * max(np.nanmax(high), event.share.value))
    panel.set(ylim=(-0.02 * top, top), ylabel=f"Share of {result.row_name[1]}")
    title(panel, *(as_label(line, width=46) for line in (output_of(result, event.name), clause)))
    over = called(event.over)  # consistent with the sentence beside the figure
    panel.set_xlabel(
        as_label(over, event.over_unit.name, symbol=symbol_of(result.dataset[event.over]))
    )
    return finish(panel)
