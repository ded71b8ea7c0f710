"""The answer that the README quotes: ``python docs/first_answer.py`` writes it anew."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

HOUSE = Path(__file__).parents[1]
README = HOUSE / "README.md"
STUDY = "studies/exponential-wear.toml"
BEGIN, END = "<!-- answer -->\n\n```text\n", "```\n\n<!-- end of answer -->"


def printed() -> str:
    """Run the study, and return the card with which ``uq run`` ends."""
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "uq", "run", HOUSE / STUDY]
        text = subprocess.run(
            [*command, "--workers", "0"],
            cwd=folder,
            env={**os.environ, "NO_COLOR": "1"},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
    lines = text.partition("\n\n")[2].splitlines()
    return "".join(f"{line.rstrip()}\n" for line in lines)


def quoted() -> str:
    """Return what the README quotes."""
    return README.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]


if __name__ == "__main__":
    text = README.read_text(encoding="utf-8")
    README.write_text(text.replace(BEGIN + quoted() + END, BEGIN + printed() + END), "utf-8")
