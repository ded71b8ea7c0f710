"""The scatter plot that a page shows first."""

from collections.abc import Sequence

from uq.assess.answer.parts import Quantity
from uq.contract import Floats
from uq.render.figures.scatter_plot import leading
from uq.result.element import Element
from uq.study.file import AnalysisTable


def first_element(
    elements: Sequence[Element], answered: Sequence[Quantity], analysis: AnalysisTable
) -> int:
    """Return the place of the element shown first.

    Parameters
    ----------
    elements : sequence of Element
    answered : sequence of Quantity
        The one that the study is about first.
    analysis : AnalysisTable

    Returns
    -------
    int
        Without an answer, of one that the study asks about, a life first.
    """
    about = answered[0].name if answered else ""
    return max(
        range(len(elements)),
        key=lambda i: (
            elements[i].name == about,
            elements[i].output in analysis.thresholds,
            elements[i].is_lifetime,
            -i,
        ),
    )


def first_input(inputs: dict[str, Floats], element: Element, answered: Sequence[Quantity]) -> str:
    """Return the input that the answer names as contributing most to an element.

    Where it names none, that over which the mean rank of the element varies most.
    """
    quantities = [quantity for quantity in answered if quantity.name == element.name]
    events = [event for quantity in quantities for event in quantity.events]
    rankings = [quantity.ranking for quantity in quantities] + [event.ranking for event in events]
    leaders = [ranking.leader for ranking in rankings if ranking is not None]
    named = [name for leader in leaders if leader for name in leader.inputs if name in inputs]
    return (named or leading(inputs, element))[0]
