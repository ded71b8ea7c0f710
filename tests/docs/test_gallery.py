"""The gallery shows every kind of figure, and its lines draw what it shows."""

import os
import re
from inspect import isfunction
from pathlib import Path

import gallery
import pytest
from matplotlib.figure import Figure

import uq
from uq import plots

HOUSE = Path(__file__).parents[2]

EXAMPLES = {example.name: example for example in gallery.EXAMPLES}
FEWER = {
    "beam-depths": 8,
    "beam-lifetime": 600,
    "beam-sensitivity": 16,
    "vibrator-run-up": 8,
    "vibrator-tolerances": 200,
}
"""Study -> rows (or rows of a replicate) that draw its figures in a test."""


def test_the_gallery_holds_every_kind_of_figure_and_no_file_is_left_over():
    functions = {
        name
        for name, member in vars(plots).items()
        if isfunction(member) and member.__module__.endswith(("_plot", "_plots"))
    }
    drawn = {re.findall(r"uq\.plots\.(\w+)\(", example.code)[-1] for example in EXAMPLES.values()}
    assert drawn == functions
    assert set(plots.FIGURES) <= EXAMPLES.keys()
    assert {path.stem for path in gallery.FOLDER.glob("*.svg")} == EXAMPLES.keys()


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_lines_of_an_example_draw(name, tmp_path_factory, monkeypatch):
    example = EXAMPLES[name]
    folder = tmp_path_factory.getbasetemp() / "gallery"
    folder.mkdir(exist_ok=True)
    monkeypatch.chdir(folder)
    if example.study and not os.path.exists(f"results/{example.study}.nc"):
        study = uq.load_study(HOUSE / f"studies/{example.study}.toml")
        uq.run(study.with_samples(FEWER[example.study]))
    assert isinstance(gallery.drawn(example), Figure)
