"""What is printed has nowhere to go: one line, an exit code, and no harm to files."""

import os
import pty
import subprocess
import sys
import termios
from importlib.metadata import version
from pathlib import Path

import pytest

import uq as api

COMMAND = Path(sys.executable).with_name("uq")
FULL, CLOSED = "No space left on device", "Bad file descriptor"


@pytest.fixture(
    params=[True, pytest.param(False, marks=pytest.mark.slow)], ids=["buffered", "unbuffered"]
)
def shell(request, folder):
    """Return a function that has a shell run ``uq ARGUMENTS``, with redirections."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    if not request.param:
        environment["PYTHONUNBUFFERED"] = "1"

    def call(line):
        ended = subprocess.run(
            f"'{COMMAND}' {line}", shell=True, env=environment, capture_output=True, text=True
        )
        return ended.returncode, ended.stderr

    return call


@pytest.mark.parametrize(
    "verb",
    [
        "schema",
        *(
            pytest.param(verb, marks=pytest.mark.slow)
            for verb in ("models linear", "--version", "run --help")
        ),
    ],
)
@pytest.mark.parametrize(
    ("lost", "why"), [("> /dev/full", FULL), pytest.param(">&-", CLOSED, marks=pytest.mark.slow)]
)
def test_output_that_is_lost_is_a_line(shell, verb, lost, why):
    assert shell(f"{verb} {lost}") == (1, f"uq: standard output cannot be written: {why}\n")


@pytest.mark.slow
@pytest.mark.parametrize("lost", ["2>/dev/full", "2>&-"])
def test_a_mistake_that_nobody_can_read_keeps_its_exit_code(shell, lost):
    assert shell(f"init nothing {lost}") == (2, "")


def test_a_mistake_keeps_its_exit_code(shell):
    sentence = "no such model 'nothing'"
    code, printed = shell("init nothing >&-")
    assert (code, printed[: len(sentence)], printed.count("\n")) == (2, sentence, 1)


@pytest.mark.slow
@pytest.mark.parametrize("shell", [True], indirect=True)
def test_a_run_without_any_stream_writes_a_sound_result(shell, write_study):
    study = write_study(samples=8)
    assert shell(f"run {study} --workers 0 --quiet <&- >&- 2>&-") == (0, "")
    assert api.open_result("results/small.nc").sizes["row"] == 8
    code, printed = shell(f"run {study} --workers 0 >&-")
    assert (code, printed) == (1, f"uq: standard output cannot be written: {CLOSED}\n")


def test_the_version_is_that_of_the_distribution(uq):
    assert uq("--version") == (0, f"vibrolife {version('vibrolife')}\n", "")


def test_a_narrow_terminal_is_seen_as_narrow():
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (24, 60))
    # Its own environment: readline, if it is loaded, has the widths of this one in the C library's.
    subprocess.run([COMMAND, "run", "--help"], stdout=theirs, env=environment, check=True)
    os.close(theirs)
    lines = os.read(ours, 10_000).decode().splitlines()
    os.close(ours)
    assert 50 < max(map(len, lines)) <= 60
