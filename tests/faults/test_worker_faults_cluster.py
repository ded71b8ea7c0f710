"""A cluster of somebody else: its scheduler and workers are processes of their own."""

import contextlib
import os
import socket
import subprocess
import sys
import time

import dask
import psutil
import pytest
from faulty_studies import PATIENCE, computed_here
from in_memory import compute
from killed_runs import until

from uq.errors import InputError, RunError
from uq.execution import clusters, runner
from uq.execution.workers import Workers


class Cluster:
    """A scheduler and workers, started by their own commands."""

    def __init__(self, folder, protocol="tcp", options=()):
        self.folder, self.options = folder, options
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.address = f"{protocol}://127.0.0.1:{port}"
        self.environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
        self.started = []
        self.scheduler = self._start(
            "distributed.cli.dask_scheduler",
            *("--host", self.address, "--no-dashboard", "--no-show"),
        )

    def add_worker(self):
        place = self.folder / f"worker{len(self.started)}"
        place.mkdir()
        return self._start(
            "distributed.cli.dask_worker",
            self.address,
            *("--nthreads", "1", "--no-dashboard", "--host", "127.0.0.1"),
            *("--local-directory", place),
        )

    def _start(self, module, *arguments):
        log = (self.folder / f"{len(self.started)}.log").open("wb")
        with log:
            process = subprocess.Popen(
                [sys.executable, "-m", module, *map(str, (*arguments, *self.options))],
                cwd=self.folder,
                env=self.environment,
                stdout=log,
                stderr=log,
            )
        self.started.append(process)
        return process

    def end(self, process=None):
        for stopped in [process] if process else self.started:
            with contextlib.suppress(psutil.NoSuchProcess):
                family = psutil.Process(stopped.pid).children(recursive=True)
                stopped.kill()
                for child in family:
                    with contextlib.suppress(psutil.NoSuchProcess):
                        child.kill()
            stopped.wait(PATIENCE)


@pytest.fixture
def start(folder):
    """Return a function that starts a cluster in a folder of its own."""
    clusters = []

    def call(workers=1, **options):
        place = folder / f"cluster{len(clusters)}"
        place.mkdir()
        clusters.append(Cluster(place, **options))
        for _ in range(workers):
            clusters[-1].add_worker()
        return clusters[-1]

    yield call
    for cluster in clusters:
        cluster.end()


@pytest.fixture
def study(study_of):
    return study_of(seconds=0.05, samples=100)


def patiently(address, *arguments, call=compute, **options):
    """Run on a cluster that may still be starting."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return call(*arguments, scheduler=address, **options)
        except InputError as error:
            if time.monotonic() > end or not (
                "connect" in str(error) or "no workers" in str(error)
            ):
                raise
            time.sleep(0.5)


def processes_of_rows(worker):
    """Return the processes in which a worker computes rows."""
    processes = []
    for process in psutil.Process(worker.pid).children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            if "uq.execution.child" in process.cmdline():
                processes.append(process)
    return processes


pytestmark = pytest.mark.slow


def test_workers_come_and_go(start, study, injected):
    there = start()
    seen = []

    def change(progress):
        seen.append(progress.done)
        if len(seen) == 3:
            there.add_worker()
        if len(seen) == 12:
            there.end(there.started[1])

    ds = patiently(there.address, study, chunk_rows=2, progress=change)
    injected("worker joins or leaves a cluster", 2)
    assert ds.identical(computed_here(study))
    assert there.scheduler.poll() is None


def test_a_chunk_that_loses_its_worker_too_often_is_halved(start, study_of, monkeypatch, injected):
    study = study_of(seconds=0.1, samples=60)
    failed = []
    failure, returned = Workers._failed, Workers.returned
    monkeypatch.setattr(
        Workers,
        "_failed",
        lambda self, sent, error: failed.append(type(error).__name__) or failure(self, sent, error),
    )
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "0")
    there = start()
    workers = [there.started[-1]]

    def kill_and_return(self):
        if workers:  # the first rows were computed here; now the worker has chunks
            until(lambda: processes_of_rows(workers[0]))
            there.end(workers.pop())
            there.add_worker()
        return returned(self)

    monkeypatch.setattr(Workers, "returned", kill_and_return)
    ds = patiently(there.address, study, chunk_rows=20)
    assert "KilledWorker" in failed
    injected("worker of a cluster killed too often with a chunk")
    assert ds.identical(computed_here(study))


def test_a_scheduler_that_dies_ends_the_run(start, study, folder, monkeypatch, injected):
    monkeypatch.setattr(clusters, "_REMOTE_SECONDS", 2)
    there = start()

    def kill(progress):
        if progress.done > 20:
            there.end(there.scheduler)

    with pytest.raises(RunError, match=rf"^scheduler {there.address}: the scheduler is gone$"):
        patiently(there.address, study, "out.nc", call=runner.run, chunk_rows=2, progress=kill)
    injected("scheduler killed")
    reports = []
    ds = runner.run(study, "out.nc", workers=0, progress=reports.append)
    assert reports[0].reused > 20
    assert ds.identical(computed_here(study))


def test_a_cluster_without_workers_ends_the_run(start, study, monkeypatch, injected):
    monkeypatch.setattr(clusters, "_WORKERLESS_SECONDS", 2.0)
    there = start()

    def kill(progress):
        if progress.done > 20:
            there.end(there.started[1])

    with pytest.raises(RunError, match="the cluster has had no workers for 2 s"):
        patiently(there.address, study, chunk_rows=2, progress=kill)
    injected("cluster loses its only worker")


def self_signed(stem):
    """Return the files of a new certificate and its key."""
    certificate, key = stem.with_suffix(".pem"), stem.with_suffix(".key")
    command = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=127.0.0.1".split()
    command += ["-keyout", key, "-out", certificate]
    subprocess.run(command, check=True, capture_output=True)
    return certificate, key


def tls(authority, certificate, key):
    """Return what a user's dask configuration says."""
    files = {"ca-file": authority, "client.cert": certificate, "client.key": key}
    return {f"distributed.comm.tls.{name}": str(path) for name, path in files.items()}


def test_certificates_are_used_and_demanded(start, study, folder):
    certificate, key = self_signed(folder / "ours")
    files = ("--tls-ca-file", certificate, "--tls-cert", certificate, "--tls-key", key)
    there = start(protocol="tls", options=files)
    with dask.config.set(tls(certificate, certificate, key)):
        ds = patiently(there.address, study, chunk_rows=10)
    assert ds.identical(computed_here(study))
    with pytest.raises(InputError, match=f"^scheduler {there.address}: .* certificates: set"):
        compute(study, scheduler=there.address)
    # Somebody with another certificate is refused.
    with (
        dask.config.set(tls(certificate, *self_signed(folder / "theirs"))),
        pytest.raises(InputError),
    ):
        compute(study, scheduler=there.address)


def test_workers_left_alone_keep_no_process(start, study):
    there = start()
    patiently(there.address, study, chunk_rows=10)
    assert not processes_of_rows(there.started[1])
