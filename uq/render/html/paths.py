"""Paths of a drawing, written with few characters."""

import re

STEP = 0.01
"""Numbers are rounded to this [px]: far below what can be seen."""

_LINES = re.compile(r"(?:\s*(?:[ML]\s+\S+\s+\S+|z))+\s*")


def shortened(path: str) -> str:
    """Return the path of an SVG element in relative steps: a staircase as ``h`` and ``v``.

    Parameters
    ----------
    path : str
        As matplotlib writes it: ``M 1.0 2.0 L 3.0 2.0``.

    Returns
    -------
    str
        The same path; a path with curves is returned as it is.
    """
    if not _LINES.fullmatch(path):
        return path
    parts, words = [], iter(path.split())
    here = start = (0, 0)
    for word in words:
        if word == "z":
            parts.append("z")
            here = start
            continue
        x, y = (round(float(next(words)) / STEP) for _ in range(2))
        if word == "M":
            start = here = x, y
            parts.append(f"M{_beside(x, y)}")
            continue
        (right, down), here = (x - here[0], y - here[1]), (x, y)
        if down == 0:
            parts.append(f"h{_text(right)}")
        elif right == 0:
            parts.append(f"v{_text(down)}")
        else:
            parts.append(f"l{_beside(right, down)}")
    return "".join(parts)


def _text(steps: int) -> str:
    """Return a number of steps in px: ``.17``, ``-.17``, ``12``."""
    return re.sub(r"^(-?)0(?=\.)", r"\1", f"{steps * STEP:.2f}".rstrip("0").rstrip(".")) or "0"


def _beside(x: int, y: int) -> str:
    first, second = _text(x), _text(y)
    return first + ("" if second.startswith("-") else " ") + second
