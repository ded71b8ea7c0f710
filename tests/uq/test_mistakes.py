"""A mistake on the command line: one line with what can be done, exit code 2, nothing written."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import everything

MISTAKES = {
    "sumary": "uq: No such command 'sumary'. Did you mean 'summary'? See 'uq --help'",
    "run": "uq: Missing argument 'STUDY'; see 'uq run --help'",
    "run a.toml --sampels 3": "uq: No such option: --sampels; did you mean '--samples'?",
    "run a.toml --workers -1": "uq: Invalid value for '--workers': ",
    "run a.toml --samples many": "uq: Invalid value for '--samples': ",
    "run absent.toml": "absent.toml: no such file",
    "run .": ".: is a directory",
    "run broken.toml": "broken.toml: not valid TOML: ",
    "run small.toml --model nowhere:M": "model 'nowhere:M' cannot be imported",
    "run small.toml -o folder": "folder: is a folder; give the name of a file in it",
    "run small.toml -o /proc/x.nc": "/proc/x.nc: cannot write in /proc: ",
    "run small.toml -o broken.toml": "broken.toml: not a readable netCDF file; ",
    "run small.toml --workers 1 --scheduler tcp://x:1": "workers and scheduler exclude each other",
    "simulate ishigamy": "no such model 'ishigamy'; did you mean 'ishigami'?",
    "simulate linear --set x1": "--set x1: write it as NAME=VALUE with a number",
    "simulate linear --set x1=-1e400": (
        "--set x1=-1e400: -1e400 is too large for a number; write it as inf if infinity is meant\n"
    ),
    "simulate beam --setting horizon=1e400": "--setting horizon=1e400: 1e400 is too large",
    "simulate linear --set x1=much": "--set x1=much: write it as NAME=VALUE with a number",
    "simulate linear --set x1=nan": "x1 = nan: ",
    "simulate linear --set x1=inf": "x1 = inf: must lie within 0.0 to 1.0 [1]",
    "simulate sample_models:MOUNTED --set mount_stiffness=1e3": (
        "mount_stiffness = 1000.0: must lie within 10000.0 to inf [N m-1]"
    ),
    "simulate linear --set x5=1": "x5 = 1.0: no such parameter of model 'linear'",
    "simulate linear --setting fail_how": "--setting fail_how: write it as NAME=VALUE",
    "simulate linear --setting fail_how=3": "setting fail_how = 3: must be one of nan, inf",
    "simulate vibrator --setting body_points=[[1.0,0.2,0.3]]": (
        "setting body_points = [[1.0, 0.2, 0.3]]: must be a list, each a list of 2, each a number "
        "within -30.0 to 30.0 [m]\n"
    ),
    "simulate linear --plot f.png": "model 'linear' gives no trajectory",
    "simulate sample_models:KINDS -o folder": "folder: is a folder",
    "simulate sample_models:KINDS --plot /proc/f.png": "/proc/f.png: cannot write in /proc: ",
    "simulate sample_models:KINDS --plot f.xyz": "f.xyz: Format 'xyz' is not supported",
    "models nothing": "no such model 'nothing'",
    "init nothing": "no such model 'nothing'",
    "check absent.toml": "absent.toml: no such file",
    "summary absent.nc": "absent.nc: no such file",
    "summary small.toml": "small.toml: not a readable netCDF file",
    "sensitivity folder": "folder: is a folder, not a result",
    "plot absent.nc": "absent.nc: no such file",
}


NEXT_STEP = re.compile(
    r"[Dd]id you mean|[Ss]ee '|must |allowed: |installed: |choose |give |write it |leave out"
    r"|'uq run STUDY'|'uq init |install it|exclude each other|a study is a TOML file"
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
