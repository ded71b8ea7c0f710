"""A figure of a result as an entry of a table: its subjects, its caption, where it appears."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, Any, Literal

from matplotlib.figure import Figure

from uq.assess.findings import Findings
from uq.assess.targets import split_name
from uq.errors import InputError, choices, nearest
from uq.render.figures.index_plot import subject
from uq.render.figures.words import place_in_words
from uq.result.result import Result
from uq.text.numbers import capitalized, threshold

if TYPE_CHECKING:
    import pandas as pd


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

    @property
    def output(self) -> str:
        """The output, "" for the complete result."""
        return re.split(r"[\[=]", split_name(self.name)[1])[0]


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
    leading : callable or None
        (Findings, leading outputs) -> the subjects drawn without a request; by default those of
        `subjects` that are about these outputs.
    on_request : bool
        Whether it is drawn on request only.
    """

    draw: "Callable[..., Figure | pd.DataFrame]"
    subjects: Callable[[Findings], Iterator[FigureSubject]]
    caption: str = "{what}"
    section: Literal["inputs", "rows", "results", "convergence", ""] = "results"
    applies: tuple[Applies, ...] = ()
    in_report: tuple[Applies, ...] = ()
    needs: tuple[str, ...] = ()
    file: tuple[str, ...] = ("figure", "method", "name")
    leading: Callable[[Findings, Sequence[str]], Iterator[FigureSubject]] | None = None
    on_request: bool = False


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
        name = target_in_file_name(self.findings.result, self.subject.name)
        words = {"figure": self.figure, "method": self.subject.method, "name": name}
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

    def draw(self) -> "Figure | pd.DataFrame":
        """Return the figure, or the table."""
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


def leading_drawables(
    figures: Mapping[str, Entry], findings: Findings, outputs: Sequence[str]
) -> Iterator[Drawable]:
    """Yield the figures about the subject of a study.

    Parameters
    ----------
    figures : mapping
    findings : Findings
    outputs : sequence of str
        The leading outputs, the most important first.
    """
    for figure, entry in figures.items():
        if entry.on_request:
            continue
        subjects = (
            entry.leading(findings, outputs)
            if entry.leading
            else (each for each in entry.subjects(findings) if each.output in outputs)
        )
        for figure_subject in subjects:
            if all(applies(findings, figure_subject.name) for applies in entry.applies):
                yield Drawable(figure, entry, figure_subject, findings)


def named_drawables(
    figures: Mapping[str, Entry], findings: Findings, names: Sequence[str]
) -> list[Drawable]:
    """Return the figures of some kinds, or with some file names.

    Raises
    ------
    InputError
        When there is no figure of that name.
    """
    kinds = {name: figures[name] for name in names if name in figures}
    drawn = list(drawables(kinds, findings))
    if absent := sorted(set(kinds) - {drawable.figure for drawable in drawn}):
        raise InputError(f"this result has no figure '{absent[0]}'")
    files = [name for name in names if name not in figures]
    if files:
        every = {drawable.file: drawable for drawable in drawables(figures, findings)}
        for name in files:
            if name not in every:
                near = nearest(name, [*figures, *every])
                raise InputError(f"no figure '{name}' (kinds: {choices(figures, 20)}){near}")
        drawn += [every[name] for name in files if every[name].figure not in kinds]
    return drawn


def target_in_file_name(result: Result, target: str) -> str:
    """Return a target in words for a file name: ``life-250um-below-24_hours``.

    Parameters
    ----------
    result : Result
    target : str
        An output, or a target of indices.
    """
    form, inside, at = split_name(target)
    output = re.split(r"[\[=]", inside)[0]
    if output not in result.outputs or result.is_category(output):
        return target
    elements = result.named_elements(inside)
    place = place_in_words(result, elements[0]) if "[" in inside and len(elements) == 1 else ""
    side = ""
    if at:
        size = threshold(float(at), elements[0].units)
        side = f"{'below' if '<' in target else 'above'}-{size}"
    return "-".join(filter(None, (form * (form != "P"), output, place.replace(" ", ""), side)))


_ASCII = str.maketrans({"µ": "u", "\N{GREEK SMALL LETTER MU}": "u", "°": "deg", "Ω": "ohm"})


def file_name(*words: str) -> str:
    """Join words to a file name without characters special to a shell."""
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", "-".join(words).translate(_ASCII)).strip("_")
