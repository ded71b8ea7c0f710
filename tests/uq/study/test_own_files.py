"""Messages and advised commands name the file that has a model of one's own."""

import os
from pathlib import Path

import pytest
from own_study import own_study

from uq.result.result_file import model_option, open_result
from uq.study.model_files import file_with

PAD = """
import uq

@uq.machine(returns={"y": "1"})
def pad(load: float = 1.0):
    if load > 0.5:
        raise ValueError("too heavy")
    return {"y": load}
"""
OTHER = """
@uq.machine
def other(load: float = 1.0):
    return {"y": load}
"""
MODEL = 'DECLARED = Model("pad", "1", "a pad")\n'
PROGRAM = '[machine]\nname = "pad"\ncommand = ["true"]\n'


@pytest.mark.parametrize(
    ("file", "text", "reference"),
    [
        ("pad.py", PAD, "pad.py"),
        ("wear.py", PAD, "wear.py"),
        ("wear.py", PAD + OTHER, "wear.py:pad"),
        ("wear.py", MODEL, "wear.py"),
        ("my pads.toml", PROGRAM, "'my pads.toml'"),
        ("pad.py", "def pad(load): ...", ""),
        ("pad.py", f"{PAD}\n(", ""),
        ("pad.toml", '[study]\nmodel = "pad"', ""),
        ("pad.txt", PAD, ""),
    ],
)
def test_the_file_with_a_model_is_found_by_its_text(folder, file, text, reference):
    Path(file).write_text(text)
    assert file_with("pad", [Path()]) == reference


@pytest.mark.parametrize("given", ["my pad.py", "my pad.py:pad"])
def test_a_machine_in_place_of_its_study_says_what_to_do(uq, folder, given):
    Path("my pad.py").write_text(PAD)
    for verb in ("run", "check"):
        ended = uq(verb, given)
        assert (ended.code, ended.out) == (2, "")
        assert ended.err == (
            f"{given}: is a machine, not a study; 'uq init '{given}' > study.toml' writes a study"
            f" of it, and 'uq run study.toml --model '{given}'' runs it\n"
        )


def test_no_file_is_run_or_waited_for(folder):
    os.mkfifo("a.py")
    Path("pad.py").write_text(f"open('run', 'w')\n{PAD}")
    assert file_with("pad", [Path("nowhere"), Path()]) == "pad.py"
    assert not Path("run").exists()


@pytest.fixture
def file(write_function):
    """Write a machine into the current folder, and studies/own.toml; return the machine's name."""
    name = write_function(PAD, own_study("pad", "load"))
    Path("studies").mkdir()
    Path("own.toml").rename(STUDY)
    return name


STUDY = "studies/own.toml"


def test_a_study_without_its_model_names_the_file(uq, file):
    for verb in ("check", "plan", "run"):
        code, out, err = uq(verb, STUDY)
        assert (code, out) == (2, "")
        assert f"model 'pad' is not installed, but {file} defines it" in err
        assert f"add --model {file}" in err
    Path(file).rename(f"studies/{file}")
    assert f"--model studies/{file}" in uq("check", STUDY).err
    Path(f"studies/{file}").unlink()
    assert "no such model 'pad'" in uq("check", STUDY).err


def test_the_first_guide_names_the_file(uq, file):
    assert f"uq run {STUDY} --model {file}\n" in uq().out


def test_advised_commands_name_the_file(uq, file):
    again = "uq rerun results/own.nc --failed --model"
    assert f"{again} {file}" in one_line(uq("run", STUDY, "--model", file, "--workers", 0))
    assert f"{again} {file}" in one_line(uq("summary", "results/own.nc"))
    assert f"--model {file}" in uq("rerun", "results/own.nc", "--failed").err
    Path(file).rename(f"results/{file}")
    assert f"{again} results/{file}" in one_line(uq("summary", "results/own.nc"))
    Path(f"results/{file}").unlink()
    assert model_option(open_result("results/own.nc")) == " --model FILE"


def test_a_model_is_named_as_the_user_did(uq, file):
    done = uq("run", STUDY, "--model", f"{Path().absolute()}/{file}:pad", "--workers", 0)
    assert f"--failed --model {file}:pad" in one_line(done)


def one_line(ended):
    return " ".join(ended.out.split())
