"""Write the page on performance and its lines in the README: ``python -m benchmarks.table``."""

import re
from collections.abc import Sequence
from pathlib import Path

from benchmarks.figures import Figure, Kept, kept

HOUSE = Path(__file__).parents[1]
PAGE, README = HOUSE / "docs" / "performance.md", HOUSE / "README.md"
BEGIN, END = "<!-- performance -->", "<!-- end of performance -->"

IN_README = {"beam_study": "exact", "vibrator": "heyoka", "mole": "heyoka"}
"""Benchmark -> a word in the name of the peer: the README shows the first such figure of each."""

_HEAD = ["| | compared with | ratio |", "| --- | --- | ---: |"]
_INTRODUCTION = """# Performance

How fast this project computes, compared with a peer: at the same error, on the same computer, by
turns. Ratios depend less on the computer than times do. `make bench` measures all of them and
writes this page; the command of a section prints more.
"""


def row(figure: Figure) -> str:
    """Return the row of a figure."""
    words = "times as long" if figure.longer else "times as fast"
    ratio = f"{figure.ratio:.0f}" if figure.ratio >= 100 else f"{figure.ratio:.3g}"
    return f"| {figure.what} | {figure.peer} | {ratio} {words} |"


def page(records: Sequence[Kept]) -> str:
    """Return the page."""
    lines = [_INTRODUCTION]
    for record in records:
        lines += [f"## `python -m benchmarks.{record.benchmark}`", "", f"On {record.machine}:", ""]
        lines += [*_HEAD, *map(row, record.figures), ""]
    return "\n".join(lines)


def marked(readme: str, records: Sequence[Kept]) -> str:
    """Return the README with the figures that it shows, between its marks."""
    shown = [
        next(
            (figure for figure in record.figures if IN_README[record.benchmark] in figure.peer),
            None,
        )
        for record in records
        if record.benchmark in IN_README
    ]
    block = "\n".join([BEGIN, "", *_HEAD, *(row(figure) for figure in shown if figure), "", END])
    return re.sub(f"{BEGIN}.*{END}", lambda _: block, readme, flags=re.DOTALL)


def main() -> None:
    records = kept()
    PAGE.write_text(page(records))
    README.write_text(marked(README.read_text(), records))
    print(f"written: {PAGE.relative_to(HOUSE)}, {README.relative_to(HOUSE)}")


if __name__ == "__main__":
    main()
