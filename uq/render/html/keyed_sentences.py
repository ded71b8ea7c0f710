"""Sentences of facts as HTML, each with the keys of its numbers for ``uq trace``."""

from markupsafe import Markup

from uq.assess.fact import Fact
from uq.text.keys import key_of
from uq.text.literals import plain
from uq.text.numbers import printed


def keyed(answer: Fact, *path: str, text: str | None = None) -> Markup:
    """Return the sentence of a fact of the answer, with the keys of its numbers.

    Parameters
    ----------
    answer : Fact
        The tree.
    *path : str
        The place of the fact.
    text : str, optional
        Other words for its numbers.

    Returns
    -------
    Markup
        "" without a sentence, or without the fact.
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
    """Return text that shows keys of its numbers; "" if it is empty."""
    if not text or not keys:
        return shown(text)
    lines = "\n".join(keys)
    return Markup('<span data-trace="{0}" title="uq trace: {0}">{1}</span>').format(
        plain(lines), plain(printed(text))
    )


def shown(text: str) -> Markup:
    """Return text as HTML; HTML is left as it is."""
    return text if isinstance(text, Markup) else Markup.escape(plain(printed(text)))


def joined(*sentences: str) -> Markup:
    """Return sentences in a row, without empty ones."""
    return Markup(" ").join(filter(None, sentences))
