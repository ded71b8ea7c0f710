"""Programs that fail in every way cost their rows only, and leave nothing behind."""

import os
import resource
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil
import pytest
from own_machines import PAD, PAD_PROGRAM, run_program

from uq.contract import Status
from uq.machines.row_resources import Folders, size_of
from uq.study.installed_models import model_at


def running_in(folder):
    """Yield the processes whose current folder is that of a row, or was."""
    for process in psutil.process_iter():
        with suppress(psutil.NoSuchProcess, psutil.AccessDenied):
            if process.cwd().startswith(f"{folder}/pad.rows/") and process.status() != "zombie":
                yield process


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
def test_a_hostile_program_costs_its_rows_only(uq, write_program, folder, line):
    hostile = f"#!/bin/sh\ncase $(head -n 1 input.txt) in load=1*) {line}\nesac\n"
    write_program(PAD_PROGRAM.replace("#!/bin/sh\n", hostile).replace("1.5", "2.5"))
    ended, ds = run_program(uq, "--row-limit", "1", "--samples", "4")
    label, words = HOSTILE[line]
    struck = {Status(code).label for code in ds["status"].values[ds["load"].values >= 1]}
    assert struck == {label} and "Traceback" not in ended.err
    assert (ds["status"].values[ds["load"].values < 1] == Status.OK).all()
    if words:
        assert words in ds["status"].attrs[f"example_{label.replace('-', '_')}"]
    assert not list(running_in(folder))


def test_a_program_that_floods_the_disk_is_ended(write_program, folder, monkeypatch):
    write_program("#!/bin/sh\nexec head -c 10000000 /dev/zero\n")
    monkeypatch.setattr("uq.machines.row_resources._adopting", True)
    monkeypatch.setattr("uq.machines.row_resources.LARGEST", 100_000)
    # Those of this process are not ended.
    monkeypatch.setattr("uq.machines.program.end_descendants", lambda: None)
    model = model_at("machine.toml")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        x, seed = np.array([[1.0, 3.0]]), np.zeros(1, np.uint64)
        _, status, messages = model.batch(x, seed, model.settings())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert status == Status.RAISED
    assert "was ended, as it wrote a file larger than 1e+05 bytes; see " in messages[0]


def test_a_program_that_fills_the_disk_with_files_is_ended(write_program, monkeypatch):
    many = "i=0; while :; do head -c 9999 /dev/zero > f$i; i=$((i+1)); done"
    write_program(f"#!/bin/sh\n{many}\n")
    monkeypatch.setattr("uq.machines.row_resources.LARGEST", 1_000_000)
    monkeypatch.setattr("uq.machines.program._LOOK_SECONDS", 0.1)
    model = model_at("machine.toml")
    x, seed = np.array([[1.0, 3.0]]), np.zeros(1, np.uint64)
    _, status, messages = model.batch(x, seed, model.settings())
    assert status == Status.RAISED
    assert "was ended, as it wrote files of more than 1e+06 bytes; see " in messages[0]


def test_of_many_failed_rows_little_is_kept(folder, monkeypatch):
    monkeypatch.setattr("uq.machines.row_resources._MOST_KEPT", 5000)
    with suppress(ValueError), Folders(folder / "rows").row([1.0]) as row_folder:
        for i in range(9):
            (row_folder / f"large{i}").write_bytes(bytes(1000))
        (row_folder / "small").write_bytes(bytes(10))
        raise ValueError
    (kept,) = (folder / "rows").iterdir()
    assert (kept / "small").is_file() and 4000 < size_of(kept) <= 5000


def test_the_folder_of_a_row_that_no_longer_fails_is_removed(folder):
    rows = Folders(folder / "rows")
    with suppress(ValueError), rows.row([1.0]):
        raise ValueError
    assert rows.kept([1.0]).is_dir()
    with rows.row([1.0]):
        pass
    assert not list(rows.root.iterdir())


LOST = {
    "exec sleep 300": ("timed-out", "did not end within 0.5 s"),
    "kill -9 $PPID; exec sleep 300": ("crashed", "killed its process (Killed)"),
    "echo nan > out.json; printf 'a,b\\n0,nan\\n' > out.csv": ("non-finite", "'last' is nan"),
}


@pytest.mark.parametrize(
    "line",
    [next(iter(LOST)), *(pytest.param(line, marks=pytest.mark.slow) for line in [*LOST][1:])],
)
def test_a_lost_row_keeps_its_folder_without_large_files(uq, write_program, folder, line):
    writing = "head -c 11000000 /dev/zero > large\ntouch small\necho life = 1\n"
    pair = "echo '{\"pairs\": [[1, 2]]}' > out.json\n"
    write_program(f"#!/bin/sh\n{writing}{line}\n{pair}")
    _, ds = run_program(uq, "--row-limit", "0.5", "--samples", "2")
    label, words = LOST[line]
    assert {Status(code).label for code in ds["status"].values} == {label}
    sentence = ds["status"].attrs[f"example_{label.replace('-', '_')}"]
    assert words in sentence
    assert Path(sentence.rpartition("; see ")[2], "small").is_file()
    kept = [path.name for path in (folder / "pad.rows").iterdir()]
    assert len(kept) == 2 and all(name.startswith("failed-") for name in kept)
    assert not list((folder / "pad.rows").rglob("large"))


def test_a_row_limit_costs_no_more_than_the_limit_of_each_row(uq, write_program):
    write_program("#!/bin/sh\nexec sleep 300\n")
    began = time.monotonic()
    _, ds = run_program(uq, "--row-limit", "0.2", "--samples", "6")
    assert (ds["status"].values == Status.TIMED_OUT).all()
    assert time.monotonic() - began < 10  # each in a process of its own: half a minute


def test_a_program_that_cannot_be_started_is_refused_before_the_run(uq, write_program, folder):
    def refused(text=PAD):
        write_program(text=text)
        ended = uq("run", "own.toml", "--model", "machine.toml")
        assert ended.code == 2 and ended.err.count("\n") == 1
        return ended.err

    assert "the one beside this file is './program'" in refused(PAD.replace("./prog", "prog"))
    wrong = refused(PAD.replace("./program", "./progam"))
    assert "'./progam' is no file; did you mean './program'?" in wrong
    write_program(text=PAD)
    (folder / "program").chmod(0o600)
    ended = uq("run", "own.toml", "--model", "machine.toml")
    assert "'./program' is not executable: chmod +x ./program" in ended.err


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
    with Folders(folder / "rows").row([1.0]) as row_folder:
        assert row_folder.is_dir()
