"""The card of a result as lines of 80 columns, in a terminal and in a notebook."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan
from textwrap import wrap
from typing import NamedTuple

from markupsafe import Markup

from uq.assess.answer.contributions import AverageEffect
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.answer.wording import DisplayUnit, called_together
from uq.assess.card import STUDY, Card, LeadingInput, card_of, statistic_name
from uq.assess.card_numbers import WITH_ERRORS, Headline
from uq.assess.findings import Findings
from uq.result.result import AnyResult, Result
from uq.stats.estimate import Estimate
from uq.text.numbers import TO_THESE_DIGITS, grouped, percent, percent_interval, printed
from uq.text.units import beside

WIDTH = 80
SHORT = 14
"""A card with no more lines has no blank ones, no headers of columns, and no range of 90 %."""

_HEADERS = {
    "ST": ("total share", ""),
    "S1": ("share", ""),
    "shapley": ("Shapley share", ""),
    "delta": ("output shift", "0 to 1 (delta)"),
    "pawn": ("output shift", "0 to 1 (PAWN)"),
    "KS": ("input shift", "0 to 1 (KS)"),
    "hsic": ("dependence", "0 to 1 (HSIC)"),
    "mu_star": ("mean change", "(mu*)"),
}
"""Index -> the header of its column and, unless it is a share of something, its range and name.

The output shift is how far the distribution of the output moves if the input is fixed.
"""
_INTERVAL = "95 % interval"
_IN_BRACKETS = f" ({_INTERVAL})"
_COMMANDS = "--explain  --full  --json"
_POINTS = "percentage points"
_BRIEF = {
    **dict.fromkeys(("second", "seconds"), "s"),
    **dict.fromkeys(("minute", "minutes"), "min"),
    **dict.fromkeys(("hour", "hours"), "h"),
}
_MOST = 24  # lines
_LAW = 22  # characters of a halved scatter with its unit
_LONG = 5  # characters of a unit that stands in the header alone


class Line(NamedTuple):
    """A line of a card.

    Attributes
    ----------
    text : str
    bold : tuple of int
        First and last place of the part that counts; (0, 0) for none.
    warns : bool
        Whether it says how assumptions limit the numbers.
    """

    text: str
    bold: tuple[int, int] = (0, 0)
    warns: bool = False


class ShownCard:
    """The card of a result: its text is the card, and a notebook shows it.

    Attributes
    ----------
    card : Card
        Its numbers.
    """

    def __init__(self, card: Card):
        self.card = card

    def __str__(self) -> str:
        """Return the card as text."""
        return "\n".join(line.text for line in lines_of(self.card))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the card as a notebook shows it."""
        return str(Markup("<pre>{}</pre>").format(html_of(self.card)))


def card(result: AnyResult) -> ShownCard:
    """Return the answer of a result on one screen.

    Parameters
    ----------
    result : path, xarray.Dataset or Result

    Returns
    -------
    ShownCard
        ``str`` gives at most 24 lines of 80 columns; ``card.json`` the numbers.

    Raises
    ------
    InputError
        If the result cannot be read.
    """
    return ShownCard(card_of(Findings(Result.of(result))))


def html_of(card: Card) -> Markup:
    """Return the lines of a card with what counts in bold."""
    lines = []
    for line in lines_of(card):
        first, last = line.bold
        text = line.text
        parts = text[:first], Markup("<b>{}</b>").format(text[first:last]), text[last:]
        lines.append(Markup("{}{}{}").format(*parts) if last else Markup.escape(text))
    return Markup("\n").join(lines)


def lines_of(card: Card) -> list[Line]:
    """Return the lines of a card: at most 24 of 80 columns, which a person may search."""
    return [line._replace(text=line.text.replace("\u00a0", " ")) for line in _lines_of(card)]


def _lines_of(card: Card) -> list[Line]:
    numbers = tuple(line for line in card.headline if not line.is_range)
    blocks = _blocks(replace(card, headline=numbers), is_short=True)
    short = _with_commands([line for block in blocks for line in block])
    if len(short) <= SHORT:
        return short
    counts = range(len(card.causes), max(len(card.causes) - 3, 0), -1)
    bare = replace(card, not_halved="")
    fewer = (replace(bare, causes=card.causes[:count]) for count in counts)
    variants = [(card, 0), (card, 1), *((shown, 2) for shown in fewer), (bare, 3)]
    for shown, tightness in variants:
        blocks = [*filter(None, _blocks(shown, tightness=tightness))]
        lines = _with_commands([line for block in blocks for line in (Line(""), *block)][1:])
        if len(lines) <= _MOST:
            break
    return lines


def _blocks(card: Card, *, is_short: bool = False, tightness: int = 0) -> list[list[Line]]:
    """Return the lines of a card in blocks, which blank lines part.

    A tight card has no blank line below the main numbers; a tighter one fewer checks; the tightest
    one shortened names.
    """
    is_cut = tightness > 2
    leading = [line for line in card.headline if line.leads]
    others = [line for line in card.headline if not line.leads]
    warning = [*_warning(card)]
    first = next(
        (line for line in (*leading, *others) if interval_of(line) and not line.note), None
    )
    main, table = ([*_headlines(lines, card, first, is_short)] for lines in (leading, others))
    lacking = [Line(_cut(printed(f"  {card.no_bound}"), WIDTH))] if card.no_bound else []
    main += [*lacking, *warning]
    if tightness and not card.besides:
        main, table = [*main, *table], []
    if card.besides and table:
        table[:0] = [Line(text) for text in wrap(printed(card.besides), WIDTH)[:2]]
    doubts = filter(None, ("" if warning else card.assumptions, card.sources))
    assumed = _labelled("!", tuple(doubts))
    causes = [*_causes(card, is_short=is_short, is_cut=is_cut), *_not_halved(card)]
    causes += [Line(_cut(printed(f"  {card.more_rows}"), WIDTH))] if card.more_rows else []
    return [
        [_title(card), *(Line(text) for text in wrap(printed(card.subject), WIDTH)[:2])],
        *([causes, main, table] if card.indices_first else [main, table, causes]),
        [
            *_labelled("CHECKS", card.checks, lines=2 if tightness > 1 else 3),
            *(line._replace(warns=True) for line in assumed),
            *_labelled("NEXT", _fitting(card.next, is_cut=is_cut)),
        ],
    ]


def _title(card: Card) -> Line:
    """Return the first line; a long one has less space after the name."""
    noun = "" if " in " in card.size else " row" if card.failed == 1 else " rows"
    invalid = f"{grouped(card.failed)} invalid{noun}"
    model, rows = f"{card.model}, {card.design}", f"{card.size}, {invalid}"
    texts = (_beside(f"{card.name}{' ' * gap}{rows}", model) for gap in (3, 2))
    text = next((text for text in texts if text.endswith(model)), f"{card.name}   {rows}")
    return Line(text, (0, len(card.name)))


def _with_commands(lines: list[Line]) -> list[Line]:
    last = lines[-1]
    with_commands = _beside(last.text, _COMMANDS)
    if with_commands == last.text and SHORT < len(lines) < _MOST:
        return [*lines, Line(f"{_COMMANDS:>{WIDTH}}")]
    return [*lines[:-1], last._replace(text=with_commands)]


def _beside(left: str, right: str) -> str:
    """Return two texts at both margins of a line; the right one only if it fits."""
    gap = WIDTH - len(left) - len(right)
    return f"{left}{' ' * gap}{right}" if gap > 1 else left


def _headlines(
    lines: Sequence[Headline], card: Card, first: Headline | None, is_short: bool
) -> Iterator[Line]:
    """Yield numbers with their intervals, which a header explains, or the first of a short card."""
    wide_label, wide_value = _widths(card)
    if any(line is first for line in lines) and not is_short:
        yield Line(f"  {'':<{wide_label}}{'estimate':>{wide_value}}    {_INTERVAL}")
    for line in lines:
        label, value = _label(line, card), number_of(line)
        if line.is_open:
            ends = "; ".join(filter(None, (value, line.note)))
            yield Line(_cut(f"  {label:<{wide_label}}{'':<{wide_value}}    {ends}", WIDTH))
            continue
        if line.is_range:
            yield Line(f"  {label:<{wide_label}}{'':<{wide_value // 4}}{value}")
            continue
        start = f"  {label:<{wide_label}}{value:>{wide_value}}"
        more = _IN_BRACKETS if line is first and is_short else ""
        text = f"{start}    {printed(line.note or interval_of(line))}{more}".rstrip()
        place = (len(start) - len(value), len(start)) if line.leads else (0, 0)
        if len(text) <= WIDTH:
            yield Line(text, place)
            continue
        upper, semicolon, lower = text.partition("; ")
        if not semicolon:
            upper, lower = start, printed(line.note)
        yield Line(upper + semicolon.strip(), place)
        yield Line(f"{'':<{min(len(start) + 4, WIDTH - len(lower))}}{lower}")


def _widths(card: Card) -> tuple[int, int]:
    """Return the widths of labels and of values."""
    labels = [len(_label(line, card)) for line in card.headline]
    values = [len(number_of(line)) for line in card.headline if not isnan(line.estimate.value)]
    return max([17, *labels]) + 2, max([10, *values])


def _label(line: Headline, card: Card) -> str:
    """Return the label of a number in a column; of a bound with errors, the note says of what."""
    label = label_of(line, card)
    return "with errors" if label.endswith(WITH_ERRORS) else label


def label_of(line: Headline, card: Card) -> str:
    """Return the label of a number as it is shown."""
    if line.is_range:
        return printed(f"90 % of {card.row_name[1]}")
    return printed(_in_brief(line.label))


def _in_brief(text: str) -> str:
    """Return text with the symbols of times after numbers in place of words."""
    words = "|".join(_BRIEF)
    return re.sub(rf"(?<=\d )({words})\b", lambda match: _BRIEF[match[0]], text)


def number_of(line: Headline) -> str:
    """Return the number with its unit; of a range, both ends."""
    estimate = line.estimate
    if line.shown is None:
        if isnan(estimate.value):
            return printed(percent_interval(estimate.low, estimate.high))
        return printed(percent(estimate.value))
    unit = _brief(line.shown)
    if line.label.endswith(f"life{WITH_ERRORS}") and estimate.value <= 0:
        return "no life"  # the errors are as large as the values
    if isnan(estimate.value):
        return printed(unit.between(estimate.low, estimate.high))
    return printed(unit.text(estimate.value, line.towards))


def interval_of(line: Headline) -> str:
    """Return the interval of a number without its unit; "" without one."""
    unit, low, high = line.shown, line.estimate.low, line.estimate.high
    if not line.estimate.has_interval:
        return ""
    if unit is None:
        return percent_interval(low, high)
    _, low_text, high_text = _same_decimals(*map(unit.number, line.estimate.numbers))
    return TO_THESE_DIGITS if low_text == high_text else f"{low_text} to {high_text}"


def _brief(unit: DisplayUnit) -> DisplayUnit:
    """Return a unit with the symbols of times in place of words."""
    return unit._replace(name=_BRIEF.get(unit.name, unit.name))


def _warning(card: Card) -> Iterator[Line]:
    if card.warning:
        clauses = filter(None, (card.warning, card.assumptions.partition(",")[0]))
        yield from (line._replace(warns=True) for line in _labelled("!", ("; ".join(clauses),)))


def _causes(card: Card, *, is_short: bool, is_cut: bool) -> Iterator[Line]:
    if card.no_causes:
        is_stated = "not settled" in card.no_causes
        reason = card.no_causes if is_stated else f"not settled: {card.no_causes}"
        yield from _labelled("CAUSES", (reason,))
    if not card.causes:
        return
    header, rows = cause_columns(card)
    rows[:0] = [[words, _level(share), "", ""] for words, share in card.levels]
    filled = [i for i, column in enumerate(zip(*rows, strict=True)) if any(column)]
    header = [header[i] for i in filled]
    rows = [[row[i] for i in filled] for row in rows]
    if not is_short:
        header[0] = (header[0][0], "of scatter")
    widths = _widths_of(header, rows)
    room = WIDTH - 2 - 2 * (len(widths) - 1)
    if sum(widths) > room and header[-1][1].endswith(_IN_BRACKETS):
        header[0] = (header[0][0], _IN_BRACKETS.strip().replace(")", "s)"))
        header[-1] = (header[-1][0], f"({header[-1][1].removesuffix(_IN_BRACKETS)})")
        widths = _widths_of(header, rows)
    if is_short:
        for i in range(len(header) - 1, -1, -1):
            whole = " ".join(header[i]).rstrip()
            if sum(widths) - widths[i] + max(len(whole), widths[i]) <= room:
                header[i], widths[i] = (whole, ""), max(len(whole), widths[i])
        if not (header[0][1] or header[-1][1]):
            header = [(upper, "") for upper, _ in header]
    for place, least in ((2, 22), (0, 16), (2, 12)):
        if place < len(widths) - 1:
            too_wide = max(sum(widths) - room, 0)
            widths[place] -= min(too_wide, max(widths[place] - least, 0))
    lines = [[pair[0] for pair in header], [pair[1] for pair in header], *rows]
    for cells in lines:
        names = wrap(cells[0], widths[0], subsequent_indent="  ")
        first, *others = [cells[0]] if is_cut or not names else names
        for named in ([first, *cells[1:]], *([other] for other in others)):
            padded = zip(named, widths[: len(named)], strict=True)
            parts = [f"{_cut(cell, width):<{width}}" for cell, width in padded]
            if line := "  ".join(parts).rstrip():
                yield Line(f"  {line}"[:WIDTH], (2, 8) if cells is lines[0] else (0, 0))


def _widths_of(header: list[tuple[str, str]], rows: list[list[str]]) -> list[int]:
    columns = zip(*rows, strict=True)
    return [max(map(len, (*pair, *column))) for pair, column in zip(header, columns, strict=True)]


def _not_halved(card: Card) -> Iterator[Line]:
    """Yield the reason why no number under half the scatter is shown."""
    if card.not_halved:
        yield Line(_cut(printed(f"  half scatter: {card.not_halved}"), WIDTH))


def cause_columns(card: Card) -> tuple[list[tuple[str, str]], list[list[str]]]:
    """Return two lines of header, by column, and the cells of each cause."""
    steps = {cause.contribution.changes[0].step for cause in card.causes if _has_changes(cause)}
    step = steps.pop() if len(steps) == 1 else ""
    upper, lower = _HEADERS.get(card.index, (card.index, ""))
    header = [
        ("CAUSES", ""),
        (upper, f"of {card.share_of}" if card.share_of else lower),
        (f"{step} up", "changes it") if step else ("scatter halved", "(now)"),
        ("", ""),
    ]
    tolerances = [cause.tightened for cause in card.causes if cause.tightened is not None]
    if tolerances:
        first = tolerances[0]
        name, now = (
            printed(_in_brief(statistic_name(first))),
            printed(_value(first, first.before.value)),
        )
        has_intervals = any(entry.after.has_interval for entry in tolerances)
        pattern = f"now {now}{_IN_BRACKETS}" if has_intervals else f"(now {now})"
        header[3] = (f"half scatter: {name}" if step else name, pattern)
    rows = [
        [
            called_together(cause.contribution.inputs).removeprefix("both "),
            _share(cause),
            _effects(cause, step) if step else _law(cause),
            printed(_tightened(cause)),
        ]
        for cause in card.causes
    ]
    return header, rows


def _level(share: Estimate) -> str:
    """Return the share of a level with its interval."""
    ends = percent_interval(share.low, share.high).removesuffix(" %")
    return printed(f"{100 * max(share.value, 0):.0f} %{f' ({ends})' * share.has_interval}")


def _share(cause: LeadingInput) -> str:
    contribution = cause.contribution
    if not contribution.share_of_variance:
        return contribution.size_of(contribution.indices[0]).partition(" (")[0]
    shares = (f"{100 * max(index.value, 0):.0f}" for index in contribution.indices)
    return f"{' + '.join(shares)} %"


def _law(cause: LeadingInput) -> str:
    """Return the halved scatter and, in brackets, the present one; shortened to fit its column."""
    if cause.tightened is None:
        return ""
    if ";" in cause.tightened.law:
        return "both halved" if len(cause.contribution.inputs) == 2 else "all halved"
    stated = cause.tightened.law
    with_dashes = re.sub(r"(?<![-.\d])(\d\S*) to (?=\d)", "\\1–", stated)
    for law in (stated, with_dashes):
        then, _, now = law.partition(" instead of ")
        if len(f"{then} ({now})") <= _LAW:
            return printed(f"{then} ({now})")
    words = then.split()
    while len(words) > 1 and not words[-1].lstrip("-")[:1].isdigit():  # of the unit
        words.pop()
    return printed(f"{' '.join(words)} ({now})")


def _has_changes(cause: LeadingInput) -> bool:
    return bool(cause.contribution.changes)


def _effects(cause: LeadingInput, step: str) -> str:
    """Return the changes with this step of each of at most two inputs."""
    changes = cause.contribution.changes
    if len(changes) > 2 or not any(change.direction for change in changes):
        return ""
    if any(change.step != step for change in changes):
        return ""
    texts = [_changed(change) for change in changes]
    texts[:-1] = [text.removesuffix(f" {changes[-1].unit.name}") for text in texts[:-1]]
    return printed(", ".join(texts)).replace(_POINTS, "points")


def _changed(change: AverageEffect) -> str:
    if change.direction == 0:
        return "unclear"
    sign = "+" if change.direction > 0 else "-"
    if not change.step or not change.by.has_interval:
        return sign
    return f"{sign}{change.unit.text(abs(change.by.value))}"


def _value(tolerance: TighterTolerance, value: float) -> str:
    return percent(value) if tolerance.is_share else _brief(tolerance.unit).text(value)


def _tightened(cause: LeadingInput) -> str:
    tolerance = cause.tightened
    if tolerance is None:
        return ""
    after, unit = tolerance.after, _brief(tolerance.unit)
    if tolerance.is_share:
        text = percent(after.value)
        between = percent_interval(after.low, after.high).removesuffix(" %")
    else:
        text, low, high = _same_decimals(*map(unit.number, after.numbers))
        text = beside(text, unit.name) if len(unit.name) <= _LONG else text
        between = f"{low} to {high}"
    if tolerance.harms:
        return f"{text}, worse"
    return f"{text} ({between})" if after.has_interval else text


def _cut(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: width - 1]}…"


def _fitting(clauses: Sequence[str], *, is_cut: bool) -> tuple[str, ...]:
    """Return the first clause, and the second if it tells the rows, or both fit on one line."""
    both = "; ".join(clauses[:2])
    fits = len(printed(both)) <= WIDTH - len(_COMMANDS) - 12
    return tuple(clauses[: 2 if fits or (STUDY in both and not is_cut) else 1])


def _labelled(label: str, clauses: Sequence[str], lines: int = 2) -> list[Line]:
    """Return clauses after a label, as many as fit on these lines, at least the first."""
    if not clauses:
        return []
    width = 8 if len(label) > 1 else 2
    for count in range(len(clauses), 0, -1):
        text = _in_brief("; ".join(clauses[:count]))
        first, *others = wrap(printed(text), WIDTH - width - 2)
        if len(others) < lines:
            break
    others = others[: lines - 1]
    texts = [f"  {label:<{width}}{first}", *(f"  {'':<{width}}{other}" for other in others)]
    places = [(2, width) if len(label) > 1 else (0, 0), *((0, 0) for _ in others)]
    return [*map(Line, texts, places)]


def _same_decimals(*numbers: str) -> list[str]:
    """Return numbers with as many decimals as that which has most, but no more than three digits.

    As given if one is written with a power of ten.
    """
    if not all(re.fullmatch(r"-?\d+(\.\d+)?", number) for number in numbers):
        return [*numbers]
    most = max(len(number.partition(".")[2]) for number in numbers)
    padded = [f"{float(number):.{most}f}" for number in numbers]
    digits = [len(number.lstrip("-").replace(".", "").lstrip("0")) for number in padded]
    return [
        long if count <= 3 else number
        for long, count, number in zip(padded, digits, numbers, strict=True)
    ]
