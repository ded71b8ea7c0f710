"""Ctrl-C ends a run at once, whatever it is doing, and leaves nothing behind but finished rows."""

import asyncio
import contextlib
import gc
import os
import pty
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from own_study import own_study
from wordings import sentence

from uq.execution.clusters import _without_timeouts
from uq.execution.workers import quiet

PATIENCE = 30.0
"""How long a busy machine may take for what should take a moment [s]."""

COMMAND = Path(sys.executable).with_name("uq")
COMPILING = sentence("compiling")


@pytest.fixture
def started(write_study, folder):
    """Return a function that starts ``uq run`` in a process group of its own."""
    temporary = folder / "temporary"
    temporary.mkdir()
    mark = folder / "temporary.mark"
    processes = []

    def start(model, *options, seconds=0.0, program=None, stderr=subprocess.PIPE):
        path = write_study(
            uncertain=("x1",), samples=10_000, more=f"[settings]\nseconds = {seconds}"
        )
        command = [COMMAND, "run", path, "--model", f"process_models:{model}", *options]
        processes.append(
            subprocess.Popen(
                [sys.executable, "-c", program] if program else command,
                stdout=subprocess.PIPE,
                stderr=stderr,
                text=True,
                start_new_session=True,
                env=os.environ
                | {
                    "TMPDIR": str(temporary),
                    "PYTHONPATH": os.pathsep.join(sys.path),
                    "UQ_TEST_MARK": str(mark),
                },
            )
        )
        return processes[-1], mark

    yield start
    for process in processes:
        process.kill()
        process.communicate()
    assert not any(temporary.iterdir())
    for process in psutil.process_iter(["cmdline"]):
        assert str(temporary) not in " ".join(process.info["cmdline"] or [])
    mark.unlink(missing_ok=True)
    assert {entry.name for entry in folder.iterdir()} - {"results"} == {"small.toml", "temporary"}
    if (folder / "results").exists():  # then rows were done, and nothing but them is kept
        kept = folder / "results" / "small.nc.rows"
        assert list((folder / "results").iterdir()) == [kept]
        assert {entry.suffix or entry.name for entry in kept.iterdir()} == {"journal", ".rows"}


def wait_until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def workers_of(process):
    children = []
    for child in psutil.Process(process.pid).children():
        with contextlib.suppress(psutil.NoSuchProcess):  # it may end meanwhile
            children += [child] * ("uq.execution.child" in child.cmdline())
    return children


def to_process(process):
    process.send_signal(signal.SIGINT)


def to_group(process):
    os.killpg(process.pid, signal.SIGINT)


def check_ended(process, beginning):
    out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out) == (130, "")
    *before, last = err.splitlines()
    assert before in ([], [COMPILING])
    assert last.startswith(beginning)
    assert Path("results").exists() == err.endswith(sentence("resumes"))


@pytest.mark.parametrize("send", [to_process, pytest.param(to_group, marks=pytest.mark.slow)])
def test_while_a_kernel_runs(started, send):
    process, mark = started("SPINNING", "--workers", "0", seconds=100.0)
    wait_until(mark.exists)
    time.sleep(1.0)  # compiled and running
    send(process)
    check_ended(process, sentence("nothing written"))


@pytest.mark.slow
@pytest.mark.parametrize("options", [("--workers", "0"), ()])
def test_while_a_kernel_compiles(started, options):
    process, _ = started("COMPILING", *options)
    assert process.stderr.readline() == f"{COMPILING}\n"  # before any row is there
    to_group(process)
    check_ended(process, sentence("nothing written"))


@pytest.mark.parametrize("send", [pytest.param(to_process, marks=pytest.mark.slow), to_group])
def test_while_workers_work(started, send):
    process, _ = started("SLEEPING", "--workers", "2", "--chunk-rows", "4", seconds=0.05)
    wait_until(lambda: any(Path("results").glob("*/*.rows")))
    workers = workers_of(process)
    send(process)
    check_ended(process, "interrupted after ")
    assert len(workers) == 2
    psutil.wait_procs(workers, timeout=PATIENCE)
    assert not any(worker.is_running() for worker in workers)


@pytest.mark.slow
def test_while_workers_start(started):
    process, _ = started("SLEEPING", "--workers", "2", "--chunk-rows", "1", seconds=0.05)
    wait_until(lambda: workers_of(process))
    to_group(process)
    check_ended(process, "interrupted")


@pytest.mark.parametrize(
    "delay",
    [0.5, *(pytest.param(seconds, marks=pytest.mark.slow) for seconds in (0.2, 0.35, 0.65))],
)
def test_while_modules_are_loaded(started, delay):
    process, _ = started("SLEEPING", "--workers", "0", seconds=1.0)
    loading = psutil.Process(process.pid)
    wait_until(lambda: sum(loading.cpu_times()[:2]) >= delay)  # on a busy computer, later
    to_group(process)
    check_ended(process, "interrupted")


@pytest.mark.slow
def test_a_request_to_terminate_is_obeyed_too(started):
    process, mark = started("SLEEPING", "--workers", "0", seconds=1.0)
    wait_until(mark.exists)
    process.terminate()
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 143
    assert err.startswith("interrupted")


@pytest.mark.slow
def test_a_child_that_computes_ends_with_a_process_that_is_killed(started):
    process, mark = started("SLEEPING", seconds=100.0)
    wait_until(mark.exists)
    children = psutil.Process(process.pid).children()
    assert any("uq.execution.child" in child.cmdline() for child in children)
    process.kill()
    alive = psutil.wait_procs(children, PATIENCE)[1]
    for child in alive:
        child.kill()
    assert alive == []
    shutil.rmtree("results")


FORKING = """
import os, signal, time, uq
@uq.machine(returns={"y": "1"})
def forking(x1: float = 0.0):
    if (child := os.fork()) == 0:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(60)
    return {"y": os.waitpid(child, 0)[1]}
"""


@pytest.mark.slow
def test_a_process_that_a_row_has_forked_undoes_nothing(write_function):
    file = write_function(FORKING, own_study("forking", samples=3))
    command = [sys.executable, "-m", "uq", "run", "own.toml", "--model", file, "--workers", "0"]
    ended = subprocess.run([*command, "--quiet"], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")


@pytest.mark.slow
def test_in_a_script_it_is_the_exception_of_python(started):
    program = (
        "import signal, uq\n"
        # As in a terminal, also where the tests run in the background and ignore it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "study = uq.load_study('small.toml', 'process_models:SLEEPING')\n"
        "try:\n"
        "    uq.run(study, workers=2, chunk_rows=4)\n"
        "except KeyboardInterrupt:\n"
        "    print('stopped')\n"
    )
    process, _ = started("SLEEPING", seconds=0.05, program=program)
    wait_until(lambda: workers_of(process))
    time.sleep(2.0)
    to_process(process)
    assert process.communicate(timeout=PATIENCE) == ("stopped\n", "")
    assert process.returncode == 0


@pytest.mark.slow
def test_a_terminal_shows_progress_and_gets_its_cursor_back(started):
    ours, theirs = pty.openpty()
    process, _ = started("SLEEPING", "--workers", "0", seconds=0.05, stderr=theirs)
    os.close(theirs)
    shown = b""
    while b" rows/s, " not in shown:
        shown += os.read(ours, 10_000)
    to_process(process)
    process.wait(PATIENCE)
    with contextlib.suppress(OSError):  # how a terminal says that nobody writes to it any more
        while more := os.read(ours, 10_000):
            shown += more
    os.close(ours)
    hidden, visible = b"\x1b[?25l", b"\x1b[?25h"
    assert shown.count(hidden) == shown.count(visible) == 1
    assert shown.rindex(visible) > shown.rindex(hidden)
    assert b"interrupted after " in shown.rpartition(visible)[2]
    assert b" of 10000 rows, " in shown and b" left, 0 invalid" in shown


def test_what_a_cluster_leaves_unawaited_says_nothing(caplog):
    loop = asyncio.new_event_loop()

    def leave():
        future = loop.create_future()
        future.set_exception(TimeoutError("Timeout"))
        future.itself = [future]  # collected late

    with quiet():
        leave()
    assert caplog.records == []
    leave()
    gc.collect()
    assert [record.name for record in caplog.records] == ["asyncio"]
    loop.close()


def test_a_reply_of_a_cluster_that_comes_too_late_says_nothing_after_the_run(caplog):
    loop = asyncio.new_event_loop()
    loop.set_exception_handler(_without_timeouts)
    for error in (TimeoutError("Timeout"), ValueError("a mistake")):
        loop.create_future().set_exception(error)
    gc.collect()
    assert [record.name for record in caplog.records] == ["asyncio"]
    assert "a mistake" in caplog.text and "Timeout" not in caplog.text
    loop.close()
