"""Keys that tables of a study may have."""

from collections.abc import Sequence
from difflib import get_close_matches


def no_such_key(owner: str, key: str, allowed: Sequence[str]) -> str:
    """Return the line that refuses a key, with the nearest right one."""
    near = get_close_matches(key, allowed, n=1)
    meant = f" (did you mean '{near[0]}'?)" if near else ""
    return f"{owner} has no {key!r}{meant}; it takes {', '.join(allowed) or 'no numbers'}"
