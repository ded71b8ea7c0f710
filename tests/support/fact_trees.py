"""All facts of a tree, each with its path."""

from collections.abc import Mapping

from uq.assess.fact import Fact


def walk(member, path=()):
    """Yield every fact in a fact or in plain data with its path, parents first."""
    if isinstance(member, Fact):
        yield path, member
        member = member.members
    numbered = enumerate(member) if isinstance(member, list) else ()
    for name, element in member.items() if isinstance(member, Mapping) else numbered:
        yield from walk(element, (*path, str(name)))
