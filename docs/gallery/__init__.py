"""Every kind of figure, with the lines that draw it: ``python -m gallery``, in docs."""

import re
from collections.abc import Iterator
from pathlib import Path

from .examples import EXAMPLES, Example

FOLDER = Path(__file__).parent


def page() -> str:
    """Return the gallery in Markdown, in the order and under the headings of its examples."""
    return "\n\n".join(_parts())


def _parts() -> Iterator[str]:
    pictures = "\n".join(
        f"[![{one.title}](gallery/{one.name}.svg)](#{_anchor(one.title)})" for one in EXAMPLES
    )
    yield f"```{{container}} thumbnails\n{pictures}\n```"
    heading = ""
    for one in EXAMPLES:
        if one.heading != heading:
            heading = one.heading
            yield f"## {heading}"
        yield f"### {one.title}\n\n{one.says}"
        yield f"![{one.title}](gallery/{one.name}.svg)"
        if one.command:
            yield f"```sh\n{one.command}\n```"
        yield f"```python\n{one.code}\n```"


def _anchor(title: str) -> str:
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def drawn(one: Example) -> object:
    """Run the lines of an example, the last of which is an expression, and return its figure."""
    *first, last = one.code.splitlines()
    names: dict[str, object] = {}
    exec("\n".join(first), names)
    return eval(last, names)
