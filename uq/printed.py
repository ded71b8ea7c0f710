"""Numbers as they are printed, in figures and on pages; a terminal keeps the hyphen for copying."""

import re

from uq.units import PREFIXED

_NUMBER = re.compile(r"(?<![^\s(\[])-?(?:\d[\d.]*(?:e[-+]?\d+)?|∞|inf)(?![\w-])")
_TIMES = "minutes?|hours?|days?|years?"
_FACTOR = rf"[pnµmkMG]?(?:{'|'.join(sorted(PREFIXED - {'ohm'}))}|Ω|g)[⁻⁰¹²³⁴-⁹]*(?![\w⁻])"
_UNIT = re.compile(rf"(?<=\d)(?: {_FACTOR})+|(?<=\d) (?=(?:{_TIMES}|%)(?!\w))")
_POWER = r"(?<=\d) (?=× 10)|(?<=×) (?=10)"
_GROUP = r"(?<=\d) (?=\d{3}(?!\d))"
_DIFFERENCE = r"(?<=[₀-₉]) (?=[−+] )|(?<=[₀-₉] [−+]) "
_BEFORE_POWER = re.compile(rf"(?<=\w) (?=\w{{1,3}}[⁻⁰¹²³⁴-⁹])|{_POWER}|{_GROUP}|{_DIFFERENCE}")


def minus(text: str) -> str:
    """Return text with minus signs instead of hyphens in its numbers: ``−1.5e−05``.

    Names, dates, laws of a study file in code and options of commands keep their hyphens.
    """
    return _NUMBER.sub(lambda found: found[0].replace("-", "\N{MINUS SIGN}"), text)


def printed(text: str) -> str:
    """Return text for a page: with minus signs, a dash for no number, and numbers in one line."""
    if text == "-":
        return "\N{EN DASH}"
    text = _UNIT.sub(lambda found: found[0].replace(" ", "\N{NO-BREAK SPACE}"), minus(text))
    return _BEFORE_POWER.sub("\N{NO-BREAK SPACE}", text)
