r"""Symbols as formulas that matplotlib typesets: ``omega_s1`` is written $\omega_{s1}$."""

import re

from uq.greek import IN_TEXT, LETTERS, WORD
from uq.printed import minus

_WHOLE = re.compile(r"(?:[A-Za-z]+(?:_[A-Za-z0-9]+)?(?![A-Za-z_])|[\d ()+*/'.-])+")

_SHORT = re.compile(rf"(?:[A-Za-z]|{'|'.join(LETTERS)})(?:\d+|_[A-Za-z0-9]+)?")


def literal(text: str) -> str:
    """Return text in which a dollar sign begins no formula."""
    return text.replace("$", r"\$")


def formula(symbol: str) -> str:
    r"""Return a symbol as a formula: ``k_tra`` becomes ``$k_{\mathrm{tra}}$``.

    Parameters
    ----------
    symbol : str
        Of ASCII letters, digits and signs, each letter with one index at most; anything else is
        returned as text.

    Returns
    -------
    str
    """
    if not _WHOLE.fullmatch(symbol):
        return literal(symbol)
    text = symbol if "_" in symbol else re.sub(r"(?<=[A-Za-z])(\d+)\b", r"_\1", symbol)
    text = re.sub(r"_([A-Za-z0-9]+)", _subscript, text.replace(" ", r"\,"))
    return f"${WORD.sub(lambda found: chr(92) + found[0], text)}$"


def is_short(symbol: str) -> bool:
    """Whether a symbol is one letter with an index at most: ``x1``, ``omega``, ``k_c``."""
    return _SHORT.fullmatch(symbol) is not None


def _subscript(found: re.Match[str]) -> str:
    upright = found[1].isalpha() and not WORD.fullmatch(found[1])
    return rf"_{{\mathrm{{{found[1]}}}}}" if upright else f"_{{{found[1]}}}"


def typeset(text: str) -> str:
    """Return text with its symbols as formulas, its roots and minus signs as such."""
    text = IN_TEXT.sub(lambda found: formula(found[0]), literal(minus(text)))
    return text.replace("sqrt(", "√(").replace(" - ", " \N{MINUS SIGN} ")
