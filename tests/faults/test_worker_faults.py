"""Whatever happens to the processes that compute, the result is that of an undisturbed run."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import numpy as np
import psutil
import pytest
from in_memory import compute

from uq.contract import Status
from uq.errors import InputError
from uq.rows.evaluate import KernelError
from uq.rows.results import open_result
from uq.rows.workload import workload_of
from uq.running import isolation, local_cluster, sent_chunks
from uq.study.definition import load_study

COMMAND = Path(sys.executable).with_name("uq")
PATIENCE = 60.0
FAULTY = "faulty_models:FAULTY"


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


@pytest.fixture
def study_of(write_study):
    def make(model=FAULTY, samples=120, **settings):
        text = "\n".join(f"{key} = {value!r}" for key, value in settings.items())
        name = "linear" if model == "linear" else "faulty"
        law = 'distribution = "uniform", lower = 0.0, upper = 1.0'
        more = f"[settings]\n{text}"
        path = write_study(model=name, uncertain=("x1",), samples=samples, law=law, more=more)
        return load_study(path, None if model == "linear" else model)

    return make


@pytest.fixture
def undisturbed():
    """Return a function that computes a study with nothing that could go wrong."""
    return lambda study: compute(study, workers=0)


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
def test_killed_processes_leave_no_trace(
    study_of, undisturbed, injected, fault, module, times, all_of_them
):
    study = study_of(seconds=0.02)
    killer = Killer(module, times, 120, all_of_them)
    ds = compute(study, workers=2, chunk_rows=5, progress=killer)
    assert killer.marks == []
    injected(fault, times)
    assert ds.identical(undisturbed(study))


@pytest.mark.slow
def test_a_chunk_that_loses_three_workers_is_halved(study_of, undisturbed, monkeypatch, injected):
    study = study_of(seconds=0.1, samples=60)
    failed = []
    real = sent_chunks.SentChunks._failed
    monkeypatch.setattr(
        sent_chunks.SentChunks,
        "_failed",
        lambda self, sent, error: failed.append(type(error).__name__) or real(self, sent, error),
    )

    workers = partial(processes, WORKER)

    def kill_thrice():
        for _ in range(3):
            # A worker whose child is there is about to compute.
            wait_for(lambda: [w for w in workers() if processes(CHILD, w)])
            time.sleep(0.5)
            for worker in workers():
                worker.kill()
                worker.wait(PATIENCE)

    thread = threading.Thread(target=kill_thrice)
    thread.start()
    ds = compute(study, workers=1, chunk_rows=20)
    thread.join()
    assert "KilledWorker" in failed
    injected("worker killed three times on a chunk")
    assert ds.identical(undisturbed(study))


class Unlucky(isolation.Isolated):
    """A process that somebody kills twice while it computes."""

    kills = 2

    def _answer(self, connection, limit):
        if self.kills:
            self.kills -= 1
            self._process.kill()
        return super()._answer(connection, limit)


@pytest.mark.slow
def test_a_row_is_not_guilty_because_its_process_was_killed_twice(study_of, undisturbed, injected):
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
    assert np.array_equal(chunk.columns["y"], undisturbed(study)["y"].values)


FAULTS = {
    "raise": ("linear", {"fail_how": "raise"}, Status.RAISED, "x1 is above"),
    "nan": ("linear", {"fail_how": "nan"}, Status.NON_FINITE, "'y' is nan"),
    "inf": ("linear", {"fail_how": "inf"}, Status.NON_FINITE, "'y' is inf"),
    "shape": ("linear", {"fail_how": "shape"}, Status.BAD_SHAPE, "'y' has shape"),
    "exit": ("linear", {"fail_how": "exit"}, Status.CRASHED, "exit code 1"),
    "hang": ("linear", {"fail_how": "hang"}, Status.TIMED_OUT, "did not end within 0.5 s"),
    "segfault": (FAULTY, {"how": "segfault"}, Status.CRASHED, "Segmentation fault"),
    "killed": (FAULTY, {"how": "kill"}, Status.CRASHED, "Killed"),
}
QUICK = ("raise", "nan", "shape", "segfault", "hang")
"""One of each status."""


@pytest.mark.parametrize(
    ("fault", "workers"),
    [
        pytest.param(
            fault, workers, marks=[pytest.mark.slow] * (workers == 2 or fault not in QUICK)
        )
        for fault in FAULTS
        for workers in (None, 2)
    ],
)
def test_guilty_rows_get_their_status_and_the_others_their_values(
    study_of, undisturbed, monkeypatch, injected, fault, workers
):
    monkeypatch.setattr(isolation, "_FIRST_SECONDS", 0.5)
    model, settings, status, words = FAULTS[fault]
    key = "fail_above" if model == "linear" else "above"
    study = study_of(model, samples=100, **settings, **{key: 0.98})
    ds = compute(study, workers=workers, row_limit=0.5 if fault == "hang" else None, chunk_rows=30)
    guilty = ds["x1"].values > 0.98
    assert 0 < guilty.sum() < 5
    injected(f"row: {fault}", guilty.sum())
    assert np.array_equal(ds["status"].values, np.where(guilty, status, Status.OK))
    first = np.flatnonzero(guilty)[0]
    example = ds["status"].attrs[f"example_{status.name.lower()}"]
    assert example.startswith(f"row {first}: ")
    assert words in example
    sound = undisturbed(study_of(model, samples=100))
    assert np.array_equal(ds["y"].values[~guilty], sound["y"].values[~guilty])
    assert np.isnan(ds["y"].values[guilty]).all()


def test_a_wrong_dtype_refuses_the_model(study_of, injected):
    study = study_of(above=0.98, how="dtype")
    for workers in (0, 1):
        injected("row: dtype")
        with pytest.raises(KernelError, match="'y' is float32, expected float64"):
            compute(study, workers=workers, chunk_rows=10)


@pytest.mark.slow
def test_compiling_is_no_part_of_the_time_of_a_row(study_of, monkeypatch):
    monkeypatch.setattr(isolation, "_FIRST_SECONDS", 0.0)
    seconds = []
    real = isolation.Isolated._answer

    def timed(self, connection, limit):
        began = time.monotonic()
        answer = real(self, connection, limit)
        seconds.append(time.monotonic() - began)
        return answer

    monkeypatch.setattr(isolation.Isolated, "_answer", timed)
    ds = compute(study_of("faulty_models:COMPILING", samples=1), row_limit=1.0)
    assert ds["status"].values.tolist() == [Status.OK]
    assert max(seconds) > 1.0  # or this shows nothing


def test_a_time_limit_needs_a_process_to_stop(uq, study_of):
    study = study_of()
    with pytest.raises(InputError, match="needs another process"):
        compute(study, workers=0, row_limit=1.0)
    with pytest.raises(InputError, match="must be positive"):
        compute(study, row_limit=0.0)
    ended = uq("run", study.path, "--model", FAULTY, "--workers", 0, "--row-limit", 1)
    assert (ended.code, ended.err.count("\n")) == (2, 1)


def test_too_many_failed_rows_are_an_exit_code_after_the_result(uq, study_of, folder):
    study = study_of("linear", samples=20, fail_how="exit", fail_above=0.6)
    ended = uq("run", study.path, "--workers", 1)
    assert ended.code == 1
    assert "crashed" in ended.out
    assert "rows failed, more than max_failed = 0.1 allows (crashed: row " in ended.err
    assert (folder / "results" / "small.nc").exists()


@pytest.mark.slow
def test_processes_with_a_cold_cache_agree(study_of, folder, injected):
    model = "faulty_models:COMPILED"
    study = study_of(model, samples=20)
    environment = os.environ | {
        "XDG_CACHE_HOME": str(folder / "cache"),
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    environment.pop("NUMBA_CACHE_DIR", None)
    started = [
        subprocess.Popen(
            [COMMAND, "run", study.path, "-o", f"{i}.nc", "--model", model, "--quiet"],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for i in range(8)
    ]
    ended = [(*process.communicate(timeout=240), process.returncode) for process in started]
    assert [(err, code) for _, err, code in ended] == [("", 0)] * 8
    injected("cold numba cache, eight runs at once")
    results = [(folder / f"{i}.nc").read_bytes() for i in range(8)]
    assert len(set(results)) == 1
    assert list((folder / "cache").rglob("*.nbi"))


SURROUNDINGS = {
    "decimal comma": {"LC_ALL": "de_DE.UTF-8", "COLUMNS": "80"},
    "plain": {"LC_ALL": "C", "LANG": "C", "NO_COLOR": "1", "TERM": "dumb"},
}
COMMA = """
import locale
locale.setlocale(locale.LC_ALL, "")
assert format(1.5, "n") == "1,5"
"""


def with_decimal_comma(folder):
    """Return the environment of processes that all write 1,5, where such a locale can be made."""
    place, name = folder / "locale", SURROUNDINGS["decimal comma"]["LC_ALL"]
    place.mkdir()
    make = ["localedef", "-i", "de_DE", "-f", "UTF-8", place / name]
    if shutil.which("localedef") is None or subprocess.run(make, capture_output=True).returncode:
        return {}
    (place / "sitecustomize.py").write_text(COMMA)
    return {"LOCPATH": str(place), "PYTHONPATH": os.pathsep.join([str(place), *sys.path])}


@pytest.mark.slow
@pytest.mark.parametrize("surroundings", SURROUNDINGS)
def test_surroundings_change_no_bit(study_of, undisturbed, folder, injected, surroundings):
    study = study_of("linear", samples=40, fail_how="nan", fail_above=0.95)
    expected = undisturbed(study)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= SURROUNDINGS[surroundings]
    if surroundings == "decimal comma":
        comma = with_decimal_comma(folder)
        environment |= comma
        injected("decimal comma", bool(comma))
    ended = subprocess.run(
        [COMMAND, "run", study.path, "--workers", "1"],
        env=environment,
        stdin=None,
        # Closed standard input: not even /dev/null is there.
        preexec_fn=lambda: os.close(0),
        capture_output=True,
        timeout=PATIENCE,
    )
    injected("no terminal, no colours, closed standard input")
    assert ended.returncode == 0, ended.stderr
    assert b"Error" not in ended.stderr
    assert b"\x1b" not in ended.stdout + ended.stderr
    assert max(map(len, ended.stdout.decode().splitlines())) <= 80
    assert open_result(folder / "results" / "small.nc").identical(expected)


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
