"""How well a number is known, according to its source."""

import re

ASSUMED = "assumed"

_MARK = re.compile(
    r"(?:^|[:;,] )(given|inferred|fitted|assumed)\b|(?<!\bnot )\b(given|inferred|fitted|assumed)$"
)


def mark(source: str) -> str:
    """Return how well a number is known according to its source, or "".

    Parameters
    ----------
    source : str
        Such as ``"Knudsen & Massih 2002, Table 1: given, its exponent inferred"``.

    Returns
    -------
    str
        ``given``, ``inferred``, ``fitted`` or ``assumed``: the first that begins the sentence or
        one of its parts, or ends it.
    """
    found = _MARK.search(source)
    return (found[1] or found[2]) if found else ""
