"""The card of a result on a page: tiles of its numbers, a table of its causes."""

from collections.abc import Iterator
from math import isnan
from typing import Any, NamedTuple

from markupsafe import Markup

from uq.assess.answer.answer_sentences import Answer
from uq.assess.card import Card, LeadingInput
from uq.assess.card_numbers import Headline
from uq.render.card import cause_columns, interval_of, label_of, number_of
from uq.render.html.cells import SHARE, Cell, HtmlTable
from uq.text.keys import key_of
from uq.text.numbers import capitalized, counted, printed

MOST_TILES = 4


class Tile(NamedTuple):
    """A number of a card with its label.

    Attributes
    ----------
    label : str
    value : str
        With its unit.
    more : str
        Interval or meaning.
    traced : str
        Key for ``uq trace``.
    """

    label: str
    value: str
    more: str
    traced: str


def first_screen(card: Card, answer: Answer, figure: Markup) -> dict[str, Any]:
    """Return the first screen of a report in plain data.

    Parameters
    ----------
    card : Card
    answer : Answer
        The answer that the card is made from, which has the keys of the causes.
    figure : Markup
        Figure of the subject; "" if there is none.

    Returns
    -------
    dict
        ``tiles``, the main number first; ``others``, numbers for which there is no tile, and
        ``besides``, their subject if it is another; ``causes``, a table or None.
    """
    lines = sorted(card.headline, key=lambda line: (not line.leads, not _answers(line)))
    tiles = [line for line in lines if not isnan(line.estimate.value)]
    if card.besides:
        tiles = [line for line in tiles if line.leads]
    tiles = tiles[:MOST_TILES]
    return {
        "card": card,
        "tiles": [_tile(line, card) for line in tiles],
        "others": [_tile(line, card) for line in card.headline if line not in tiles],
        "figure": figure,
        "causes": _causes(card, answer),
        "rows": card.size,
        "invalid": counted(card.failed, "invalid row"),
    }


def _answers(line: Headline) -> bool:
    """Return whether a number is the probability of an event that the study asks about."""
    return line.shown is None


def _tile(line: Headline, card: Card) -> Tile:
    is_range = isnan(line.estimate.value)
    more = line.note if line.note or is_range else interval_of(line)
    prefix = "95 % interval " if more and not line.note else ""
    label = capitalized(label_of(line, card))
    return Tile(label, number_of(line), printed(prefix + more), line.key)


def _causes(card: Card, answer: Answer) -> HtmlTable | None:
    """Return the causes of a card as a table; None if no input leads."""
    if not card.causes:
        return None
    header, lines = cause_columns(card)
    place, has_effects = _place(answer), header[2][1] == "changes it"
    rows = [
        tuple(_cells(cause, texts, (*place, "contributions", str(i)), has_effects))
        for i, (cause, texts) in enumerate(zip(card.causes, lines, strict=True))
    ]
    filled = [i for i in range(len(header)) if any(row[i].text for row in rows)]
    if any(row[1].more for row in rows) and card.share_of:
        header[1] = (header[1][0], f"{header[1][1]} (95 % interval)")
    titles = [_joined(*header[i]) for i in filled]
    shown = [tuple(row[i] for i in filled) for row in rows]
    return HtmlTable("Causes", ("input", *titles[1:]), shown)


def _joined(upper: str, lower: str) -> str:
    """Return the two lines of a header on one line."""
    comma = "," * lower.startswith("now ")
    return f"{upper}{comma} {lower}".strip()


def _place(answer: Answer) -> tuple[str, ...]:
    """Return the path of the ranking of the subject among the facts of the answer."""
    if answer.regimes_first:
        ranked = (regime.predicate for regime in answer.regime_causes if regime.ranking is not None)
        return "regimes", next(ranked, ""), "ranking"
    return "quantities", "" if answer.lead is None else answer.lead.name, "ranking"


def _cells(
    cause: LeadingInput, texts: list[str], place: tuple[str, ...], has_effects: bool
) -> Iterator[Cell]:
    """Yield the cells of a cause: inputs, share as a bar, effect, number with less scatter."""
    contribution, first = cause.contribution, cause.contribution.indices[0]
    keys = (key_of(*place, "inputs", name, verb="answer") for name in contribution.inputs)
    interval = contribution.size_of(first).partition(" (")[2].removesuffix(")")
    is_single = len(contribution.indices) == 1
    name, share, effect, tightened = texts
    yield Cell(capitalized(name))
    yield Cell(
        share,
        printed(interval) if is_single else "",
        contribution.value,
        "\n".join(keys),
        SHARE if contribution.share_of_variance else "index",
        (first.low, first.high) if is_single else (contribution.value,) * 2,
    )
    moved = [
        key_of(*place, "effects", name, verb="answer")
        for name, change in zip(contribution.inputs, contribution.changes, strict=False)
        if change.step and change.by.has_interval
    ]
    yield Cell(effect, traced="\n".join(moved) if has_effects and effect else "")
    value, _, interval = tightened.partition(" (")
    key = "" if cause.tightened is None else cause.tightened.key
    yield Cell(value, interval.removesuffix(")"), traced=key)
