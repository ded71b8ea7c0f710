"""One thing that is expected under a heading of a dossier: its contents, or nothing."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from uq.render.html.cells import HtmlTable
from uq.render.html.indices import IndexTable
from uq.render.html.pictures import Picture


@dataclass(frozen=True)
class Item:
    """One thing that is expected under a heading.

    Attributes
    ----------
    title : str
    text : sequence of str
        Paragraphs.
    facts : sequence of tuple of str
        Names and values.
    tables : sequence of HtmlTable
    pictures : sequence of Picture
    subjects : sequence of IndexTable
        Indices.
    code : str
        Text as it stands in a file.
    html : Markup
    notes : sequence of str
        Small print: without the above, it provides nothing.
    """

    title: str
    text: Sequence[str] = ()
    facts: Sequence[tuple[str, str]] = ()
    tables: Sequence[HtmlTable] = ()
    pictures: Sequence[Picture] = ()
    subjects: Sequence[IndexTable] = ()
    code: str = ""
    html: Markup = Markup()
    notes: Sequence[str] = ()

    @property
    def is_provided(self) -> bool:
        """Whether there is anything but small print."""
        held = (self.text, self.facts, self.tables, self.pictures, self.subjects, self.code)
        return any((*held, self.html))
