"""The figure of the shares of a category."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.summary import REGIME, category_shares
from uq.errors import InputError
from uq.render.figures.elements_plot import occurring_regimes
from uq.render.figures.panel import column, finish, title
from uq.render.figures.style import BARS, INK, styled
from uq.render.figures.words import as_label, literal
from uq.result.result import AnyResult, Result
from uq.text.numbers import counted


@styled
def shares(result: AnyResult, output: str, *, axes: Axes | None = None) -> Figure:
    """Draw the share of the rows in each label of a category, with 95 % intervals.

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
        When it is no category.
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
