"""The headings of a dossier, and the documents that they follow.

The headings are the topics on which RG 1.245 asks a submittal to report (its section C.2), in that
order, and the conclusions of NUREG/CR-7278, its technical basis; JCGM 101 adds what belongs to the
propagation of distributions. Of both documents of the NRC, purpose, graded approach and their
relation were read again for this outline, but the text of section C.2 was not at hand: its topics
have not been compared word for word, their finer numbers are not given, and a draft revision of the
guide (DG-1422, February 2024) is not followed. Check the guide before a submittal relies on it.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from uq.assess.findings import Findings
from uq.render.html.dossier.items import Item


class Heading(NamedTuple):
    """A heading.

    Attributes
    ----------
    source : callable
        Findings, name of the file -> the items under it; its name is the heading's in a page.
    title : str
    after : tuple of str
        What it follows; the first word or two name one of `DOCUMENTS`.
    """

    source: Callable[[Findings, str], Iterator[Item]]
    title: str
    after: tuple[str, ...]

    @property
    def name(self) -> str:
        """Its place in a page."""
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
"""Short name -> document. RG 1.245 says what a submittal contains, NUREG/CR-7278 why."""
