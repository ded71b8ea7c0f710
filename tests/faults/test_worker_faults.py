"""Whatever happens to the processes that compute, the result is that of an undisturbed run."""

import signal
import threading
import time
from functools import partial

import numpy as np
import psutil
import pytest
from faulty_studies import PATIENCE, computed_here
from in_memory import compute

from uq.contract import Status
from uq.rows.workload import workload_of
from uq.running import isolation, local_cluster, sent_chunks


def processes(module, of=None):
    """Return the living processes, started by this one, that run a module."""
    found = []
    for child in (of or psutil.Process()).children(recursive=True):
        try:
            if module in child.cmdline() and child.status() != psutil.STATUS_ZOMBIE:
                found.append(child)
        except psutil.NoSuchProcess:
            pass
    return found


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


class Killer:
    """Kills processes as rows of a run arrive; called with the run's progress.

    Each time it waits for a worker that has begun to compute: there is something to lose.
    """

    def __init__(self, module, times, rows, all_of_them):
        self.module, self.all = module, all_of_them
        self.marks = [rows * (i + 1) // (times + 1) for i in range(times)]

    def __call__(self, progress):
        if not self.marks or progress.done < self.marks[0]:
            return
        self.marks.pop(0)
        wait_for(self._at_work)
        for process in self._at_work()[: None if self.all else 1]:
            process.kill()

    def _at_work(self):
        workers = {worker: processes(CHILD, worker) for worker in processes(WORKER)}
        if self.module == WORKER:
            return [worker for worker, children in workers.items() if children]
        return [child for children in workers.values() for child in children]


CHILD, WORKER = "uq.running.child", "uq.running.dask_worker"


@pytest.mark.parametrize(
    ("fault", "module", "times", "all_of_them"),
    [
        ("worker killed", WORKER, 1, False),
        pytest.param("all workers killed", WORKER, 2, True, marks=pytest.mark.slow),
        pytest.param("process of a worker killed", CHILD, 4, True, marks=pytest.mark.slow),
    ],
)
def test_killed_processes_leave_no_trace(study_of, injected, fault, module, times, all_of_them):
    study = study_of(seconds=0.02)
    killer = Killer(module, times, 120, all_of_them)
    ds = compute(study, workers=2, chunk_rows=5, progress=killer)
    assert killer.marks == []
    injected(fault, times)
    assert ds.identical(computed_here(study))


@pytest.mark.slow
def test_a_chunk_that_loses_three_workers_is_halved(study_of, monkeypatch, injected):
    study = study_of(seconds=0.1, samples=60)
    failed = []
    real = sent_chunks.SentChunks._failed
    monkeypatch.setattr(
        sent_chunks.SentChunks,
        "_failed",
        lambda self, sent, error: failed.append(type(error).__name__) or real(self, sent, error),
    )

    workers = partial(processes, WORKER)

    def kill_on():
        for _ in range(6):  # the first may have nothing to compute yet
            wait_for(lambda: [w for w in workers() if w.net_connections(kind="tcp")])
            time.sleep(1.0)
            if failed:
                return
            for worker in workers():
                worker.kill()
                wait_for(lambda worker=worker: worker not in workers())  # the run collects it

    thread = threading.Thread(target=kill_on)
    thread.start()
    try:
        ds = compute(study, workers=1, chunk_rows=20)
    finally:
        thread.join()
    assert "KilledWorker" in failed
    injected("worker killed three times on a chunk")
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
def test_workers_that_cannot_live_end_the_run(study_of, monkeypatch, injected):
    monkeypatch.setattr(local_cluster, "_DEATHS_AT_MOST", 3)
    stop = threading.Event()

    def kill_on():
        while not stop.wait(0.05):
            for process in processes("uq.running.dask_worker"):
                process.send_signal(signal.SIGKILL)

    injected("workers killed again and again")
    thread = threading.Thread(target=kill_on)
    thread.start()
    try:
        with pytest.raises(local_cluster.RunError, match="worker process"):
            compute(study_of(seconds=0.5, samples=600), workers=1, chunk_rows=1)
    finally:
        stop.set()
        thread.join()


@pytest.mark.slow
def test_workers_that_can_start_no_process_end_the_run(study_of, monkeypatch, injected):
    monkeypatch.setenv("UQ_TEST_WORKERS_CHILDREN_END", "1")
    said = "no worker could compute rows .*: a process for the rows could not start: exit code 3"
    injected("workers that can start no process")
    with pytest.raises(local_cluster.RunError, match=said):
        compute(study_of(seconds=0.01), workers=1, chunk_rows=20)


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
