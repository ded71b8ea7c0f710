"""Quality of the source of a number: measured, assumed, or chosen."""

import re

from uq.result.result import Result

ASSUMED = "assumed"
CHOSEN = "chosen"
"""Of a quantity whose range is one of designs: nothing to measure, and no tolerance."""

_WORDS = f"(given|inferred|fitted|{ASSUMED}|{CHOSEN})"
_MARK = re.compile(rf"(?:^|[:;,] ){_WORDS}\b|(?<!\bnot )\b{_WORDS}$")


def mark(source: str) -> str:
    """Return the quality of a number according to its source, or "".

    Parameters
    ----------
    source : str
        Such as ``"Knudsen & Massih 2002, Table 1: given, its exponent inferred"``.

    Returns
    -------
    str
        ``given``, ``inferred``, ``fitted``, ``assumed`` or ``chosen``: the first that begins the
        sentence or one of its parts, or ends it.
    """
    match = _MARK.search(source)
    return (match[1] or match[2]) if match else ""


def mark_of(result: Result, name: str) -> str:
    """Return the quality of a parameter of a result; "" also without a source."""
    return mark(str(result.dataset[name].attrs.get("source", "")))
