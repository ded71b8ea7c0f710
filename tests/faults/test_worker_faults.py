"""Whatever happens to the processes that compute, the result is that of an undisturbed run."""

import signal
import threading
import time

import numpy as np
import psutil
import pytest
from faulty_studies import PATIENCE, computed_here
from in_memory import compute

from uq.contract import Status
from uq.errors import RunError
from uq.execution import isolation
from uq.result.workload import workload_of


def processes(module):
    """Return the living processes, started by this one, that run a module."""
    child_processes = []
    for child in psutil.Process().children(recursive=True):
        try:
            if module in child.cmdline() and child.status() != psutil.STATUS_ZOMBIE:
                child_processes.append(child)
        except psutil.NoSuchProcess:
            pass
    return child_processes


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


class Killer:
    """Kills processes that compute, as rows of a run arrive; called with the run's progress."""

    def __init__(self, times, rows, all_of_them):
        self.all = all_of_them
        self.marks = [rows * (i + 1) // (times + 1) for i in range(times)]

    def __call__(self, progress):
        if not self.marks or progress.done < self.marks[0]:
            return
        self.marks.pop(0)
        wait_for(lambda: processes(CHILD))
        for process in processes(CHILD)[: None if self.all else 1]:
            process.kill()


CHILD = "uq.execution.child"


@pytest.mark.parametrize(
    ("times", "all_of_them"), [(1, False), pytest.param(4, True, marks=pytest.mark.slow)]
)
def test_killed_processes_leave_no_trace(study_of, injected, times, all_of_them):
    study = study_of(seconds=0.02)
    killer = Killer(times, 120, all_of_them)
    ds = compute(study, workers=2, chunk_rows=5, progress=killer)
    assert killer.marks == []
    injected("process of a worker killed", times)
    assert ds.identical(computed_here(study))


class Unlucky(isolation.Isolated):
    """A process that somebody kills twice while it computes."""

    kills = 2

    def _answer(self, connection, limit):
        if self.kills:
            self.kills -= 1
            self._process.kill()
        return super()._answer(connection, limit)


@pytest.mark.slow
def test_a_row_is_not_guilty_because_its_process_was_killed_twice(study_of, injected):
    study = study_of(seconds=0.2, samples=2)
    work = workload_of(study)
    process = Unlucky(isolation.spec_of(work))
    rows = work.block(0, 2)
    try:
        chunk = process.evaluate(rows.x, rows.seed)
    finally:
        process.close()
    injected("process of a worker killed", 2)
    assert chunk.status.tolist() == [Status.OK, Status.OK]
    assert np.array_equal(chunk.columns["y"], computed_here(study)["y"].values)


@pytest.mark.slow
def test_processes_that_cannot_live_end_the_run(study_of, injected):
    stop = threading.Event()

    def kill_on():
        while not stop.wait(0.05):
            for process in processes(CHILD):
                process.send_signal(signal.SIGKILL)

    injected("processes of workers killed again and again")
    thread = threading.Thread(target=kill_on)
    thread.start()
    try:
        with pytest.raises(RunError, match="a process for the rows could not start: Killed"):
            compute(study_of(seconds=0.5, samples=600), workers=1, chunk_rows=1)
    finally:
        stop.set()
        thread.join()


@pytest.mark.slow
def test_processes_that_cannot_start_end_the_run(study_of, monkeypatch, injected):
    study = study_of(seconds=0.01)
    monkeypatch.setenv("UQ_TEST_CHILDREN_END", "1")
    injected("workers that can start no process")
    with pytest.raises(RunError, match="a process for the rows could not start: exit code 3"):
        compute(study, workers=1, chunk_rows=20)


@pytest.mark.slow
def test_everything_listens_on_this_computer_alone(study_of):
    listening = set()

    def look(progress):
        assert progress.dashboard == ""  # none that would not answer
        for process in (psutil.Process(), *psutil.Process().children(recursive=True)):
            for connection in process.net_connections(kind="inet"):
                if connection.status == psutil.CONN_LISTEN:
                    listening.add(connection.laddr.ip)

    compute(study_of(seconds=0.02, samples=60), workers=2, chunk_rows=5, progress=look)
    assert listening == {"127.0.0.1"}
