"""A mistake on the command line: one line with what can be done, exit code 2, nothing written."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import everything
from wordings import MISTAKES

NEXT_STEP = re.compile(
    r"[Dd]id you mean|[Ss]ee '|must |allowed: |installed: |choose |give |write it |leave out"
    r"|'uq run |'uq init |install it|exclude each other|a study is a TOML file"
    r"|supported formats|at line \d+, column"
)
"""What a line says that can be done, or what would be right."""


@pytest.mark.parametrize("line", MISTAKES)
def test_a_mistake_is_one_line_and_leaves_nothing_behind(uq, write_study, folder, line):
    write_study()
    (folder / "folder").mkdir()
    (folder / "broken.toml").write_text("[study\n")
    ended = uq(*line.split())
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith(MISTAKES[line])
    assert ended.err.count("\n") == 1 and NEXT_STEP.search(ended.err)
    assert everything(folder) == ["broken.toml", "folder", "small.toml"]


def test_a_wrong_model_of_ones_own_is_one_line(uq, write_study, folder):
    path = write_study(model="x", uncertain=("x1",))
    ended = uq("run", path, "--model", "wrong_models:WRONG_DTYPE")
    assert ended.code == 2
    assert ended.err == "model 'wrong-dtype': 'y' is float32, expected float64\n"
    assert everything(folder) == ["small.toml"]


@pytest.mark.parametrize("verb", [("schema",), ("models", "linear"), ("init", "linear")])
def test_a_reader_that_has_enough_is_no_error(verb):
    command = Path(sys.executable).with_name("uq")
    nobody, pipe = os.pipe()
    os.close(nobody)
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    ended = subprocess.run(
        [command, *verb],
        stdout=pipe,
        stderr=subprocess.PIPE,
        text=True,
        env=buffered,
        timeout=60,
    )
    os.close(pipe)
    assert (ended.returncode, ended.stderr) == (1, "")
