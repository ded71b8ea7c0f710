"""Changes of a parsed study file, each named by the place of its entry."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from uq.errors import InputError, nearest
from uq.text.literals import key, read_toml, shown, toml

_KEPT = ("times", "level", "source")
"""Entries of an uncertain input that another law leaves as they are."""


def change(data: dict[str, Any], place: str, value: Any, source: str) -> None:
    """Set or remove one entry of a parsed study file, in place.

    Parameters
    ----------
    data : dict
        Parsed study file.
    place : str
        Table, key and subkey, such as ``uncertain.initial_gap.sd`` or ``design.samples``.
    value : object
        As in TOML; None removes the entry. Another law keeps `times`, `level` and `source` of its
        input unless it states its own.
    source : str
        Name of the study in error lines.

    Raises
    ------
    InputError
        When there is no such entry to remove, no such uncertain input, or no TOML for the value.
    """
    *tables, entry = place.split(".", 2)  # the name of an element may have dots
    entries: Any = data
    for depth, name in enumerate(tables):
        if depth and tables[0] == "uncertain" and name not in entries:
            raise InputError(
                f"{source}: '{name}' is not uncertain in this study{nearest(name, entries)}"
            )
        entries = entries.setdefault(name, {})
        if not isinstance(entries, dict):
            raise InputError(f"{source}: {place}: {'.'.join(tables[: depth + 1])} has no keys")
    if value is None:
        if entry not in entries:
            raise InputError(f"{source}: {place}: no such entry to remove{nearest(entry, entries)}")
        del entries[entry]
        return
    value = _as_toml(place, value, source)
    if tables == ["uncertain"] and isinstance(value, dict):
        value = value | _of_input(entries.get(entry)) | value
    elif tables[:1] == ["uncertain"] and entry == "distribution":
        kept = _of_input(entries)
        entries.clear()
        entries |= kept
    entries[entry] = value


def _of_input(entries: Any) -> dict[str, Any]:
    """Return the entries of an uncertain input that do not describe its law."""
    if not isinstance(entries, dict):
        return {}
    return {name: value for name, value in entries.items() if name in _KEPT}


def _as_toml(place: str, value: Any, source: str) -> Any:
    """Return a value as a study file would have it."""
    plain = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    try:
        return read_toml(f"x = {toml(plain)}")["x"]
    except (ValueError, OverflowError, RecursionError):
        allowed = "a number, a text, a list or a mapping"
        raise InputError(f"{source}: {place} = {shown(value)}: must be {allowed}") from None


def study_text(data: Mapping[str, Any]) -> str:
    """Return a parsed study file as text: a heading for each table and each uncertain input."""
    loose = "".join(_line(name, value) for name, value in data.items() if not _is_table(value))
    blocks = [loose] if loose else []
    for name, table in data.items():
        if _is_table(table) and table and all(map(_is_table, table.values())):
            blocks += [_block(f"{key(name)}.{key(part)}", table[part]) for part in table]
        elif _is_table(table):
            blocks.append(_block(key(name), table))
    return "\n".join(blocks)


def _block(heading: str, table: Mapping[str, Any]) -> str:
    return f"[{heading}]\n" + "".join(_line(name, value) for name, value in table.items())


def _line(name: str, value: Any) -> str:
    return f"{key(name)} = {toml(value)}\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)
