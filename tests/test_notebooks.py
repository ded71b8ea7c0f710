"""Every notebook runs from top to bottom."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path):
    notebook = nbformat.read(path, as_version=4)
    notebook.metadata.pop("kernelspec", None)
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": path.parent}}).execute()
    errors = [o for cell in notebook.cells for o in cell.get("outputs", ()) if "ename" in o]
    assert not errors
    assert sum(len(cell.get("outputs", ())) for cell in notebook.cells) >= 4
