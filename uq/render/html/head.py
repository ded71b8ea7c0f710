"""The head of a report: the answer of the study, beside the figure of what it is about."""

from markupsafe import Markup

from uq.assess.answer.facts import Answer
from uq.render.html.answer import fragment
from uq.render.html.pictures import Picture

_FIGURE = Markup("<figure{}>{}</figure>")  # the verdict says of what


def headline(found: Answer, drawn: list[Picture], by_regime: list[Picture]) -> Markup:
    """Return the answer as HTML; takes the figure that it shows out of those drawn.

    Parameters
    ----------
    found : Answer
    drawn : list of Picture
        The figures of the results.
    by_regime : list of Picture
        The figures of the rows by their regimes, which the answer may be about.
    """
    lead = found.lead
    own = [(drawn, one) for one in drawn if lead is not None and one.of.name == lead.output]
    if found.regimes_first:
        own = [*((by_regime, one) for one in by_regime), *own]
    if not own:
        return fragment(found)
    among, shown = own[0]
    among.remove(shown)
    kind = Markup(' class="image"') if shown.is_image else ""
    return fragment(found, _FIGURE.format(kind, shown.html))
