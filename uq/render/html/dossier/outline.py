"""Headings of a dossier, the documents that they follow, and the items expected under them.

The headings are the topics on which RG 1.245 asks a submittal to report (its section C.2), in that
order, and the conclusions of NUREG/CR-7278, its technical basis; JCGM 101 adds what belongs to the
propagation of distributions. Of both documents of the NRC, purpose, graded approach and their
relation were read again for this outline, but the text of section C.2 was not at hand: its topics
have not been compared word for word, their finer numbers are not given, and a draft revision of the
guide (DG-1422, February 2024) is not followed. Check the guide before a submittal relies on it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from markupsafe import Markup

from uq.assess.findings import Findings
from uq.render.html.cells import HtmlTable
from uq.render.html.indices import IndexTable
from uq.render.html.pictures import Picture


@dataclass(frozen=True)
class Item:
    """Item expected under a heading.

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
        Sensitivity indices.
    code : str
        Verbatim text of a file.
    html : Markup
    notes : sequence of str
        Small print; an item with only notes is not provided.
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
        """Whether the item has any content besides small print."""
        held = (self.text, self.facts, self.tables, self.pictures, self.subjects, self.code)
        return any((*held, self.html))


class Heading(NamedTuple):
    """Heading of a dossier.

    Attributes
    ----------
    source : callable
        Findings, file name -> items under the heading; its name is the heading's id in a page.
    title : str
    after : tuple of str
        References that it follows; the first one or two words name one of `DOCUMENTS`.
    """

    source: Callable[[Findings, str], Iterator[Item]]
    title: str
    after: tuple[str, ...]

    @property
    def name(self) -> str:
        """Identifier of the heading in a page."""
        return self.source.__name__


DOCUMENTS = {
    "RG 1.245": "U.S. Nuclear Regulatory Commission, Preparing probabilistic fracture mechanics"
    " submittals, Regulatory Guide 1.245, Revision 0, January 2022 (ADAMS ML21334A158).",
    "NUREG/CR-7278": "L. Hund, J. Lewis, N. Martin, M. Starr, D. Brooks, A. Zhang, R. Dingreville,"
    " A. Eckert, J. Mullins, P. Raynaud, D. Rudland, D. Dijamco, S. Cumblidge, Technical basis for"
    " the use of probabilistic fracture mechanics in regulatory applications, NUREG/CR-7278,"
    " January 2022.",
    "JCGM 101": "Joint Committee for Guides in Metrology, Evaluation of measurement data:"
    ' Supplement 1 to the "Guide to the expression of uncertainty in measurement": Propagation of'
    " distributions using a Monte Carlo method, JCGM 101:2008.",
}
"""Short name -> document. RG 1.245 lists the contents of a submittal, NUREG/CR-7278 the reasons."""
