"""Faults of a study file, and their error lines for the user."""

import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from uq.errors import nearest
from uq.text.literals import key, shown
from uq.text.quantities import EXAMPLE

MISSING = "is missing"
WITH_UNITS = ("uncertain", "fixed")
"""Tables whose numbers may have a unit."""
_COMMA = re.compile(r"\s*([-+]?\d+),(\d+)")

_REASONS = {
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "dict_type": "must be a table",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "int_type": "must be a whole number, without a decimal point",
    "bool_type": "must be true or false",
    "string_type": "must be a text in quotes",
    "string_too_long": "must have at most {max_length} characters",
    "string_pattern_mismatch": "must consist of letters, digits, '-' and '_'",
    "tuple_type": "must be a list",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le}",
    "literal_error": "must be {expected}",
    "value_error": "{error}",
}


class InputFault(NamedTuple):
    """A fault in one entry of a study file.

    Attributes
    ----------
    path : tuple of str or int
        Path of the entry: table, key, index in a list; relative if only a part of the file is
        checked.
    problem : str
        Problem, allowed values and remedy.
    value : object
        Value in the file; None if it is not shown.
    """

    path: tuple[str | int, ...]
    problem: str
    value: Any = None

    def within(self, *path: str) -> "InputFault":
        """Return the fault with its path in the complete file."""
        return self._replace(path=(*path, *self.path))

    @property
    def line(self) -> str:
        """The fault as ``[table] key = value: problem``."""
        depth = 2 if self.path[0] == "uncertain" else 1
        table, entry = _dotted(self.path[:depth]), _dotted(self.path[depth:])
        equals = "" if self.value is None else f" = {shown(self.value)}"
        if entry:
            return f"[{table}] {entry}{equals}: {self.problem}"
        if self.value is None or isinstance(self.value, dict):
            return f"[{table}]: {self.problem}"
        return f"{table}{equals}: {self.problem}"


def _dotted(path: tuple[str | int, ...]) -> str:
    parts = [f"[{part}]" if isinstance(part, int) else f".{key(part)}" for part in path]
    return "".join(parts).removeprefix(".")


def unknown(kind: str, name: str, allowed: Iterable[str]) -> str:
    """Return the message for an unknown name, with the closest name and all allowed names."""
    return f"no such {kind}{nearest(name, allowed)} (allowed: {', '.join(allowed)})"


def fault_of(
    error: dict[str, Any], allowed_at: Callable[[Sequence[Any]], tuple[str, Sequence[str]]]
) -> InputFault:
    """Return a pydantic error as a fault of the study file.

    Parameters
    ----------
    error : dict
        An item of ``ValidationError.errors()``.
    allowed_at : callable
        Path of an unknown key -> its kind in words, and the allowed names.
    """
    path, kind = tuple(error["loc"]), error["type"]
    if kind == "missing":
        return InputFault(path, MISSING)
    if kind == "extra_forbidden":
        name_kind, names = allowed_at(path)
        return InputFault(path, unknown(name_kind, str(path[-1]), names), error["input"])
    reason = _REASONS.get(kind, "").format(**error.get("ctx", {}))
    if kind == "int_type" and isinstance(error["input"], str):
        reason = "must be a whole number, without quotes"
    if kind == "float_type" and isinstance(error["input"], str) and path[0] in WITH_UNITS:
        comma = _COMMA.match(error["input"])
        meant = f"; numbers have a decimal point: {comma[1]}.{comma[2]}" if comma else ""
        reason = f"must be a number, or have its unit: {EXAMPLE}{meant}"
    return InputFault(path, (reason or error["msg"]) + _as_share(error), error["input"])


def _as_share(error: dict[str, Any]) -> str:
    """Return the fraction that a percentage stands for where at most 1 is allowed, or ""."""
    limits = error.get("ctx", {})
    most, given = limits.get("lt", limits.get("le", 2)), error["input"]
    if most > 1 or not isinstance(given, int | float) or not 1 < given <= 100:
        return ""
    return f"; did you mean {given / 100:g}?"
