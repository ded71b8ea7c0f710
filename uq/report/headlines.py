"""The head of a report: the answer of the study, beside the figure of what it is about."""

from markupsafe import Markup

from uq.conclusions.page import fragment
from uq.conclusions.whole import Answer
from uq.report.pictures import Picture

_FIGURE = Markup("<figure{}>{}</figure>")  # the verdict says of what


def headline(found: Answer, drawn: list[Picture]) -> Markup:
    """Return the answer as HTML; takes the figure that it shows out of those drawn.

    Parameters
    ----------
    found : Answer
    drawn : list of Picture
        The figures of the results.
    """
    lead = found.lead
    own = [one for one in drawn if lead is not None and one.of.name == lead.output]
    if not own:
        return fragment(found)
    drawn.remove(own[0])
    kind = Markup(' class="image"') if own[0].is_image else ""
    return fragment(found, _FIGURE.format(kind, own[0].html))
