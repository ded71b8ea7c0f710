"""A program as a machine: what a study makes of it, what goes wrong, what it leaves behind."""

import os
import resource
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil
import pytest

import uq as package
from uq.contract import Status
from uq.outside import descendants, program
from uq.outside.folders import Folders
from uq.study.registry import find_model

STUDY = """
[study]
name = "own"
model = "pad"
[design]
method = "monte-carlo"
samples = 20
seed = 1
[uncertain.load]
distribution = "uniform"
lower = 0.0
upper = 2.0
source = "assumed"
"""

MACHINE = """
[machine]
name = "pad"
command = ["./program", "{depth}"]
template = "deck"
exit_codes = {3 = "the pad is too heavy"}
[parameters.load]
nominal = 1.0
unit = "N"
bounds = [0.0, 10.0]
[parameters.depth]
nominal = 3.0
[outputs.life]
unit = "s"
life = true
pattern = 'life = (\\S+)'
[outputs.pair]
shape = [2]
file = "out.json"
json = "pairs.0"
[outputs.last]
file = "out.csv"
csv = "b"
"""

PROGRAM = """#!/bin/sh
awk -v d=$1 -F= '$1 == "load" {
    if ($2 > 1.5) { print "heavier than 1.5" > "/dev/stderr"; exit 3 }
    if ($2 < 0.2) print "life = inf"; else printf "life = %.17g\\n", d / $2
    printf "{\\"pairs\\": [[%.17g, %.17g]]}", $2, 2 * $2 > "out.json"
    printf "a,b\\n0,0\\n1,%.17g\\n", $2 * $2 > "out.csv"
}' input.txt
"""


@pytest.fixture
def machine(folder):
    """Return a function that writes machine file, template, program and study."""

    def write(program=PROGRAM, text=MACHINE):
        (folder / "machine.toml").write_text(text)
        (folder / "deck").write_text("load={load}\nseed={seed}\nother={braces}\n")
        (folder / "own.toml").write_text(STUDY)
        (folder / "program").write_text(program)
        (folder / "program").chmod(0o755)

    return write


def run(uq, *more):
    ended = uq("run", "own.toml", "--model", "machine.toml", "-o", "own.nc", "--quiet", *more)
    return ended, package.open_result("own.nc") if Path("own.nc").is_file() else None


def test_rows_are_those_of_the_program(uq, machine, folder):
    machine()
    _, ds = run(uq)
    load = ds["load"].values
    known = load <= 1.5
    assert (ds["status"].values == np.where(known, Status.OK, Status.RAISED)).all()
    expected = np.where(load < 0.2, np.inf, 3.0 / load)
    assert (ds["life"].values[known] == expected[known]).all()
    assert (ds["pair"].values[known] == np.stack([load, 2 * load], axis=1)[known]).all()
    assert (ds["last"].values[known] == (load**2)[known]).all()
    assert not known.all() and not (folder / "pad.rows" / "running").exists()


def test_a_failed_row_keeps_its_folder_and_says_where(uq, machine, folder):
    machine()
    _, ds = run(uq)
    said = ds["status"].attrs["example_raised"]
    assert "ended with exit code 3: the pad is too heavy (heavier than 1.5); see " in said
    kept = sorted(one.name for one in (folder / "pad.rows").iterdir())
    assert len(kept) == (ds["status"].values == Status.RAISED).sum()
    failed = Path(said.rpartition("; see ")[2])
    assert {one.name for one in failed.iterdir()} == {"input.txt", "stdout.txt", "stderr.txt"}
    lines = (failed / "input.txt").read_text().splitlines()
    assert float(lines[0].removeprefix("load=")) in ds["load"].values
    assert lines[1].removeprefix("seed=").isdigit() and lines[2] == "other={braces}"


def test_without_failures_nothing_is_left(uq, machine, folder):
    machine(PROGRAM.replace("1.5", "2.9"))
    before = sorted(one.name for one in folder.iterdir())
    run(uq)
    assert sorted(one.name for one in folder.iterdir()) == sorted([*before, "own.nc"])


def test_other_code_of_the_program_is_noticed(uq, machine):
    machine()
    run(uq)
    machine(PROGRAM.replace("life =", "life  ="))
    assert "other code" in run(uq)[0].err


@pytest.mark.parametrize("argument", ["{machine_folder}/solver", "--deck={machine_folder}/solver"])
def test_other_code_of_a_file_among_the_arguments_is_noticed(uq, machine, folder, argument):
    machine(text=MACHINE.replace('"{depth}"', f'"{{depth}}", "{argument}"'))
    (folder / "solver").write_text("1")
    run(uq)
    (folder / "solver").write_text("2")
    assert "other code" in run(uq)[0].err


def test_a_template_keeps_its_line_ends(uq, machine, folder):
    machine(PROGRAM.replace("awk", "grep -q 'load=.*\r' input.txt || exit 5\nawk"))
    (folder / "deck").write_bytes(b"load={load}\r\n")
    _, ds = run(uq, "--samples", "4")
    assert "exit code 5" not in str(ds["status"].attrs)


def test_a_template_that_is_no_text_is_one_line(uq, machine, folder):
    machine()
    (folder / "deck").write_bytes(b"load={load}\xff\xfe")
    ended = uq("check", "own.toml", "--model", "machine.toml")
    assert ended.code == 2 and "is not a text in UTF-8" in ended.err and ended.err.count("\n") == 1


def running_in(folder):
    """Yield the processes whose current folder is that of a row, or was."""
    for one in psutil.process_iter():
        with suppress(psutil.NoSuchProcess, psutil.AccessDenied):
            if one.cwd().startswith(f"{folder}/pad.rows/") and one.status() != "zombie":
                yield one


HOSTILE = {
    "sleep 300 &": ("ok", ""),
    "setsid sleep 300 &": ("ok", ""),
    "trap '' TERM INT HUP; sleep 300": ("timed-out", "did not end within 1 s"),
    "kill -9 $$": ("raised", "was ended by signal 9"),
    "read answer < /dev/tty || exit 4": ("raised", "ended with exit code"),
    "echo life = nan; exit 0": ("bad-shape", "wrote no file 'out.json'"),
    "rm input.txt; exit 0": ("bad-shape", "has no 'life' in its output: no match"),
    "echo life = many; exit 0": ("bad-shape", "no number: 'many'"),
    "echo '<html>' > out.json; echo life = 1; exit 0": ("bad-shape", "has no 'pair' in 'out.json'"),
    "ulimit -f 1; yes": ("raised", "File size limit exceeded"),
}


@pytest.mark.parametrize("line", HOSTILE)
def test_a_hostile_program_costs_its_rows_only(uq, machine, folder, line):
    hostile = f"#!/bin/sh\ncase $(head -n 1 input.txt) in load=1*) {line}\nesac\n"
    machine(PROGRAM.replace("#!/bin/sh\n", hostile).replace("1.5", "2.5"))
    ended, ds = run(uq, "--row-limit", "1", "--samples", "4")
    label, words = HOSTILE[line]
    struck = {Status(code).label for code in ds["status"].values[ds["load"].values >= 1]}
    assert struck == {label} and "Traceback" not in ended.err
    assert (ds["status"].values[ds["load"].values < 1] == Status.OK).all()
    if words:
        assert words in ds["status"].attrs[f"example_{label.replace('-', '_')}"]
    assert not list(running_in(folder))


def test_a_program_that_floods_the_disk_is_ended(machine, folder, monkeypatch):
    machine("#!/bin/sh\nexec head -c 10000000 /dev/zero\n")
    monkeypatch.setattr(descendants, "_adopting", True)
    monkeypatch.setattr(descendants, "LARGEST", 100_000)
    monkeypatch.setattr(program, "end_descendants", lambda: None)  # those of this process
    model = find_model("machine.toml")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        x, seed = np.array([[1.0, 3.0]]), np.zeros(1, np.uint64)
        _, status, messages = model.batch(x, seed, model.settings())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert status == Status.RAISED
    assert "was ended, as it wrote a file larger than 1e+05 bytes; see " in messages[0]


MISTAKES = {
    ('name = "pad"', "nam = 'pad'"): "[machine] nam = \"pad\": no such key; did you mean 'name'?",
    ("nominal = 3.0", "nominal = 'x'"): '[parameters] depth.nominal = "x": must be a number',
    ('template = "deck"', ""): "has no place {load} in command",
    ('"deck"', '"dek"'): '[machine] template = "dek": no such file',
    ('json = "pairs.0"', ""): "give one of json, csv, netcdf and pattern",
    ("(\\S+)", "\\S+"): "pattern must have one group in parentheses, not 0",
    ("nominal = 1.0", "nominal = 11.0"): "must lie within the bounds",
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
def test_a_mistake_in_a_machine_file_is_one_line(uq, machine, change):
    machine(text=MACHINE.replace(*change))
    ended = uq("check", "own.toml", "--model", "machine.toml")
    assert (ended.code, ended.out) == (2, "")
    assert MISTAKES[change] in ended.err
    assert all("machine" in one for one in ended.err.splitlines())


LOST = {
    "exec sleep 300": ("timed-out", "did not end within 0.5 s"),
    "kill -9 $PPID; exec sleep 300": ("crashed", "killed its process (Killed)"),
    "echo nan > out.json; printf 'a,b\\n0,nan\\n' > out.csv": ("non-finite", "'last' is nan"),
}


def test_a_parameter_that_is_a_word_of_python_is_one_line(uq, machine):
    machine(text=MACHINE.replace("depth", "lambda"))
    said = uq("check", "own.toml", "--model", "machine.toml").err
    assert "parameter 'lambda' cannot have this name in Python" in said and said.count("\n") == 1


@pytest.mark.parametrize("line", LOST)
def test_a_lost_row_keeps_its_folder_without_large_files(uq, machine, folder, line):
    writing = "head -c 11000000 /dev/zero > large\ntouch small\necho life = 1\n"
    pair = "echo '{\"pairs\": [[1, 2]]}' > out.json\n"
    machine(f"#!/bin/sh\n{writing}{line}\n{pair}")
    _, ds = run(uq, "--row-limit", "0.5", "--samples", "2")
    label, words = LOST[line]
    assert {Status(code).label for code in ds["status"].values} == {label}
    said = ds["status"].attrs[f"example_{label.replace('-', '_')}"]
    assert words in said
    assert Path(said.rpartition("; see ")[2], "small").is_file()
    kept = [one.name for one in (folder / "pad.rows").iterdir()]
    assert len(kept) == 2 and all(one.startswith("failed-") for one in kept)
    assert not list((folder / "pad.rows").rglob("large"))


def test_a_row_limit_costs_no_more_than_the_limit_of_each_row(uq, machine):
    machine("#!/bin/sh\nexec sleep 300\n")
    began = time.monotonic()
    _, ds = run(uq, "--row-limit", "0.2", "--samples", "6")
    assert (ds["status"].values == Status.TIMED_OUT).all()
    assert time.monotonic() - began < 10  # each in a process of its own: half a minute


def test_numbers_of_fortran_are_read(uq, machine):
    machine(PROGRAM.replace('life = inf"', 'life = 1.5D+03"'))
    _, ds = run(uq)
    assert (ds["life"].values[ds["load"].values < 0.2] == 1500.0).all()


def test_a_study_in_its_place_is_one_line(uq, machine):
    machine()
    assert "is a study, not a machine file" in uq("check", "own.toml", "--model", "own.toml").err


def test_a_program_that_is_not_there_is_a_status(uq, machine, folder):
    machine()
    (folder / "program").unlink()
    _, ds = run(uq)
    assert "cannot be started: No such file" in ds["status"].attrs["example_raised"]


def test_folders_of_killed_processes_are_removed(folder):
    folders = Folders(folder / "rows")
    with folders.row([1.0]) as first:
        dead = first.with_name(first.name.replace(str(os.getpid()), "999999999"))
        dead.mkdir()
        with Folders(folder / "rows").row([2.0]) as second:
            assert first.is_dir() and second.is_dir() and not dead.exists()
    folders.leave()
    assert not (folder / "rows").exists()


def test_a_process_that_leaves_takes_no_folder_from_another(folder, monkeypatch):
    real, left = tempfile.mkdtemp, []

    def mkdtemp(*arguments, **options):
        if not left:  # between two steps of the other
            left.append(Folders(folder / "rows").leave())
        return real(*arguments, **options)

    monkeypatch.setattr(tempfile, "mkdtemp", mkdtemp)
    with Folders(folder / "rows").row([1.0]) as one:
        assert one.is_dir()
