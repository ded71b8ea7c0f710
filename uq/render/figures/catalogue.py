"""A figure of a result as an entry of a table: its subjects, its caption, where it appears."""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any, Literal

from matplotlib.figure import Figure

from uq.assess.findings import Findings
from uq.render.figures.index_plot import subject
from uq.text.numbers import capitalized


@dataclass(frozen=True)
class FigureSubject:
    """The subject of one figure.

    Attributes
    ----------
    name : str
        An output, or a target of indices; "" for the complete result.
    method : str
        Sensitivity method of the indices.
    keywords : dict
        Keyword arguments of the drawing function.
    part : str
        Number among several figures: ``1 of 2``.
    """

    name: str = ""
    method: str = ""
    keywords: Mapping[str, Any] = field(default_factory=dict)
    part: str = ""


Applies = Callable[[Findings, str], bool]
"""Condition on a result and the name of one of its subjects."""


@dataclass(frozen=True)
class Entry:
    """One kind of figure.

    Attributes
    ----------
    draw : callable
        ``draw(ds, output, *, axes=None)`` or, for a result, ``draw(ds, *, axes=None)``. The
        documentation quotes the first line of its docstring.
    subjects : callable
        Findings -> subjects: a function of `uq.render.figures.subjects`.
    caption : str
        With ``{what}``, ``{event}`` and ``{method}``: output or target, event, and method in words.
    section : str
        Section of the report; "" if the report does not show the figure.
    applies : tuple of callable
        Conditions under which the figure is drawn.
    in_report : tuple of callable
        Further conditions under which the report shows it.
    needs : tuple of str
        Attributes of `Findings` passed as keyword arguments.
    file : tuple of str
        Parts of the file name.
    """

    draw: Callable[..., Figure]
    subjects: Callable[[Findings], Iterator[FigureSubject]]
    caption: str = "{what}"
    section: Literal["inputs", "rows", "results", "convergence", ""] = "results"
    applies: tuple[Applies, ...] = ()
    in_report: tuple[Applies, ...] = ()
    needs: tuple[str, ...] = ()
    file: tuple[str, ...] = ("figure", "method", "name")


@dataclass(frozen=True)
class Drawable:
    """One figure of a result that can be drawn."""

    figure: str
    entry: Entry
    subject: FigureSubject
    findings: Findings = field(repr=False)

    @property
    def file(self) -> str:
        """File name without a suffix."""
        words = {"figure": self.figure, "method": self.subject.method, "name": self.subject.name}
        named = (words[word] for word in self.entry.file)
        return file_name(*filter(None, (*named, self.subject.part)))

    @property
    def caption(self) -> str:
        """Caption: subject, method and part."""
        result, name = self.findings.result, self.subject.name
        words = (
            str(result.dataset[name].attrs["long_name"])
            if name in result.dataset
            else subject(result, name)
            if name
            else ""
        )
        event = words.removeprefix("whether ")
        caption = self.entry.caption.format(what=words, event=event, method=self.subject.method)
        return capitalized(caption) + f" ({self.subject.part})" * bool(self.subject.part)

    def draw(self) -> Figure:
        """Draw and return the figure."""
        needs = {need: getattr(self.findings, need) for need in self.entry.needs}
        names = filter(None, [self.subject.name])
        return self.entry.draw(
            self.findings.result.dataset, *names, **needs, **self.subject.keywords
        )


def drawables(
    figures: Mapping[str, Entry], findings: Findings, section: str | None = None
) -> Iterator[Drawable]:
    """Yield each figure of a result, or of one section of its report, in order.

    Consecutive entries with the same subjects alternate: all figures of one output precede
    all figures of the next.
    """
    chosen = [pair for pair in figures.items() if section in (None, pair[1].section)]
    for subjects_of, entries in groupby(chosen, key=lambda pair: pair[1].subjects):
        together = list(entries)
        for figure_subject in subjects_of(findings):
            for figure, entry in together:
                conditions = entry.applies + (entry.in_report if section else ())
                if all(applies(findings, figure_subject.name) for applies in conditions):
                    yield Drawable(figure, entry, figure_subject, findings)


def file_name(*words: str) -> str:
    """Join words to a file name without characters special to a shell."""
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", "-".join(words)).strip("_")
