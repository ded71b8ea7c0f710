"""One fault of a study file, and its line for the user."""

from typing import Any, NamedTuple

from uq.literals import key, shown


class Fault(NamedTuple):
    """Something wrong with one entry of a study file.

    Attributes
    ----------
    path : tuple of str or int
        Its place: table, key, index in a list. Of a part of the file: the place in that part.
    problem : str
        What is wrong, what is allowed, what to do.
    value : object
        The value in the file; None if it is not to be shown.
    """

    path: tuple[str | int, ...]
    problem: str
    value: Any = None

    def within(self, *path: str) -> "Fault":
        """Return the fault with its place in the whole file."""
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
