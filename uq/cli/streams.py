"""Standard streams that are closed, full or lack characters: one line, no traceback."""

import codecs
import errno
import io
import os
import sys
import unicodedata
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TextIO

from uq.text.literals import plain_line

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


_PLACES = ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_WRONLY))


class Watched(io.TextIOWrapper):
    """A stream that records why writing failed.

    Attributes
    ----------
    failure : OSError or None
    """

    failure: OSError | None = None

    def write(self, text: str) -> int:
        """Write text, as every stream does."""
        return self._recorded(super().write, text)

    def flush(self) -> None:
        """Write what is buffered."""
        self._recorded(super().flush)

    def _recorded(self, action: Callable[..., Any], *arguments: str) -> Any:
        try:
            return action(*arguments)
        except OSError as error:
            self.failure = error
            raise


def watch() -> None:
    """Watch the standard streams, replace closed ones, and let them write what they can encode.

    Otherwise the next file opened would take the place of one. Writing to standard output then
    fails; what goes to standard error is lost.
    """
    for number, way in _PLACES:  # each opens at the lowest number that is free
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, way)
    for number, name in ((1, "stdout"), (2, "stderr")):
        stream = getattr(sys, name)
        if stream is None or type(stream) is io.TextIOWrapper:  # else it has been replaced already
            watched = _watched(stream, number)
            setattr(sys, name, watched)
            setattr(sys, f"__{name}__", watched)  # which is asked for the width of the terminal


def _watched(stream: io.TextIOWrapper | None, number: int) -> Watched:
    if stream is None:
        return Watched(open(number, "wb", closefd=False), "utf-8")
    how = (stream.encoding, HANDLER, None, stream.line_buffering, stream.write_through)
    return Watched(stream.detach(), *how)


def complain(*lines: str) -> None:
    """Print lines to standard error, if it can be written."""
    with suppress(OSError):
        for line in lines:
            print(plain_line(line), file=sys.stderr)


def are_lost() -> bool:
    """Return whether writing to a standard stream has failed."""
    return any(getattr(stream, "failure", None) for stream in (sys.stdout, sys.stderr))


def finish(code: int) -> int:
    """Flush the standard streams; return the exit code of the ending process."""
    error = _failure(sys.stdout)
    if error is not None:
        code = code or 1
        if error.errno != errno.EPIPE:  # else the reader, such as "head", has closed it
            complain(f"uq: standard output cannot be written: {error.strerror}")
        _discard(sys.stdout)
    if _failure(sys.stderr) is not None:
        _discard(sys.stderr)
    return code


def _failure(stream: TextIO) -> OSError | None:
    with suppress(OSError):
        stream.flush()
    return getattr(stream, "failure", None)


def _discard(stream: TextIO) -> None:
    """Discard buffered text that the interpreter would write on exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
