"""A figure of a result as an entry of a table: of what it is drawn, where, and its caption."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any, Literal

from matplotlib.figure import Figure

from uq.analysis.findings import Findings
from uq.drawing.figure import file_name


@dataclass(frozen=True)
class Subject:
    """What one figure is drawn of.

    Attributes
    ----------
    name : str
        An output, or a target of indices; "" for the result as a whole.
    method : str
        Of the indices.
    found : object
        What is known of it already: passed on as ``found``.
    """

    name: str = ""
    method: str = ""
    found: Any = None


Applies = Callable[[Findings, str], bool]
"""What must hold of a result and the name of one of its subjects."""


@dataclass(frozen=True)
class Entry:
    """One kind of figure.

    Attributes
    ----------
    draw : callable
        ``draw(ds, output, *, axes=None)`` or, of a result as a whole, ``draw(ds, *, axes=None)``.
        The first line of its docstring stands in the documentation.
    of : callable
        Findings -> what it is drawn of: a function of `uq.drawing.subjects`.
    caption : str
        With ``{name}``, ``{meaning}`` and ``{method}``.
    section : str
        Where the report shows it; "" for nowhere.
    applies : tuple of callable
        What must hold for it to be drawn.
    in_report : tuple of callable, optional
        What must hold for the report to show it, if not the same.
    needs : tuple of str
        What of `Findings` is passed on by that name.
    file : tuple of str
        Words of the name of its file.
    """

    draw: Callable[..., Figure]
    of: Callable[[Findings], Iterator[Subject]]
    caption: str
    section: Literal["inputs", "rows", "results", "sensitivities", "convergence", ""] = "results"
    applies: tuple[Applies, ...] = ()
    in_report: tuple[Applies, ...] | None = None
    needs: tuple[str, ...] = ()
    file: tuple[str, ...] = ("figure", "method", "name")


@dataclass(frozen=True)
class Drawable:
    """One figure of one result, not yet drawn."""

    figure: str
    entry: Entry
    subject: Subject
    findings: Findings = field(repr=False)

    @property
    def file(self) -> str:
        """The name of its file, without an ending."""
        words = {"figure": self.figure, "method": self.subject.method, "name": self.subject.name}
        return file_name(*filter(None, (words[word] for word in self.entry.file)))

    @property
    def caption(self) -> str:
        """What it shows, in words."""
        ds, name = self.findings.ds, self.subject.name
        meaning = ds[name].attrs["long_name"] if name in ds else ""
        return self.entry.caption.format(name=name, method=self.subject.method, meaning=meaning)

    def draw(self) -> Figure:
        """Return the figure."""
        keywords = {need: getattr(self.findings, need) for need in self.entry.needs}
        if self.subject.method:
            keywords |= {"method": self.subject.method, "found": self.subject.found}
        names = [self.subject.name] if self.subject.name else []
        return self.entry.draw(self.findings.ds, *names, **keywords)


def drawables(
    figures: Mapping[str, Entry], findings: Findings, section: str | None = None
) -> Iterator[Drawable]:
    """Yield every figure of a result, or those of one section of its report, in order.

    Figures in a row of the table that are drawn of the same stay together: all of one output
    before those of the next.
    """
    chosen = [one for one in figures.items() if section in (None, one[1].section)]
    for of, entries in groupby(chosen, key=lambda one: one[1].of):
        together = list(entries)
        for subject in of(findings):
            for figure, entry in together:
                must = entry.applies if section is None else entry.in_report or entry.applies
                if all(holds(findings, subject.name) for holds in must):
                    yield Drawable(figure, entry, subject, findings)
