"""The generated parts of the pages.

A line ``{{ table argument }}`` in a page becomes what the function of that name in `generated`
returns, ``{{ gallery }}`` the gallery, and ``{{ text README }}`` a text of the repository's root:
nothing is typed twice.
"""

import re
from collections.abc import Callable
from pathlib import Path

import gallery
import generated

ROOT = Path(__file__).parents[1]
TEXTS = {"README": "index", "CONTRIBUTING": "contributing", "CHANGELOG": "changelog"}
"""Texts of the repository's root -> the pages that they become."""

_DIRECTIVE = re.compile(r"^\{\{ ([a-z_]+)(?: ([\w-]+))? \}\}$", re.MULTILINE)


def text(name: str) -> str:
    """Return a text of the repository's root, its links as they are within the documentation."""
    found = (ROOT / f"{name}.md").read_text(encoding="utf-8")
    for file, page in TEXTS.items():
        found = found.replace(f"]({file}.md", f"]({page}.md")
    return found.replace("](docs/", "](")


_OTHERS: dict[str, Callable[..., str]] = {"text": text, "gallery": gallery.page}


def expanded(page: str) -> str:
    """Replace the directives of a page by what they stand for.

    Parameters
    ----------
    page : str
        Markdown.

    Returns
    -------
    str

    Raises
    ------
    AttributeError
        When there is no such table.
    """

    def replacement(found: re.Match[str]) -> str:
        name, argument = found.groups()
        function = _OTHERS.get(name) or getattr(generated, name)
        return str(function(argument) if argument else function())

    return _DIRECTIVE.sub(replacement, page).replace("](../../notebooks/", "](../notebooks/")
