"""The card of a result as text of 80 columns, and in a notebook."""

from collections.abc import Iterator, Sequence
from math import isnan
from textwrap import wrap

from markupsafe import Markup

from uq.assess.card import Card, Cause, Headline, card_of
from uq.assess.findings import Findings
from uq.result.result import AnyResult, Result
from uq.text.numbers import grouped, printed

WIDTH = 80
_SHORT = 12  # lines that need no blank ones between them
_LABEL, _VALUE, _CAUSE = 19, 14, 26
_COMMANDS = "--explain  --full  --json"


class ShownCard:
    """The card of a result: its text is the card; a notebook shows it.

    Attributes
    ----------
    card : Card
        Its numbers.
    """

    def __init__(self, card: Card):
        self.card = card

    def __str__(self) -> str:
        """Return the card as text."""
        return "\n".join(lines_of(self.card))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the card as a notebook shows it."""
        return str(Markup("<pre>{}</pre>").format(str(self)))


def card(result: AnyResult) -> ShownCard:
    """Return the answer of a result on one screen.

    Parameters
    ----------
    result : Result, xarray.Dataset or path

    Returns
    -------
    ShownCard
        At most 24 lines of 80 columns; ``card.card`` holds the numbers.
    """
    return ShownCard(card_of(Findings(Result.of(result))))


def lines_of(card: Card) -> list[str]:
    """Return the lines of a card, at most 24 of 80 columns."""
    blocks = [
        [_title(card), *wrap(printed(card.subject), WIDTH)[:2]],
        [*_headline(card.headline), *_warning(card)],
        [*_causes(card)],
        [*_labelled("CHECKS", card.checks), *_labelled("NEXT", card.next[:2])],
    ]
    blank = [""] if sum(map(len, blocks)) > _SHORT else []
    lines = [line for block in blocks if block for line in [*blank, *block]][len(blank) :]
    lines[-1] = _beside(lines[-1], _COMMANDS)
    return lines


def _title(card: Card) -> str:
    rows = f"{grouped(card.rows)} {card.row_name[card.rows != 1]}, {grouped(card.failed)} failed"
    return _beside(f"{card.name}   {rows}", f"{card.model}, {card.design}")


def _beside(left: str, right: str) -> str:
    """Return two texts at both margins of a line; the right one only if it fits."""
    gap = WIDTH - len(left) - len(right)
    return f"{left}{' ' * gap}{right}" if gap > 1 else left


def _headline(headline: Sequence[Headline]) -> Iterator[str]:
    for line in headline:
        rest = line.note or line.interval
        if isnan(line.estimate.value):
            yield f"  {line.label:<{_LABEL}}{printed(line.interval)}".rstrip()
            continue
        start = f"  {line.label:<{_LABEL}}{printed(line.value):<{_VALUE}}"
        yield f"{start}{printed(rest)}".rstrip()[:WIDTH]


def _warning(card: Card) -> Iterator[str]:
    if card.warning:
        yield from _labelled("!", (card.warning,), 4)


def _causes(card: Card) -> Iterator[str]:
    if card.no_causes:
        yield from _labelled("CAUSES", (f"not settled: {card.no_causes}",))
    if not card.causes:
        return
    steps = {cause.effect.step for cause in card.causes if cause.effect is not None}
    step = f"{steps.pop()} more" if len(steps) == 1 else ""
    tolerances = [cause.tightened for cause in card.causes if cause.tightened is not None]
    header = f"  {'CAUSES':<{_CAUSE}}{'share':<10}{step:<13}"
    if tolerances:
        first = tolerances[0]
        name = first.statistic.removeprefix("the ").removeprefix("share of rows that ")
        header += f"{name}, half scatter"
    yield header.rstrip()[:WIDTH]
    for cause in card.causes:
        yield _cause(cause).rstrip()[:WIDTH]


def _cause(cause: Cause) -> str:
    from uq.assess.answer.wording import called_together

    names = called_together(cause.inputs)
    values = " + ".join(f"{100 * max(index.value, 0):.0f}" for index in cause.indices[:3]) + " %"
    effect = "" if cause.effect is None or cause.effect.direction == 0 else _effect(cause)
    after = ""
    if cause.tightened is not None:
        after = cause.tightened.text(cause.tightened.after)
        if cause.tightened.interval:
            after += f"  ({cause.tightened.interval})"
    return f"  {names[: _CAUSE - 1]:<{_CAUSE}}{values:<10}{effect:<13}{printed(after)}"


def _effect(cause: Cause) -> str:
    assert cause.effect is not None
    effect = cause.effect
    if not effect.step or not effect.by.has_interval:
        return "+" if effect.direction > 0 else "-"
    sign = "+" if effect.direction > 0 else "-"
    return f"{sign}{effect.unit.text(abs(effect.by.value))}"


def _labelled(label: str, sentences: Sequence[str], width: int = 8) -> list[str]:
    """Return sentences under a label, wrapped beside it."""
    if not sentences:
        return []
    text = "; ".join(sentences)
    first, *others = wrap(printed(text), WIDTH - width - 2)[:2] or [""]
    return [f"  {label:<{width}}{first}", *(f"  {'':<{width}}{other}" for other in others)]
