"""The page of the papers' figures: what it shows is there."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
PAPERS = {
    "Beam": ["Figure 2", "Figure 3", "Figure 4", "Figure 5", "Figure 6", "Journal paper"],
    "Vibrator": ["Table 1", "Figure 5", "Figure 6", "Figure 7", "Figure 8"],
    "Mole": [f"Figure {number}" for number in range(3, 12)],
}


def test_the_page_shows_every_figure_of_the_papers_and_no_file_is_left_over():
    page = (DOCS / "papers.md").read_text()
    parts = re.split(r"^## (.+)$", page, flags=re.MULTILINE)[1:]
    assert parts[::2] == list(PAPERS)
    for machine, text in zip(parts[::2], parts[1::2], strict=True):
        titles = re.findall(r"^### (.+?):", text, flags=re.MULTILINE)
        assert titles == PAPERS[machine]
    named = re.findall(r"\]\((papers/[^)]+)\)", page)
    assert sorted(named) == sorted(
        f"papers/{path.name}" for path in (DOCS / "papers").glob("*.svg")
    )
    assert sum(path.stat().st_size for path in (DOCS / "papers").glob("*.svg")) < 5e6
