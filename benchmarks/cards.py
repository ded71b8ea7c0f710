"""Cards of the shipped studies: run them, and write ``docs/cards.md``.

    python -m benchmarks.cards [RESULT.nc ...]

Without results, every shipped study is run, which takes about half an hour on two cores. With
results, only their cards are replaced.
"""

import re
import sys
from pathlib import Path

import uq
from uq.render.card import card

HOUSE = Path(__file__).parents[1]
PAGE = HOUSE / "docs" / "cards.md"

INTRODUCTION = """\
# Cards of the shipped studies

What `uq run` and `uq summary` print for each study in `studies/`: the number that answers its
question, the main causes of its scatter, how far the sample suffices, and the next step.
"""


def cards_on_page() -> dict[str, str]:
    """Return study -> card, as the page shows them."""
    text = PAGE.read_text("utf-8") if PAGE.exists() else ""
    return dict(re.findall(r"^## (\S+)\n\n```text\n(.*?)\n```$", text, re.MULTILINE | re.DOTALL))


def write(cards: dict[str, str]) -> None:
    """Write the page."""
    blocks = (f"\n## {name}\n\n```text\n{cards[name]}\n```\n" for name in sorted(cards))
    PAGE.write_text(INTRODUCTION + "".join(blocks), "utf-8")


def main() -> None:
    """Run the shipped studies, or read the given results, and write their cards."""
    paths = sys.argv[1:]
    cards = cards_on_page() if paths else {}
    for path in paths or sorted((HOUSE / "studies").glob("*.toml")):
        result = path if paths else uq.run(path)
        shown = card(result)
        cards[shown.card.name] = str(shown)
        print(shown.card.name, flush=True)
    write(cards)


if __name__ == "__main__":
    main()
