"""The head of a report: the answer of the study, beside the figure of what it is about."""

from markupsafe import Markup

from uq.assess.answer.facts import Answer
from uq.render.html.answer import fragment
from uq.render.html.pictures import Picture

_FIGURE = Markup("<figure{}>{}</figure>")  # the verdict says of what


def headline(answer: Answer, drawn: list[Picture], by_regime: list[Picture]) -> Markup:
    """Return the answer as HTML; takes the figure that it shows out of those drawn.

    Parameters
    ----------
    answer : Answer
    drawn : list of Picture
        The figures of the results.
    by_regime : list of Picture
        The figures of the rows by their regimes, which the answer may be about.
    """
    lead = answer.lead
    figures = [
        (drawn, figure) for figure in drawn if lead is not None and figure.subject == lead.output
    ]
    if answer.regimes_first:
        figures = [*((by_regime, figure) for figure in by_regime), *figures]
    if not figures:
        return fragment(answer)
    among, shown = figures[0]
    among.remove(shown)
    kind = Markup(' class="image"') if shown.is_image else ""
    return fragment(answer, _FIGURE.format(kind, shown.html))
