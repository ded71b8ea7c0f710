"""Exceptions with messages for the user: plain lines instead of a traceback."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import PurePath


class InputError(Exception):
    """Raised for invalid input, with one line per fault.

    Parameters
    ----------
    *lines : str
        One complete sentence per fault: location, value, and allowed values.
    """

    def __init__(self, *lines: str):
        super().__init__(*lines)

    @property
    def lines(self) -> tuple[str, ...]:
        """The faults, one per line."""
        return self.args

    def __str__(self) -> str:
        return "\n".join(self.lines)


@contextmanager
def first_fault_alone() -> Iterator[None]:
    """Reduce the faults raised in this context to one line, for text that users do not edit.

    Raises
    ------
    InputError
        The first fault, and the number of further faults.
    """
    try:
        yield
    except InputError as error:
        first, *others = error.lines
        if not others:
            raise
        raise InputError(f"{first}; and {len(others)} more") from None


class RunError(Exception):
    """Raised if a run with valid input gives no result; the message is one plain sentence."""


_LONGEST = 500  # largest number of characters shown of a model's message


def one_line(error: BaseException) -> str:
    """Return the message of an exception on one line; it may be empty."""
    return " ".join(str(error).split())


def described(error: BaseException) -> str:
    """Return the type of an exception and the beginning of its message on one line."""
    text = one_line(error)
    if len(text) > _LONGEST:
        text = text[:_LONGEST] + " ..."
    return f"{type(error).__name__}: {text}" if text else repr(error)


def choices(names: Iterable[str], most: int = 6) -> str:
    """Return a shortened list of names for an error line: ``a, b, c and 4 more``."""
    all_names = list(names)
    more = len(all_names) - most
    shown = ", ".join(all_names[:most]) or "none"
    return f"{shown} and {more} more" if more > 0 else shown


def nearest(name: str, choices: Iterable[str], key: Callable[[str], str] = str.lower) -> str:
    """Return ``"; did you mean 'x'?"`` for the choice closest to `name`, or ``""``.

    Parameters
    ----------
    name : str
        Name given by the user.
    choices : iterable of str
        Allowed names.
    key : callable
        Gives the part of a name that is compared.

    Returns
    -------
    str
        Text to append to an error line.
    """
    by_key = {key(choice): choice for choice in choices}
    close = get_close_matches(key(name), by_key, n=1) or _longer(key(name), by_key)
    return f"; did you mean '{by_key[close[0]]}'?" if close else ""


def _longer(name: str, choices: Iterable[str]) -> list[str]:
    """Return the only choice that begins with a name and an underscore; else none."""
    longer = [choice for choice in choices if choice.startswith(f"{name}_")]
    return longer if len(longer) == 1 else []


def nearest_file(name: str, files: Iterable[str]) -> str:
    """Return `nearest` of file names, compared without folder and ending, which they may share.

    Of files that differ in their ending alone, the one with the ending of `name`.
    """
    ending = PurePath(name).suffix
    ordered = sorted(files, key=lambda file: PurePath(file).suffix == ending)
    return nearest(name, ordered, lambda file: PurePath(file).stem.lower())
