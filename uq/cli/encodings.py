"""Characters that the encoding of a stream lacks, as it can write them: s-1, um, >=."""

import codecs
import unicodedata

HANDLER = "readable"
"""Name of the error handler of codecs."""

_WRITTEN = {
    **{"µ": "u", "μ": "u", "≥": ">=", "≤": "<=", "≠": "!=", "≈": "~", "±": "+/-", "∓": "-/+"},
    **{"−": "-", "–": "-", "—": "-", "‐": "-", "‑": "-", "×": "x", "·": ".", "⋅": ".", "÷": "/"},
    **{"°": " deg", "∞": "inf", "√": "sqrt", "∂": "d", "∫": "int", "∑": "sum", "Ω": "Omega"},
    **{"→": "->", "←": "<-", "↔": "<->", "⇒": "=>", "…": "...", "′": "'", "″": "''", "•": "*"},
    **{"‘": "'", "’": "'", "“": '"', "”": '"', "«": '"', "»": '"', "ß": "ss", "⁄": "/"},
    **{"─": "-", "━": "-", "│": "|", "┃": "|", "█": "#", "\u2060": "", "\u200b": ""},
}

_EXPONENTS = tuple("⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _replaced(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text, end = error.object, error.end
    while text[end - 1 : end] in _EXPONENTS and text[end : end + 1] in _EXPONENTS[1:]:
        end += 1  # all of an exponent, though the encoding has some of its digits
    power = "^" if text[error.start] in _EXPONENTS and text[: error.start][-1:].isdigit() else ""
    return power + "".join(map(_readable, text[error.start : end])), end


def _readable(character: str) -> str:
    """Return a character in ASCII: by the list above, its parts, or the name of a letter."""
    if character.isascii():
        return character
    if character in _WRITTEN:
        return _WRITTEN[character]
    parts = unicodedata.normalize("NFKD", character)
    if parts != character:
        return "".join(_readable(part) for part in parts if not unicodedata.combining(part))
    kind, _, letter = unicodedata.name(character, "").partition(" LETTER ")
    letter = letter.replace("LAMDA", "LAMBDA")
    if kind.startswith("GREEK") and " " not in letter:
        return letter.lower() if kind.endswith("SMALL") else letter.capitalize()
    return "" if unicodedata.combining(character) else "?"


codecs.register_error(HANDLER, _replaced)
