"""Real runs of the command line in processes of their own, which can be killed."""

import multiprocessing
import os
import signal
import time
from pathlib import Path

import command
import pytest

PATIENCE = 60.0
"""How long a busy machine may take for what should take a moment [s]."""

OUT = Path("results/small.nc")
ROWS = Path("results/small.nc.rows")


class Command:
    """One ``uq`` command under way."""

    def __init__(self, context, folder, arguments, environment):
        self.output = folder / f"output-{time.monotonic_ns()}"
        self.process = context.Process(
            target=command.run, args=(folder, arguments, environment, self.output)
        )
        self.process.start()

    def send(self, number):
        os.kill(self.process.pid, number)

    def wait(self):
        """Return exit code and all that was printed."""
        self.process.join(PATIENCE)
        assert self.process.exitcode is not None, "waited in vain"
        text = self.output.read_text() if self.output.exists() else ""
        self.output.unlink(missing_ok=True)
        return self.process.exitcode, text

    def kill(self):
        self.send(signal.SIGKILL)
        return self.wait()


@pytest.fixture(scope="session")
def context():
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["command"])
    return context


@pytest.fixture
def start(context, folder):
    """Return a function that starts ``uq ARGUMENTS`` in a process of its own."""
    started = []

    def begin(*arguments, **environment):
        started.append(Command(context, folder, [str(word) for word in arguments], environment))
        return started[-1]

    yield begin
    for one in started:
        if one.process.is_alive():
            one.kill()


@pytest.fixture
def call(start):
    """Return a function that runs ``uq ARGUMENTS``: exit code and all that was printed."""
    return lambda *arguments, **environment: start(*arguments, **environment).wait()


@pytest.fixture
def under_way(start):
    """Return a function that starts a slow run, and returns it when it has kept some more rows."""

    def begin(study, *options, chunks=1):
        journal = ROWS / "journal"
        before = _lines(journal)
        run = start("run", study, *MODEL, "--chunk-rows", "7", *options, UQ_TEST_SECONDS="0.02")
        until(lambda: _lines(journal) > before + chunks)  # one line for the run itself
        return run

    return begin


def _lines(journal):
    return journal.read_bytes().count(b"\n") if journal.exists() else 0


@pytest.fixture
def study(write_study):
    """Return the path of a study some of whose rows fail."""
    return write_study(
        model="patient", uncertain=("x1", "x2"), samples=1500, more="[analysis]\nmax_failed = 1.0"
    )


@pytest.fixture
def undisturbed(study, call, folder, results={}):  # noqa: B006  each computed once
    """Return the bytes of the result of a run that nothing happens to."""
    text = study.read_text()
    if text not in results:
        assert call("run", study, *MODEL, "-o", "undisturbed.nc")[0] == 0
        results[text] = (folder / "undisturbed.nc").read_bytes()
    return results[text]


MODEL = ("--model", "command:PATIENT", "--workers", "0", "--quiet")


def until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.0005)
