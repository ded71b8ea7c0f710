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


READERS = (
    *("summary", "sensitivity", "report", "plot", "convergence", "levels", "status", "verify"),
    *("row", "trace KEY", "export --csv a.csv", "extend --samples 9", "rerun --failed"),
    *("fleet --size 3", "twin", "what-if --set a.b=1", "next-inspection --inspect x"),
)


@pytest.mark.parametrize("verb", READERS)
@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("small.toml", "is a study, not a result; 'uq run small.toml' computes its result"),
        ("own.toml", "is a machine, not a result; 'uq init own.toml > study.toml' writes a study"),
        ("own.py", "is a machine, not a result; 'uq init own.py > study.toml' writes a study"),
        ("lives.csv", "is a table, not a result; 'uq import lives.csv -o OUT.nc --life COLUMN'"),
        ("page.html", "is a page, not a result; 'uq report RESULT.nc'"),
    ],
)
def test_a_file_that_is_no_result_is_named_with_what_reads_it(
    uq, write_study, folder, verb, file, words
):
    write_study()
    (folder / "own.toml").write_text('[machine]\nname = "own"\n')
    (folder / "own.py").write_text("import uq\n")
    (folder / "lives.csv").write_text("hours\n3\n")
    (folder / "page.html").write_text("<html>")
    name, *options = verb.split()
    ended = uq(name, file, *options)
    assert (ended.code, ended.out) == (2, "") and ended.err.startswith(f"{file}: {words}")
    assert ended.err.count("\n") == 1


def test_a_table_is_no_study(uq, folder):
    (folder / "lives.csv").write_text("hours\n3\n")
    ended = uq("run", "lives.csv")
    assert ended.code == 2 and ended.err.startswith("lives.csv: is a table, not a study; 'uq imp")


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
