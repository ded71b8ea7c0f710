"""Standard streams that are closed, full or no longer read: one line, no traceback."""

import codecs
import errno
import io
import os
import re
import sys
import unicodedata
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TextIO

from uq.literals import plain_line

_READABLE = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺₀₁₂₃₄₅₆₇₈₉", "0123456789-+0123456789", strict=True)) | {
    "µ": "u",
    "μ": "u",
    "Ω": "ohm",
    "°": "deg",
    "≥": ">=",
    "≤": "<=",
    "≈": "~",
    "±": "+-",
    "×": "x",
    "·": "*",
    "\N{MINUS SIGN}": "-",
    "\N{EN DASH}": "-",
    "\N{EM DASH}": "-",
    "\N{NO-BREAK SPACE}": " ",
    "…": "...",
    "∞": "inf",
    "√": "sqrt",
}
_GREEK = re.compile("GREEK (SMALL|CAPITAL) LETTER ([A-Z]+)")

_PLACES = ((0, os.O_RDONLY), (1, os.O_RDONLY), (2, os.O_WRONLY))


def readable(error: UnicodeError) -> tuple[str, int]:
    """Return ASCII for characters that a stream cannot encode, as an error handler of `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end]
    return "".join(map(_in_ascii, text)), error.end


def _in_ascii(character: str) -> str:
    if character in _READABLE:
        return _READABLE[character]
    if greek := _GREEK.match(unicodedata.name(character, "")):
        name = greek[2].replace("LAMDA", "LAMBDA")
        return name.lower() if greek[1] == "SMALL" else name.capitalize()
    letters = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return letters or "?"


codecs.register_error("uq.readable", readable)


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
    """Watch the standard streams, and replace closed ones.

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
    how = (stream.encoding, "uq.readable", None, stream.line_buffering, stream.write_through)
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
    """Discard what the interpreter would write on exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
