"""A program as a machine: what a study makes of it, and what is wrong with its file."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from own_machines import PAD, PAD_PROGRAM, run_program

from uq.contract import Status
from uq.machines.machine_file import OutputTable
from uq.machines.program_outputs import value_in
from uq.machines.returned import RowError


def test_rows_are_those_of_the_program(uq, write_program, folder):
    write_program()
    _, ds = run_program(uq)
    load = ds["load"].values
    is_ok = load <= 1.5
    assert (ds["status"].values == np.where(is_ok, Status.OK, Status.RAISED)).all()
    expected = np.where(load < 0.2, np.inf, 3.0 / load)
    assert (ds["life"].values[is_ok] == expected[is_ok]).all()
    assert (ds["pair"].values[is_ok] == np.stack([load, 2 * load], axis=1)[is_ok]).all()
    assert (ds["last"].values[is_ok] == (load**2)[is_ok]).all()
    assert not is_ok.all() and not (folder / "pad.rows" / "running").exists()


def test_a_failed_row_keeps_its_folder_and_says_where(uq, write_program, folder):
    write_program()
    _, ds = run_program(uq)
    sentence = ds["status"].attrs["example_raised"]
    assert "ended with exit code 3: the pad is too heavy (heavier than 1.5); see " in sentence
    kept = sorted(path.name for path in (folder / "pad.rows").iterdir())
    assert len(kept) == (ds["status"].values == Status.RAISED).sum()
    failed = Path(sentence.rpartition("; see ")[2])
    assert {path.name for path in failed.iterdir()} == {"input.txt", "stdout.txt", "stderr.txt"}
    lines = (failed / "input.txt").read_text().splitlines()
    assert float(lines[0].removeprefix("load=")) in ds["load"].values
    assert lines[1].removeprefix("seed=").isdigit() and lines[2] == "other={braces}"


def test_without_failures_nothing_is_left(uq, write_program, folder):
    write_program(PAD_PROGRAM.replace("1.5", "2.9"))
    before = sorted(path.name for path in folder.iterdir())
    run_program(uq)
    assert sorted(path.name for path in folder.iterdir()) == sorted([*before, "own.nc"])


def test_other_code_of_the_program_is_noticed(uq, write_program):
    write_program()
    run_program(uq)
    write_program(PAD_PROGRAM.replace("life =", "life  ="))
    assert "other code" in run_program(uq)[0].err


@pytest.mark.parametrize("argument", ["{machine_folder}/solver", "--deck={machine_folder}/solver"])
def test_other_code_of_a_file_among_the_arguments_is_noticed(uq, write_program, folder, argument):
    write_program(text=PAD.replace('"{depth}"', f'"{{depth}}", "{argument}"'))
    (folder / "solver").write_text("1")
    run_program(uq)
    (folder / "solver").write_text("2")
    assert "other code" in run_program(uq)[0].err


def test_a_template_keeps_its_line_ends(uq, write_program, folder):
    write_program(PAD_PROGRAM.replace("awk", "grep -q 'load=.*\r' input.txt || exit 5\nawk"))
    (folder / "deck").write_bytes(b"load={load}\r\n")
    _, ds = run_program(uq, "--samples", "4")
    assert "exit code 5" not in str(ds["status"].attrs)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["machine.toml", "deck"])
def test_a_byte_order_mark_changes_neither_rows_nor_what_they_are_of(
    uq, write_program, folder, name
):
    write_program()
    _, before = run_program(uq)
    path = folder / name
    text = path.read_bytes()
    windows = text if name == "deck" else text.replace(b"\n", b"\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + windows)
    ended, kept = run_program(uq)
    assert "other code" not in ended.err
    _, after = run_program(uq, "--fresh")
    assert before.identical(kept) and before.identical(after)


def test_a_template_that_is_no_text_is_one_line(uq, write_program, folder):
    write_program()
    (folder / "deck").write_bytes(b"load={load}\xff\xfe")
    ended = uq("check", "own.toml", "--model", "machine.toml")
    assert ended.code == 2 and "is not a text in UTF-8" in ended.err and ended.err.count("\n") == 1


MISTAKES = {
    ('name = "pad"', "nam = 'pad'"): "[machine] nam = \"pad\": no such key; did you mean 'name'?",
    ("nominal = 3.0", "nominal = 'x'"): '[parameters] depth.nominal = "x": must be a number',
    ('template = "deck"', ""): "has no place {load} in command",
    ('"deck"', '"dek"'): '[machine] template = "dek": no such file',
    ('json = "pairs.0"', ""): "give one of json, csv, netcdf and pattern",
    ("(\\S+)", "\\S+"): "pattern must have one group in parentheses, not 0",
    ("nominal = 1.0", "nominal = 11.0"): "must be within the bounds",
    ("[machine]", "[machine"): "not valid TOML",
    ("{depth}", "{depth:d}"): "Unknown format code 'd'",
    ('"{depth}"', '"deck", "{depth}"'): "write {machine_folder}/deck",
    ('template = "deck"', 'template = "deck"\ninput = "../in"'): "in the folder of the row",
    ('"out.json"', '"../out.json"'): "in the folder of the row",
    ('"out.json"', '"/tmp/out.json"'): "in the folder of the row",
    ("shape = [2]", "shape = [-2]"): "shape[0] = -2: must be at least 1",
    ("[outputs.pair]", "[outputs.load]"): "'load' is the name of a parameter",
    ("exit_codes", "environment = {'A=B' = ''}\nexit_codes"): "must be a name without '='",
}


@pytest.mark.parametrize("change", MISTAKES)
def test_a_mistake_in_a_machine_file_is_one_line(uq, write_program, change):
    write_program(text=PAD.replace(*change))
    ended = uq("check", "own.toml", "--model", "machine.toml")
    assert (ended.code, ended.out) == (2, "")
    assert MISTAKES[change] in ended.err
    assert all("machine" in line for line in ended.err.splitlines())


def test_a_machine_file_proposes_laws_and_outputs_to_a_new_study(uq, write_program):
    proposal = '[uncertain.load]\ndistribution = "uniform"\nlower = 0.5\nupper = 1.0\n'
    headline = 'headline = ["life"]\nrow_name = ["pad", "pads"]\n'
    write_program(text=PAD.replace("[machine]\n", f"[machine]\n{headline}") + proposal)
    study = tomllib.loads(uq("init", "machine.toml").out)
    assert study["uncertain"]["load"] | {"source": ""} == {
        "distribution": "uniform",
        "lower": 0.5,
        "upper": 1.0,
        "source": "",
    }
    assert study["analysis"]["outputs"] == ["life"]


def test_a_parameter_that_is_a_word_of_python_is_one_line(uq, write_program):
    write_program(text=PAD.replace("depth", "lambda"))
    message = uq("check", "own.toml", "--model", "machine.toml").err
    assert (
        "parameter 'lambda' cannot have this name in Python" in message and message.count("\n") == 1
    )


def test_numbers_of_fortran_are_read(uq, write_program):
    write_program(PAD_PROGRAM.replace('life = inf"', 'life = 1.5D+03"'))
    _, ds = run_program(uq)
    assert (ds["life"].values[ds["load"].values < 0.2] == 1500.0).all()


WRITTEN = {
    "o.json": (
        ({"json": "y"}, '\ufeff{"y": 1.5}', 1.5),
        ({"json": "y"}, '{"y": "1_000"}', "no number: '1_000'"),
        ({"json": "y"}, '{"y": null}', "no number: null"),
        ({"json": "y"}, '{"y": 1e400}', "1e400 is too large for a number"),
        ({"json": "y"}, f'{{"y": {10**400}}}', "int too large to convert to float"),
    ),
    "o.csv": (
        ({"csv": "a"}, "\ufeffa,b\r\n1,2\r\n3,4\r\n", 3.0),
        ({"csv": "b"}, "a,b\n1,2\n3\n", "no number: ''"),
        ({"csv": "b"}, "a;b\n1;2\n", "no column 'b'"),
    ),
    "o.txt": (
        ({"pattern": "y = (.*)"}, "\ufeffy = 2.5\r\n", 2.5),
        ({"pattern": "y = (.*)"}, "y = 1_000\n", "no number: '1_000'"),
        ({"pattern": "y = (.*)"}, "y = 1e400\n", "1e400 is too large for a number"),
    ),
}


@pytest.mark.parametrize(
    ("file", "how", "text", "expected"),
    [(file, *case) for file, cases in WRITTEN.items() for case in cases],
)
def test_a_number_is_read_as_it_is_written_or_refused(folder, file, how, text, expected):
    (folder / file).write_bytes(text.encode())
    output = OutputTable(file=file, **how)
    if isinstance(expected, float):
        assert value_in(folder, "y", output) == expected
    else:
        with pytest.raises(RowError) as caught:
            value_in(folder, "y", output)
        assert f"has no 'y' in '{file}': {expected}" in str(caught.value)


def test_a_study_in_its_place_is_one_line(uq, write_program):
    write_program()
    assert "is a study, not a machine file" in uq("check", "own.toml", "--model", "own.toml").err


def test_a_machine_file_in_the_place_of_a_study_is_one_line(uq, write_program):
    write_program()
    message = uq("run", "machine.toml").err
    assert message.count("\n") == 1
    assert "is a machine, not a study; 'uq init machine.toml > study.toml' writes" in message


def test_a_program_that_is_killed_is_tried_again_and_named_as_any_other_failure(
    uq, write_program, folder
):
    write_program('#!/bin/sh\necho >> "$0.tries"\nkill -9 $$\n')
    ended = uq("simulate", "machine.toml")
    assert "ProgramError: was ended by signal 9 (Killed)" in ended.err + ended.out
    assert len((folder / "program.tries").read_text().splitlines()) == 3
