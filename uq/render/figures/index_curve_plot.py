"""The figure of sensitivity indices along a dimension of an output: its depths or times."""

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.assess.findings import Findings
from uq.assess.joint_targets import wholes
from uq.assess.ranked_indices import ranking, size
from uq.assess.sensitivities import TargetIndices, methods
from uq.assess.targets import FORMS, split_name
from uq.errors import InputError
from uq.render.figures.index_plot import range_of_indices
from uq.render.figures.panel import column, finish, heading, is_wide, logarithmic, roomy, title
from uq.render.figures.style import LINES, SHADES, styled
from uq.render.figures.words import as_label, labelled, place_in_words
from uq.result.result import AnyResult, Result
from uq.text.units import unit_of

FEWEST = 3
"""Along fewer coordinates there is no curve."""

_MOST_INPUTS = 4


def dimension_of(result: Result, output: str) -> str | None:
    """Return the dimension that indices of an output are drawn along; None if there is none.

    It is the one with most coordinates of those whose coordinates are numbers, three at least.
    """
    dims = [dim for dim in result.outputs[output].dims if result.dataset[dim].dtype.kind in "iuf"]
    longest = max(dims, key=lambda dim: result.dataset.sizes[dim], default=None)
    return longest if longest is not None and result.dataset.sizes[longest] >= FEWEST else None


@styled
def index_curves(
    result: AnyResult,
    output: str,
    *,
    method: str | None = None,
    findings: Findings | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Draw the indices of an output along its depths, times or the like, with 95 % bands.

    The legend gives the index of all elements together, the four largest first. A panel for each
    coordinate of the other dimensions.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        An output with a dimension of three or more numbers.
    method : str, optional
        By default the first that the study asks for; one that apportions a variance.
    findings : Findings, optional
        What is already known of the result.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.figure.Figure
        The bands are pointwise.

    Raises
    ------
    InputError
        When there is no such output or dimension, or there are no indices of all elements.
    """
    result = Result.of(result)
    findings = findings or Findings(result)
    method = method or methods(result)[0]
    elements = result.first_rows.named_elements(output)
    along = dimension_of(result, elements[0].output)
    if along is None or len(elements) < FEWEST:
        raise InputError(f"'{output}' has no dimension of {FEWEST} or more numbers")
    whole = findings.indices(method, next(wholes(elements)).name)
    if whole.refused:
        raise InputError(f"{whole.name}: {whole.refused}")
    kind, of_all = list(whole.kinds().items())[-1]
    leading = [name for name in ranking({kind: of_all})[:_MOST_INPUTS] if size(of_all[name]) > 0]
    form = split_name(whole.name)[0]
    panels: dict[str, list[tuple[float, TargetIndices]]] = {}
    for element in elements:
        others = {dim: at for dim, at in element.place.items() if dim != along}
        place = place_in_words(result, replace(element, place=others))
        name = f"{form}({element.name})" if form else element.name
        target_indices = findings.indices(method, name)
        panels.setdefault(place, []).append((float(element.place[along]), target_indices))
    unit = unit_of(
        result.dataset[along].attrs.get("units", "1"), float(np.abs(result.dataset[along]).max())
    )
    bands = ", with 95 % bands" if any(index.has_interval for index in of_all.values()) else ""
    drawn = column(axes, 0.6 + 1.5 * len(panels), len(panels))
    for panel, (place, points) in zip(drawn, panels.items(), strict=True):
        at = np.array([where for where, _ in points]) / unit.size
        for i, name in enumerate(leading):
            numbers = [
                target_indices.kinds()[kind][name].numbers
                if not target_indices.refused
                else (np.nan,) * 3
                for _, target_indices in points
            ]
            value, low, high = np.array(numbers).T
            style: Any = {"color": SHADES[i], "ls": LINES[i]}
            called = labelled(result.dataset[name], width=44)
            words = f"{called}: {kind.text(of_all[name].value)} all together"
            panel.plot(at, value, marker=".", ms=4, label=words, **style)
            panel.fill_between(at, low, high, color=SHADES[i], alpha=0.25, lw=0)
        panel.set_ylim(range_of_indices(panel.get_ylim()))
        title(panel, as_label(f"{kind.words}{bands}"), place)
    (logarithmic if is_wide(at) else roomy)(drawn[-1])
    drawn[-1].set_xlabel(labelled(result.dataset[along], unit.name))
    meaning = elements[0].meaning
    described = f"{FORMS[form]} of the {meaning.removeprefix('the ')}" if form else meaning
    heading(drawn[0], as_label(described, width=48))
    return finish(drawn[-1])
