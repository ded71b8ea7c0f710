"""Notebooks run from top to bottom at reduced size; committed outputs are of one whole run."""

import shutil
from importlib import import_module
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

import uq

HOUSE = Path(__file__).parents[2]
NOTEBOOKS = sorted((HOUSE / "notebooks").glob("*.ipynb"))
FEWER = "7"
"""A seventh of the rows: fewer have no sensitivities to show."""


def outputs(notebook):
    return [output for cell in notebook.cells for output in cell.get("outputs", ())]


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    # A copy: results of reduced size are not to take the place of those of the reader.
    monkeypatch.setenv("NOTEBOOK_FEWER", FEWER)
    here = shutil.copytree(path.parent, tmp_path / "notebooks")
    shutil.copytree(HOUSE / "studies", tmp_path / "studies")
    (tmp_path / "results").mkdir()
    notebook = nbformat.read(path, as_version=4)
    resources = {"metadata": {"path": here}}
    NotebookClient(notebook, kernel_name="python3", timeout=300, resources=resources).execute()
    assert not [output for output in outputs(notebook) if output.get("name") == "stderr"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_committed_outputs_are_of_one_whole_run(path):
    assert path.stat().st_size < 1_000_000
    notebook = nbformat.read(path, as_version=4)
    counts = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert counts == list(range(1, len(counts) + 1))
    assert any("image/png" in output.get("data", {}) for output in outputs(notebook))
    text = str(outputs(notebook))
    assert str(HOUSE) not in text and str(Path.home()) not in text
    assert not [o for o in outputs(notebook) if "ename" in o or o.get("name") == "stderr"]


def test_the_ball_of_notebook_06_meets_its_formula(monkeypatch):
    monkeypatch.syspath_prepend(HOUSE / "notebooks")
    ball = import_module("bouncing_ball").MODEL
    fall = np.sqrt(2 * 1.5 / 9.81)
    for restitution in (0.3, 0.8):
        inputs = {"height": 1.5, "restitution": restitution}
        motion = uq.simulate(ball, inputs, {"smallest_rise": 1e-15})
        exact = fall * (1 + restitution) / (1 - restitution)
        assert motion["time_to_rest"].item() == pytest.approx(exact, rel=1e-7)
        assert float(motion["time"][-1]) == pytest.approx(exact, rel=1e-7)
    never = uq.simulate(ball, {"restitution": 1.0})
    assert np.isposinf(never["time_to_rest"].item())
    late = uq.simulate(ball, {"restitution": 0.999}, {"most_bounces": 5}).isel(row=0)
    assert uq.labels(late["status"]).item() == "out-of-budget"
    assert late["time_to_rest_censored"].item() == 1
