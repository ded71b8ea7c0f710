"""Run notebooks at full size and keep what they show: ``python notebooks/execute.py [01 ...]``.

Without numbers, all of them. With the environment variable ``NOTEBOOK_FEWER=7`` every notebook
computes a seventh of its rows; the tests do so.
"""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).parent


def execute(path: Path) -> None:
    """Run a notebook from top to bottom, and write its outputs into it."""
    notebook = nbformat.read(path, as_version=4)
    about = dict(notebook.metadata)
    NotebookClient(
        notebook,
        kernel_name="python3",
        timeout=600,
        record_timing=False,
        resources={"metadata": {"path": HERE}},
    ).execute()
    notebook.metadata = nbformat.from_dict(about)  # a kernel's version is that of this machine
    nbformat.write(notebook, path)


if __name__ == "__main__":
    for number in sys.argv[1:] or [""]:
        for found in sorted(HERE.glob(f"{number}*.ipynb")):
            print(found.name, flush=True)
            execute(found)
