"""Fact: numbers with their sentence and the functions that computed them; facts form a tree.

Every verb writes its numbers once, as a tree of facts. The renderers read it: JSON the numbers,
terminal and HTML the sentences with their keys, ``uq trace`` functions and rows.

    median = Fact({"value": 6.3, "low": 6.2, "high": 6.4}, by=(quantile,))
    tree = Fact({"rows": 1000, "outputs": {"life": {"median": median}}}, by=(summarise,))
    tree.json                                    # {"rows": 1000, "outputs": {"life": ...}}
    tree.at("outputs", "life", "median").by      # (quantile,)
    tree.at("rows").by                           # (summarise,): inherited

A fact inherits functions and rows from the one that contains it, unless it has its own. Notes add
up, but for a fact with functions of its own: it has notes of its own, too.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from uq.result.result import Result

Functions = tuple[Callable[..., Any], ...]
"""Functions that compute a number; their docstrings cite the source."""

Path = tuple[str, ...]


@dataclass(frozen=True)
class Fact:
    """Numbers of a result that belong together, and the facts that they consist of.

    Attributes
    ----------
    members : dict, list or number
        The content, in the order of the JSON: name -> number, words, `Fact`, list or dict of
        these; or a list or a number alone. A member called ``sentence`` (``text`` in advice)
        states the numbers in words.
    by : tuple of callable
        The functions that compute its numbers, and those of its facts without functions.
    by_member : dict of str to tuple of callable
        Name of a member -> the functions that compute it, where they differ.
    rows : Result, optional
        The rows that suffice to compute its numbers again; by default those of its parent, of the
        whole tree all rows.
    words : str
        Its numbers in words, where no member holds them.
    mentions : tuple of tuple of str
        Paths from here to the numbers in the sentence; by default the fact itself.
    notes : tuple of str
        Sentences on how its functions compute it.
    more : dict
        Further members, reached by `at` alone: JSON and `each` leave them out.
    """

    members: Any
    by: Functions = ()
    by_member: Mapping[str, Functions] = field(default_factory=dict)
    rows: Result | None = None
    words: str = ""
    mentions: tuple[Path, ...] = ((),)
    notes: tuple[str, ...] = ()
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def sentence(self) -> str:
        """Its numbers in words; "" where it has none."""
        members = self.members if isinstance(self.members, Mapping) else {}
        return str(members.get("sentence") or members.get("text") or self.words)

    @property
    def json(self) -> Any:
        """The numbers and sentences of it and its facts in plain data."""
        return _plain(self.members)

    def each(self, change: Callable[["Fact"], "Fact"]) -> "Fact":
        """Return the tree with a change of it and of every fact in it."""
        return change(replace(self, members=_mapped(self.members, lambda fact: fact.each(change))))

    def at(self, *path: str) -> "Place":
        """Return the content at a path, with its functions and rows.

        Raises
        ------
        KeyError
            When the path leads nowhere.
        """
        place = Place(self, self.by, self.rows, self.notes)
        for name in path:
            content, by = place.content, place.by
            if isinstance(content, Fact):
                by = content.by_member.get(name, by)
                content = content.more if name in content.more else content.members
            place = place._replace(content=_member(content, name), by=by)
            if isinstance(fact := place.content, Fact):
                # Functions of its own have notes of their own.
                notes = fact.notes if fact.by else place.notes + fact.notes
                rows = place.rows if fact.rows is None else fact.rows
                place = Place(fact, fact.by or by, rows, notes)
        return place


class Place(NamedTuple):
    """A node at a path of a tree of facts.

    Attributes
    ----------
    content : Fact or plain data
    by : tuple of callable
        The functions that compute its numbers.
    rows : Result or None
        The rows that suffice to compute it again; None for all.
    notes : tuple of str
        Of the facts on the way.
    """

    content: Any
    by: Functions
    rows: Result | None
    notes: tuple[str, ...]

    @property
    def json(self) -> Any:
        """The content in plain data."""
        return _plain(self.content)


def _plain(member: Any) -> Any:
    return _mapped(member, lambda fact: fact.json)


def _mapped(member: Any, change: Callable[[Fact], Any]) -> Any:
    """Return plain data with a change of the facts in it."""
    if isinstance(member, Fact):
        return change(member)
    if isinstance(member, Mapping):
        return {name: _mapped(element, change) for name, element in member.items()}
    if isinstance(member, list):
        return [_mapped(element, change) for element in member]
    return member


def _member(members: Any, name: str) -> Any:
    if isinstance(members, list):
        if not name.isdecimal() or int(name) >= len(members):
            raise KeyError(name)
        return members[int(name)]
    if not isinstance(members, Mapping):
        raise KeyError(name)
    return members[name]
