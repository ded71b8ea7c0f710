"""Errors for the user: plain lines, never a traceback."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches


class InputError(Exception):
    """Bad input, explained.

    Parameters
    ----------
    *lines : str
        One complete sentence per fault: where, which value, what is allowed.
    """

    def __init__(self, *lines: str):
        super().__init__(*lines)

    @property
    def lines(self) -> tuple[str, ...]:
        """The faults, one line each."""
        return self.args

    def __str__(self) -> str:
        return "\n".join(self.lines)


@contextmanager
def first_fault_alone() -> Iterator[None]:
    """Shorten the faults of a part of a result to one line: nobody edits it there.

    Raises
    ------
    InputError
        The first of several faults, and the number of others.
    """
    try:
        yield
    except InputError as error:
        first, *others = error.lines
        if not others:
            raise
        raise InputError(f"{first}; and {len(others)} more") from None


class RunError(Exception):
    """A run that gives no result although its input is valid: one plain sentence."""


_LONGEST = 500  # characters of a text that a model wrote


def one_line(error: BaseException) -> str:
    """Return the text of an exception in one line, which may be empty."""
    return " ".join(str(error).split())


def described(error: BaseException) -> str:
    """Return the kind of an exception and the beginning of its text in one line."""
    text = one_line(error)
    if len(text) > _LONGEST:
        text = text[:_LONGEST] + " ..."
    return f"{type(error).__name__}: {text}" if text else repr(error)


def choices(names: Iterable[str], most: int = 6) -> str:
    """Return the first of some names for an error line: ``a, b, c and 4 more``."""
    all_names = list(names)
    more = len(all_names) - most
    shown = ", ".join(all_names[:most]) or "none"
    return f"{shown} and {more} more" if more > 0 else shown


def nearest(name: str, choices: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the choice closest to `name`, or ``""``.

    Parameters
    ----------
    name : str
        What was given.
    choices : iterable of str
        What is allowed.

    Returns
    -------
    str
        To be appended to an error line.
    """
    by_lower = {choice.lower(): choice for choice in choices}
    close = get_close_matches(name.lower(), by_lower, n=1)
    return f"; did you mean '{by_lower[close[0]]}'?" if close else ""
