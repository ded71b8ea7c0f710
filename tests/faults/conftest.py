"""Real runs of the command line in processes of their own, which can be killed."""

import multiprocessing
import os
import sys
from collections import Counter
from multiprocessing import forkserver

import pytest
from faulty_studies import FAULTY
from killed_runs import MODEL, Command, kept, until

from uq.study.definition import load_study

OUTCOMES = {
    "SIGKILL of a run": "resumes, bit-identical",
    "SIGKILL of a run that has kept no row": "resumes, bit-identical",
    "SIGKILL of a run with workers": "no process is left; resumes, bit-identical",
    "SIGKILL during the merge": "resumes, bit-identical",
    "SIGKILL of a run that stops early": "stops at the same size, bit-identical",
    "[design] until edited between runs": "resumes up to an interim size, same rows",
    "SIGKILL of an extension": "the old result is kept; resumes, bit-identical",
    "Ctrl-C": "explains how to resume; bit-identical",
    "SIGTERM": "explains how to resume; bit-identical",
    "lock of a living process": "refused with a message",
    "lock of a dead process": "recognised, resumes, bit-identical",
    "lock whose process number is in use again": "recognised, resumes, bit-identical",
    "lock of another computer": "refused with a message",
    "chunk file truncated": "recomputed, bit-identical",
    "chunk file emptied": "recomputed, bit-identical",
    "chunk file with one bit flipped": "recomputed, bit-identical",
    "chunk file missing": "recomputed, bit-identical",
    "journal cut": "loses only the cut record; bit-identical",
    "journal record changed": "recomputed, bit-identical",
    "file-size limit": "one message, no partial file; resumes, bit-identical",
    "full disk": "one message, no partial file; resumes, bit-identical",
    "read-only folder": "refused with a message",
    "study edited between runs": "refused, or resumed if rows stay the same",
    "code of the model edited between runs": "refused with a message, or mixed on request",
    "process of a worker killed": "restarted, bit-identical",
    "worker of a cluster killed too often with a chunk": "chunk halved, bit-identical",
    "processes of workers killed again and again": "ends with a message",
    "workers that can start no process": "ends with a message",
    "worker joins or leaves a cluster": "bit-identical",
    "scheduler killed": "ends with a message; resumes here, bit-identical",
    "cluster loses its only worker": "ends with a message",
    "cold numba cache, eight runs at once": "bit-identical",
    "decimal comma": "bit-identical",
    "no terminal, no colours, closed standard input": "bit-identical",
    "path with blanks and accents": "bit-identical",
    "rows in another order, in other chunks": "bit-identical",
    "function: driver, worker or what computes a row killed": "bit-identical",
    "program: driver, worker or what computes a row killed": "bit-identical",
    "server: driver, worker or what computes a row killed": "bit-identical",
    "fmu: driver, worker or what computes a row killed": "bit-identical",
    "row: raise": "marked raised; other rows unaffected",
    "row: nan": "marked non-finite; other rows unaffected",
    "row: inf": "marked non-finite; other rows unaffected",
    "row: shape": "marked bad-shape; other rows unaffected",
    "row: exit": "marked crashed; other rows unaffected",
    "row: hang": "marked timed-out; other rows unaffected",
    "row: segfault": "marked crashed; other rows unaffected",
    "row: killed": "marked crashed; other rows unaffected",
    "row: dtype": "the model is refused with a message",
}
"""What is done to runs, and what the tests demand then: in any case that no row is lost."""


@pytest.fixture(scope="session")
def context():
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["command"])
    with pytest.MonkeyPatch.context() as patch:
        # Python 3.11 does not hand its path to the server, which then silently preloads nothing.
        patch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
        forkserver.ensure_running()
    return context


@pytest.fixture
def start(context, folder):
    """Return a function that starts ``uq ARGUMENTS`` in a process of its own."""
    started = []

    def begin(*arguments, **environment):
        started.append(Command(context, folder, [str(word) for word in arguments], environment))
        return started[-1]

    yield begin
    for command in started:
        if command.process.is_alive():
            command.kill()


@pytest.fixture
def call(start):
    """Return a function that runs ``uq ARGUMENTS``: exit code and all that was printed."""
    return lambda *arguments, **environment: start(*arguments, **environment).wait()


@pytest.fixture
def under_way(start):
    """Return a function that starts a slow run, and returns it when it has kept some more rows.

    So many at least, in as many new chunk files: a fault that comes then finds rows to harm.
    """

    def begin(study, *options, rows=1, chunks=1, seconds=0.02):
        old = kept()
        options = (*MODEL, "--chunk-rows", "7", *options)
        run = start("run", study, *options, UQ_TEST_SECONDS=str(seconds))
        until(lambda: kept().rows >= old.rows + rows and kept().chunks >= old.chunks + chunks)
        assert run.process.is_alive()
        return run

    return begin


@pytest.fixture
def injected(record_property):
    """Return a function that counts a fault: ``injected(fault, times)``."""

    def count(fault, times=1):
        assert fault in OUTCOMES
        record_property(fault, int(times))

    return count


def pytest_terminal_summary(terminalreporter):
    """Print how often each fault was injected, as a table for the documentation."""
    ended = {"passed": Counter(), "failed": Counter()}
    for outcome, times in ended.items():
        for report in terminalreporter.getreports(outcome):
            if report.when == "call":
                for fault, count in report.user_properties:
                    times[fault] += count
    if not any(ended.values()):
        return
    lines = ["| Fault | Injected | Rows lost | Outcome |", "|---|---:|---:|---|"]
    for fault, outcome in OUTCOMES.items():
        if times := ended["passed"][fault]:
            lines.append(f"| {fault} | {times} | 0 | {outcome} |")
        if times := ended["failed"][fault]:
            lines.append(f"| {fault} | {times} | ? | TEST FAILED |")
    terminalreporter.section("faults injected")
    terminalreporter.write_line("\n".join(lines))


@pytest.fixture
def study(write_study):
    """Return the path of a study some of whose rows fail."""
    return write_study(
        model="patient", uncertain=("x1", "x2"), samples=1500, more="[analysis]\nmax_failed = 1.0"
    )


@pytest.fixture
def study_of(write_study):
    """Return a function that writes a study of a faulty model and loads it."""

    def make(model=FAULTY, samples=120, **settings):
        text = "\n".join(f"{key} = {value!r}" for key, value in settings.items())
        name = "linear" if model == "linear" else "faulty"
        law = 'distribution = "uniform", lower = 0.0, upper = 1.0'
        more = f"[settings]\n{text}"
        path = write_study(model=name, uncertain=("x1",), samples=samples, law=law, more=more)
        return load_study(path, None if model == "linear" else model)

    return make


@pytest.fixture
def undisturbed(study, call, folder, results={}):  # noqa: B006  each computed once
    """Return the bytes of the result of a run that nothing happens to."""
    text = study.read_text()
    if text not in results:
        assert call("run", study, *MODEL, "-o", "undisturbed.nc")[0] == 0
        results[text] = (folder / "undisturbed.nc").read_bytes()
    return results[text]
