"""TOML literals: reading and writing of values, and text safe for a terminal."""

import json
import re
import tomllib
from collections.abc import Mapping
from math import isinf
from typing import Any


def toml(value: Any) -> str:
    """Return a value as a TOML literal on one line; numbers with full precision."""
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return _quoted(value)
        case list() | tuple():
            return f"[{', '.join(map(toml, value))}]"
        case Mapping():
            inside = ", ".join(f"{key(name)} = {toml(item)}" for name, item in value.items())
            return f"{{{inside}}}"
        case _:
            return str(value)


def key(name: str) -> str:
    """Return the name of an entry in TOML, quoted where necessary."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def shown(value: Any, width: int = 60) -> str:
    """Return a value as a TOML literal for an error line, shortened to `width` characters."""
    try:
        text = toml(value)
    except (ValueError, RecursionError):  # thousands of digits, or of brackets
        return "..."
    return text if len(text) <= width else f"{text[: width - 3]}..."


# Limit of the parts of a key: the time of Python's parser grows with their square.
_MOST_PARTS = 64
_LONG_KEY = re.compile(
    rf"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{_MOST_PARTS}}}"""
)


def read_toml(text: str) -> dict[str, Any]:
    """Return parsed TOML, with numbers as in `read_number`.

    Raises
    ------
    ValueError
        The text is not TOML, or a key has too many parts.
    OverflowError
        A number is too large.
    RecursionError
        The text is nested too deeply.
    """
    if match := _LONG_KEY.search(text):
        line = text.count("\n", 0, match.start()) + 1
        raise ValueError(f"a key of more than {_MOST_PARTS} parts (at line {line})")
    return tomllib.loads(text, parse_float=read_number)


def read_number(text: str) -> float:
    """Return a number from text; infinite only if written as infinity.

    Raises
    ------
    ValueError
        The text is not a number.
    OverflowError
        The number is too large, such as 1e400.
    """
    number = float(text)
    if isinf(number) and "inf" not in text.lower():
        raise OverflowError(
            f"{text} is too large for a number; write it as inf if infinity is meant"
        )
    return number


# Control characters except the line feed, and characters that change the direction of text.
_UNPRINTABLE = re.compile(
    "[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)


def plain(text: str) -> str:
    r"""Return a text without control characters: ``\u001b`` replaces an escape character."""
    return _UNPRINTABLE.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def without_control(text: str) -> str:
    """Return a text from a file as in `plain`; harmless tabs and line ends are kept."""
    return re.sub(r"[^\t\r]+", lambda match: plain(match[0]), text)


def plain_line(text: str) -> str:
    """Return a text as in `plain`, on one line."""
    return plain(text).replace("\n", "\\n")
