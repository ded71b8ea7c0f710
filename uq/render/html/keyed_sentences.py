"""Sentences of facts as HTML with the keys of their numbers, and parts to be unfolded."""

from collections.abc import Collection, Iterable

from markupsafe import Markup

from uq.assess.answer.piece_of_advice import Advice
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.answer.wording import called_together
from uq.assess.fact import Fact
from uq.text.keys import key_of
from uq.text.literals import plain
from uq.text.numbers import capitalized, printed


def keyed(answer: Fact, *path: str, text: str | None = None) -> Markup:
    """Return the sentence of a fact of the answer, with the keys of its numbers.

    Parameters
    ----------
    answer : Fact
        Tree of facts.
    *path : str
        Path of the fact in the tree.
    text : str, optional
        Alternative text for the same numbers.

    Returns
    -------
    Markup
        "" if the fact or its sentence does not exist.
    """
    try:
        fact = answer.at(*path).content
    except KeyError:
        fact = None
    if not isinstance(fact, Fact):
        return Markup() if text is None else with_keys(text)
    keys = (key_of(*path, *mention, verb="answer") for mention in fact.mentions)
    return with_keys(fact.sentence if text is None else text, *keys)


def with_keys(text: str, *keys: str) -> Markup:
    """Return text as HTML with the keys of its numbers; "" if it is empty."""
    if not text or not keys:
        return shown(text)
    lines = "\n".join(keys)
    return Markup('<span data-trace="{0}" title="uq trace: {0}">{1}</span>').format(
        plain(lines), plain(printed(text))
    )


def shown(text: str) -> Markup:
    """Return text as escaped HTML; HTML is returned unchanged."""
    return text if isinstance(text, Markup) else Markup.escape(plain(printed(text)))


def joined(*sentences: str) -> Markup:
    """Join the non-empty sentences."""
    return Markup(" ").join(filter(None, sentences))


def folded(title: str, content: Markup) -> Markup:
    """Return content folded below a title; "" without content."""
    whole = Markup("<details><summary>{}</summary>{}</details>").format(title, content)
    return whole if content else Markup()


def items(lines: Iterable[str]) -> Markup:
    """Return lines as an HTML list; "" if there are none."""
    entries = Markup("").join(Markup("<li>{}</li>").format(shown(line)) for line in lines if line)
    return Markup("<ul>{}</ul>").format(entries) if entries else entries


def below(advice: Advice) -> Markup:
    """Return the details below a recommendation: the effect of tighter tolerances."""
    if len(advice.tolerances) < 2:
        return Markup()
    return folded("Half the scatter of each input", _tolerances(advice))


def _tolerances(advice: Advice) -> Markup:
    """Return the table of each number with the scatter of each input halved."""
    tolerances, above = advice.tolerances, {advice.key, *(alike.key for alike in advice.alike)}
    numbers = {tolerance.statistic: tolerance for tolerance in tolerances}
    lines = [
        [
            "As studied",
            *(_number(tolerance.text(tolerance.before)) for tolerance in numbers.values()),
        ]
    ]
    for inputs in dict.fromkeys(tolerance.inputs for tolerance in tolerances):
        by_statistic = {
            tolerance.statistic: tolerance for tolerance in tolerances if tolerance.inputs == inputs
        }
        cells = (
            _cell(by_statistic[what], above) if what in by_statistic else Markup("<td></td>")
            for what in numbers
        )
        law = Markup("<small>{}</small>").format(shown(next(iter(by_statistic.values())).law))
        lines.append([shown(capitalized(called_together(inputs))) + law, *cells])
    head = Markup("").join(
        Markup('<th scope="col" class="number">{}</th>').format(
            shown(capitalized(what.removeprefix("the ")))
        )
        for what in numbers
    )
    body = Markup("").join(
        Markup('<tr><th scope="row">{}</th>{}</tr>').format(shown(first), Markup("").join(cells))
        for first, *cells in lines
    )
    table = Markup("<table><thead><tr><td></td>{}</tr></thead><tbody>{}</tbody></table>")
    return Markup('<div class="wide">{}</div>').format(table.format(head, body))


def _number(text: str) -> Markup:
    return Markup('<td class="number">{}</td>').format(shown(text))


def _cell(tolerance: TighterTolerance, above: Collection[str]) -> Markup:
    """Return a number with its interval, and its key unless a sentence above has it."""
    text = tolerance.text(tolerance.after)
    number = shown(text) if tolerance.key in above else with_keys(text, tolerance.key)
    return Markup('<td class="number">{}<small>{}</small></td>').format(
        number, shown(tolerance.interval)
    )
