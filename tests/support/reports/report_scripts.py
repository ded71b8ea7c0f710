"""The scripts of a page, to be asked one by one."""

import re
from pathlib import Path

import uq.render.html

_FOLDER = Path(uq.render.html.__file__).parent


def scripts():
    """Return all scripts of a page but the one that starts it."""
    listed = re.search(r"for name in \[(.*?)\]", (_FOLDER / "explorer.html").read_text(), re.S)[1]
    names = re.findall(r'"(\w+)"', listed)
    assert names.pop() == "start"
    return "\n".join((_FOLDER / "live" / f"{name}.js").read_text() for name in names)
