"""Symbols of formulas, which machines declare in ASCII, as text: ``psi_1`` as ψ₁."""

import re
from unicodedata import lookup

LETTERS = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi "
    "psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"
).split()

_LETTER = rf"(?:{'|'.join(LETTERS)})"
WORD = re.compile(rf"(?<![A-Za-z]){_LETTER}(?![A-Za-z])")
"""A letter by its name."""

IN_TEXT = re.compile(
    rf"(?<![\w-])(?:{_LETTER}(?:_[A-Za-z0-9]+|\d+)?|[A-Za-z]_[A-Za-z0-9]+)(?!\w)(?:\(0\))?"
)
"""A symbol among words."""

_LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def symbol(text: str) -> str:
    """Return a symbol with Greek letters and digits as subscripts: ``Omega/(2 pi)`` as Ω/(2 π)."""
    text = WORD.sub(lambda match: _letter(match[0]), text)
    return re.sub(r"(?<!\w)([^\W\d_])_?(\d+)\b", _lowered, text)


def readable(text: str) -> str:
    """Return words with the symbols among them as by `symbol`, and minus signs as such."""
    text = IN_TEXT.sub(lambda match: symbol(match[0]), text)
    return text.replace(" - ", " \N{MINUS SIGN} ")


def _letter(name: str) -> str:
    case = "CAPITAL" if name[0].isupper() else "SMALL"
    return lookup(f"GREEK {case} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}")


def _lowered(match: re.Match[str]) -> str:
    return match[1] + match[2].translate(_LOWERED)
