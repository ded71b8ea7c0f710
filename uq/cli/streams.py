"""Standard streams that are closed, full or no longer read: one line, no traceback."""

import errno
import io
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TextIO

from uq.cli.encodings import HANDLER
from uq.text.literals import plain_line

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
    """Discard what the interpreter would write on exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
