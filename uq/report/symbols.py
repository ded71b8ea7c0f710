"""Symbols of formulas as HTML."""

import re

from markupsafe import Markup, escape

from uq.literals import plain


def indexed(symbol: str) -> Markup:
    """Return a symbol with its index below the line: ``k_c`` as ``k<sub>c</sub>``."""
    return Markup(re.sub(r"_([A-Za-z0-9]+)", r"<sub>\1</sub>", str(escape(plain(symbol)))))
