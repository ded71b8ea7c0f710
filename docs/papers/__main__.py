"""Draw the papers' figures from our data: ``python docs/papers`` writes them, and their page.

Names of machines follow, if only some are to be drawn anew: ``python docs/papers beam``.
"""

import re
import sys
from collections.abc import Sequence

import beam
import mole
import vibrator
from shown import DOCS, FOLDER, Shown

from uq.drawing.figure import write

MACHINES = {"beam": beam, "vibrator": vibrator, "mole": mole}
PAGE = DOCS / "papers.md"
INTRODUCTION = """\
# The papers' figures

Written by `make figures`, numbers included: each figure of the three papers drawn from our data,
with what the paper shows and how far ours agrees, also where it does not.
"""


def section(one: Shown) -> str:
    """Write one figure's section of the page, and the figure's file."""
    drawn = one.drawn
    if not isinstance(drawn, str):
        for path in write(drawn, DOCS / FOLDER / one.name):
            if path.suffix != ".svg":
                path.unlink()
        drawn = f"![{one.title}]({FOLDER}/{one.name}.svg)"
    return f"### {one.title}\n\n{drawn}\n\n{one.parameters}\n\n{one.comparison}\n"


def part(name: str) -> str:
    """Draw everything of one machine and return its part of the page."""
    sections = [f"## {name.capitalize()}\n\n{MACHINES[name].NOTE}\n"]
    for one in MACHINES[name].shown():
        sections.append(section(one))
        print(f"{one.name}: {one.comparison}", flush=True)
    return "\n".join(sections)


def main(chosen: Sequence[str]) -> None:
    """Draw some machines anew, and write the page with what it had of the others."""
    old = re.split(r"^(?=## )", PAGE.read_text(), flags=re.MULTILINE) if PAGE.exists() else []
    parts = {text.split()[1].lower(): text.strip() + "\n" for text in old[1:]}
    for name in chosen:
        parts[name] = part(name)
        PAGE.write_text("\n".join([INTRODUCTION, *(parts.get(one, "") for one in MACHINES)]))


if __name__ == "__main__":
    main(sys.argv[1:] or list(MACHINES))
