"""The blocks of the README and the guide, run in order as a reader would.

The blocks of a page run in a folder of their own that contains the shipped studies:

- a block that begins with a comment of a file's name, ``# pad.py``, or follows a sentence that
  ends with its name and a colon, is written to that file;
- in a shell block, every line that begins with ``uq`` runs; other lines install or start something;
- Python blocks run, in one session;
- a block that begins with a comment ``# needs ...`` is not run: it says what it needs.

A block below the mark ``<!-- printed -->`` quotes what the command before it prints, below
``<!-- printed, last paragraph -->`` the last paragraph of that. ``python docs/quoted.py`` writes
the quotes of all pages anew.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

HOUSE = Path(__file__).parents[1]
PAGES = ("README.md", *(f"docs/guide/{page.name}" for page in sorted(HOUSE.glob("docs/guide/*"))))

NEEDS = "# needs "
_BLOCK = re.compile(
    r"(?P<before>[^\n]*)\n\n```(?P<language>\w+)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE
)
_FILE = re.compile(r"# ([\w-]+\.\w+)\n")
_NAMED = re.compile(r"`([\w-]+\.\w+)`:$")
_PRINTED = re.compile(r"<!-- printed(, last paragraph)? -->$")

Call = Callable[[list[str]], str]
"""Runs ``uq ARGUMENTS``, and returns what it prints."""


class Block(NamedTuple):
    """A fenced block of a page.

    Attributes
    ----------
    language : str
    text : str
    start : int
        Place of the text in the page.
    file : str
        Name of the file that it is, or "".
    quotes : str
        The mark above it, if it quotes what a command prints, or "".
    """

    language: str
    text: str
    start: int
    file: str = ""
    quotes: str = ""


def blocks(page: str) -> Iterator[Block]:
    """Yield the blocks of a page in order."""
    for match in _BLOCK.finditer(page):
        text, before = match["text"], match["before"]
        named = _FILE.match(text) or _NAMED.search(before)
        quotes = _PRINTED.search(before)
        yield Block(
            match["language"],
            text,
            match.start("text"),
            named[1] if named else "",
            quotes[0] if quotes else "",
        )


def commands(block: Block) -> Iterator[list[str]]:
    """Yield the words of each ``uq`` command of a shell block, a redirection included."""
    for line in block.text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if words[:1] == ["uq"]:
            yield words[1:]


def run(page: str, call: Call) -> Iterator[tuple[Block, str]]:
    """Run the blocks of a page in the current folder, and yield each quote with what is printed."""
    printed, names = "", {"__name__": "shown"}
    for block in blocks(page):
        if block.quotes:
            yield block, _last(printed) if "last" in block.quotes else printed
        elif block.file:
            Path(block.file).write_text(block.text, encoding="utf-8")
        elif block.text.startswith(NEEDS):
            continue
        elif block.language == "python":
            exec(compile(block.text, "shown", "exec"), names)
        elif block.language == "sh":
            for words in commands(block):
                printed = _carried_out(words, call)


def _carried_out(words: list[str], call: Call) -> str:
    """Run a command, its output into a file if it says so, and return what it prints."""
    if ">" not in words:
        return call(words)
    cut = words.index(">")
    text = call(words[:cut])
    Path(words[cut + 1]).write_text(text, encoding="utf-8")
    return ""


def _last(printed: str) -> str:
    """Return the last paragraph of a text."""
    return printed.rstrip().rpartition("\n\n")[2] + "\n"


def quotes(name: str) -> list[tuple[Block, str]]:
    """Return the quotes of a page, each with what its command prints now."""
    page = (HOUSE / name).read_text(encoding="utf-8")
    if not any(block.quotes for block in blocks(page)):
        return []
    here = Path.cwd()
    with TemporaryDirectory() as folder:
        shutil.copytree(HOUSE / "studies", Path(folder, "studies"))
        os.chdir(folder)
        try:
            return [(block, _tidy(printed)) for block, printed in run(page, _printed)]
        finally:
            os.chdir(here)


def _printed(arguments: list[str]) -> str:
    """Run ``uq ARGUMENTS`` in a process of its own, 80 columns wide."""
    return subprocess.run(
        [sys.executable, "-m", "uq", *arguments],
        env={**os.environ, "COLUMNS": "80", "NO_COLOR": "1", "BROWSER": "true"},
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def _tidy(printed: str) -> str:
    return "".join(f"{line.rstrip()}\n" for line in printed.rstrip().splitlines())


def main() -> None:
    """Write the quotes of all pages anew."""
    for name in PAGES:
        path = HOUSE / name
        page = path.read_text(encoding="utf-8")
        for block, printed in reversed(quotes(name)):
            page = page[: block.start] + printed + page[block.start + len(block.text) :]
        path.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
