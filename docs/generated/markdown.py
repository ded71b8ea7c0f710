"""How numbers, symbols, units and tables are written on a page."""

import re
from collections.abc import Iterable, Sequence
from math import inf, pi
from typing import Any

_GREEK = ("beta", "gamma", "mu", "omega", "phi", "pi", "psi", "rho", "sigma", "xi", "zeta")
_GREEK += tuple(name.capitalize() for name in ("gamma", "omega", "phi", "psi"))
_MULTIPLES = {pi / 6: "π/6", 14 * pi / 180: "14π/180", pi: "π", 2 * pi: "2π"}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def table(header: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    rows = [header, ["---"] * len(header), *lines]
    return "\n".join(f"| {' | '.join(cell.replace('|', '&#124;') for cell in r)} |" for r in rows)


def formula(symbol: str) -> str:
    r"""Write a symbol of a declaration, such as ``k_tra`` or ``Omega/(2 pi)``, for mathematics.

    >>> print(formula("omega_s1"), formula("m e_1"), formula("X0"))
    $\omega_{\mathrm{s1}}$ $m e_{1}$ $X_{0}$
    """

    def part(found: re.Match[str]) -> str:
        word, digits, below = found.groups()
        word = f"\\{word} " if word in _GREEK else word
        below = digits or below
        if below in _GREEK:
            below = f"\\{below}"
        elif below and re.search("[a-z]{2}|[a-z][0-9A-Z]|[A-Z][a-z]", below):
            below = f"\\mathrm{{{below}}}"
        return f"{word.strip()}_{{{below}}}" if below else word

    return f"${re.sub(r'([A-Za-z]+?)(?:(0)|_([A-Za-z0-9]+))?(?![A-Za-z_0-9])', part, symbol)}$"


def unit(text: str) -> str:
    r"""Write a CF unit with superscripts, in one piece.

    >>> unit("m2 N-1"), unit("1")
    ('m²\xa0N⁻¹', '1')
    """
    if text == "1":
        return text
    raised = re.sub(r"(?<=[A-Za-z])-?\d+", lambda found: found[0].translate(_SUPERSCRIPTS), text)
    return raised.replace(" ", "\u00a0")


def value(number: Any) -> str:
    """Write a number, a word or a list as a study file has it."""
    if isinstance(number, bool):
        return str(number).lower()
    if isinstance(number, float):
        return _MULTIPLES.get(number, f"{number:.6g}")
    if isinstance(number, tuple):
        return f"[{', '.join(value(one) for one in number)}]"
    return f'"{number}"' if isinstance(number, str) else str(number)


def interval(ends: tuple[float, float] | None) -> str:
    """Write what is admissible."""
    if ends is None:
        return ""
    low, high = ends
    return f"from {_end(low)}" if high == inf else f"{_end(low)} to {_end(high)}"


def _end(end: float) -> str:
    if abs(end) in _MULTIPLES:
        return f"{'−' if end < 0 else ''}{_MULTIPLES[abs(end)]}"
    text = f"{end:.0f}" if 1e3 <= abs(end) < 1e6 else f"{end:.4g}"
    return minus(text)


def minus(text: str) -> str:
    """Write the sign of a negative number as a minus."""
    return text.replace("-", "−", 1) if text.startswith("-") else text
