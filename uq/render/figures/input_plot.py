"""The figure of the inputs: the stated law of each, and its sampled values."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.row_inputs import EVERYWHERE
from uq.assess.sampled_laws import laws_and_values, weights_of_samples
from uq.errors import InputError, choices
from uq.render.figures.elements_plot import bins, densities, input_axis
from uq.render.figures.figure import INK, ROWS, styled
from uq.render.figures.panel import figure_of, grid, logarithmic, roomy, whole_numbers
from uq.render.figures.words import as_label
from uq.result.elements import Floats
from uq.result.result import AnyResult, Result
from uq.sampling.law import Law
from uq.sampling.truncation import cdf_within
from uq.text.numbers import grouped, printed

_IN_ONE_COLUMN = 2  # inputs


@styled
def inputs(
    result: AnyResult, *, names: Sequence[str] | None = None, axes: Axes | None = None
) -> Figure:
    """Draw the distribution of each input, with its stated law.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    names : sequence of str, optional
        Inputs; by default all.
    axes : matplotlib.axes.Axes, optional
        Where to draw: panels divide its area. By default a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        When the rows do not follow the laws.
    """
    result = Result.of(result)
    distributions, weights = laws_and_values(result), weights_of_samples(result)
    if not distributions:
        raise InputError(f"the rows of a '{result.design_name}' design do not follow the laws")
    if unknown := [name for name in names or () if name not in distributions]:
        raise InputError(f"no such input '{unknown[0]}' (allowed: {choices(distributions)})")
    distributions = {name: distributions[name] for name in names or distributions}
    columns = 1 if len(distributions) <= _IN_ONE_COLUMN else 2
    lines = -(-len(distributions) // columns)
    panels = grid(axes, 0.3 + 1.4 * lines, lines, columns).ravel()
    for panel in panels[len(distributions) :]:
        panel.set_axis_off()
    for panel, (name, (law, values)) in zip(panels, distributions.items(), strict=False):
        width = 44 if columns == 1 else 20
        per = 1.0
        if law.times is None:
            per = input_axis(panel, result, name, width)
        else:
            factor = f"{result.dataset[name].attrs['long_name']}: factor on {law.times}"
            panel.set_xlabel(as_label(factor, width=width))
        edges, wide = bins(values)
        edges[0], edges[-1] = min(edges[0], values.min()), max(edges[-1], values.max())
        worth = np.ones(len(values)) if weights is None else weights
        shares = np.histogram(values, edges, weights=worth)[0] / worth.sum()
        sampled = densities(shares, edges / per, wide)
        stated = densities(_stated_shares(law, edges), edges / per, wide)
        panel.stairs(sampled, edges / per, fill=True, color=ROWS)
        panel.stairs(stated, edges / per, color=INK, lw=1.0)
        panel.set_ylim(0, None)
        whole_numbers(panel.yaxis)
        panel.locator_params(axis="y", nbins=3)
        roomy(panel, 6 // columns)
        if wide:
            logarithmic(panel)
    count = len(next(iter(distributions.values()))[1])
    rows = f"{grouped(count)}{' weighted' if weights is not None else ''} {result.row_name[1]}"
    several = len(result.independent) > count
    of_samples = ", one of each sample" * several
    caption = f"Density of {rows}{of_samples}; line: stated law"
    panels[0].set_title(textwrap.fill(printed(caption), 50).replace("\u00a0", " "), loc="left")
    return figure_of(panels[0])


def _stated_shares(law: Law, edges: Floats) -> Floats:
    """Return the probability of each bin; only the last bin includes its upper end."""
    upper = cdf_within(law, np.append(np.nextafter(edges[1:-1], -np.inf), edges[-1]), EVERYWHERE)
    lower = cdf_within(law, np.nextafter(edges[:1], -np.inf), EVERYWHERE)
    return np.diff(np.append(lower, upper))
