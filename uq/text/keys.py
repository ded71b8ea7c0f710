"""Keys of numbers: the path in the JSON of a verb, as in `outputs/life/quantiles/0.05`.

A key of a verb other than `uq summary` begins with the name of the verb, with options in brackets:
``sensitivity[method=delta]/outputs/y/delta/x1``. In names, ``~`` is written ``~0`` and ``/`` is
written ``~1``, as in JSON Pointer (RFC 6901).
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from typing import Any, NamedTuple

from uq.errors import InputError, nearest
from uq.text.quantities import read_quantity

SUMMARY = "summary"

_LONGEST = 200  # largest number of characters of a key in an error line

Path = tuple[str, ...]
Options = Mapping[str, str]
Json = Mapping[str, Any]


class Key(NamedTuple):
    """The parts of a key.

    Attributes
    ----------
    verb : str
    options : dict of str to str
    path : tuple of str
        Path in the JSON of the verb.
    """

    verb: str
    options: dict[str, str]
    path: Path


def key_of(
    *path: str | int, verb: str = SUMMARY, options: Mapping[str, str | None] | None = None
) -> str:
    """Return the key of a number.

    Parameters
    ----------
    *path : str or int
        Path in the JSON of the verb.
    verb : str
    options : dict of str to str, optional
        Options that are None are omitted.

    Returns
    -------
    str
    """
    given = [f"{name}={value}" for name, value in (options or {}).items() if value is not None]
    parts = [_escaped(str(part)) for part in path]
    inside = f"[{','.join(given)}]" if given else ""
    return "/".join(parts if verb == SUMMARY and not given else [verb + inside, *parts])


def taken_apart(key: str, verbs: Mapping[str, Iterable[str]]) -> Key:
    """Return the parts of a key.

    Parameters
    ----------
    key : str
    verbs : dict of str to iterable of str
        Name -> names of its options.

    Returns
    -------
    Key

    Raises
    ------
    InputError
        The verb does not have this option.
    """
    match = re.match(rf"({'|'.join(map(re.escape, verbs))})(?:\[(.*?)\])?(?:/|$)", key)
    verb, inside = (match[1], match[2]) if match else (SUMMARY, None)
    rest = key[match.end() :] if match else key
    options, names = {}, tuple(verbs[verb])
    begin = "|".join(
        re.escape(option if option.endswith(".") else f"{option}=") for option in names
    )
    for text in re.split(f",(?={begin})", inside) if inside else []:  # values may contain commas
        name, equals, value = text.partition("=")
        begins = any(name.startswith(option) for option in names if option.endswith("."))
        if not (name in names or begins) or not equals:
            allowed = (
                ", ".join(f"{option}{'NAME' * option.endswith('.')}=..." for option in names)
                or "none"
            )
            raise InputError(
                f"key '{_cut(key)}': no such option of {verb}: {_cut(text)} (allowed: {allowed})"
            )
        options[name] = value
    path = tuple(_plain(part) for part in rest.split("/")) if rest else ()
    return Key(verb, options, tuple(map(_as_number, ("", *path), path)))


def _as_number(before: str, part: str) -> str:
    """Return a threshold with its unit, ``24 hours``, as the JSON has it: ``86400.0``."""
    if before != "thresholds":
        return part
    with suppress(ValueError):
        return repr(float(read_quantity(part)))
    return part


def value_at(whole: Any, path: Path) -> Any:
    """Return the part of JSON at a path.

    Raises
    ------
    KeyError
        The path does not exist.
    """
    for part in path:
        if isinstance(whole, list):
            if not part.isdecimal() or int(part) >= len(whole):
                raise KeyError(part)
            whole = whole[int(part)]
        elif isinstance(whole, dict):
            whole = whole[part]
        else:
            raise KeyError(part)
    return whole


def numbers_in(entry: Any) -> dict[str, Any]:
    """Return a number with its explanations; empty if there is no number.

    Parameters
    ----------
    entry : object
        A number, or an estimate with ``value``, ``low`` and the like.

    Returns
    -------
    dict
    """
    if is_number(entry):
        return {"value": entry}
    if not isinstance(entry, dict) or any(map(_holds_numbers, entry.values())):
        inner = entry if isinstance(entry, dict) and is_number(entry.get("value", "")) else {}
        return {name: value for name, value in inner.items() if not isinstance(value, dict | list)}
    return entry if any(map(is_number, entry.values())) else {}


def is_number(value: object) -> bool:
    """Whether a JSON value is a number, or null in place of a number."""
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _holds_numbers(entry: object) -> bool:
    """Whether a part of JSON contains numbers."""
    words = isinstance(entry, list) and all(isinstance(element, str) for element in entry)
    return isinstance(entry, dict | list) and not words


def paths_of_numbers(whole: Any, path: Path = ()) -> Iterator[Path]:
    """Yield the path of every number and of every estimate in JSON."""
    if path and numbers_in(whole):
        yield path
    inner = enumerate(whole) if isinstance(whole, list) else ()
    for name, entry in whole.items() if isinstance(whole, dict) else inner:
        if isinstance(entry, dict | list) or is_number(entry):
            yield from paths_of_numbers(entry, (*path, str(name)))


def no_such_key(key: Key, whole: Any, verbs: Iterable[str]) -> InputError:
    """Return the error for a key without a number, with the closest valid key.

    Parameters
    ----------
    key : Key
    whole : dict
        The JSON of its verb.
    verbs : iterable of str
        Verbs with which the intended key may begin.
    """

    def text(path: Path) -> str:
        return key_of(*path, verb=key.verb, options=key.options)

    wanted, candidates = text(key.path), [text(path) for path in paths_of_numbers(whole)]
    inside = [candidate for candidate in candidates if candidate.startswith(f"{wanted}/")]
    if inside:
        return InputError(f"key '{wanted}': several numbers; add to it, as in '{inside[0]}'")
    near = nearest(wanted, candidates) or nearest(wanted.partition("/")[0], verbs)
    return InputError(f"no such key '{_cut(wanted)}'{near or f' (the first one: {candidates[0]})'}")


def _cut(key: str) -> str:
    """Return a key for an error line, shortened to the maximum length."""
    line = " ".join(key.split())
    return line if len(line) <= _LONGEST else f"{line[:_LONGEST]}..."


def _escaped(part: str) -> str:
    return part.replace("~", "~0").replace("/", "~1")


def _plain(part: str) -> str:
    return part.replace("~1", "/").replace("~0", "~")
