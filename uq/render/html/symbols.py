"""Symbols of formulas as HTML."""

import re

from markupsafe import Markup

from uq.text.literals import plain


def parts_of(symbol: str) -> list[str]:
    """Return a symbol cut before and after its indices: ``k_c(0)`` is ``k``, ``c``, ``(0)``.

    One with several indices in a row is a name, and not cut.
    """
    if re.search(r"_[A-Za-z0-9]*_", symbol):
        return [plain(symbol)]
    return re.split(r"_([A-Za-z0-9]+)", plain(symbol))


def indexed(symbol: str) -> Markup:
    """Return a symbol with its index below the line: ``k_c`` as ``k<sub>c</sub>``."""
    parts = (
        Markup("<sub>{}</sub>" if i % 2 else "{}").format(part)
        for i, part in enumerate(parts_of(symbol))
    )
    return Markup("").join(parts)
