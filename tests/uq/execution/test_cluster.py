"""Worker processes compute the same bits, need no care, and leave nothing behind."""

import asyncio
import contextlib
import os
import re
import subprocess
import sys
import tempfile
import time
from types import SimpleNamespace

import numpy as np
import process_models
import psutil
import pytest
from distributed import LocalCluster
from in_memory import compute

import uq
from uq.errors import InputError
from uq.execution import clusters, dask_task, executor
from uq.execution.child import ModelSpec
from uq.execution.dask_task import evaluate_rows
from uq.execution.isolation import Children, spec_of
from uq.execution.workers import Workers
from uq.result.workload import workload_of
from uq.study import provenance
from uq.study.definition import load_study


def workers():
    """Return the living processes that compute for this one."""
    process_ids = set()
    for child in psutil.Process().children():
        with contextlib.suppress(psutil.NoSuchProcess):  # also one that is just ending
            if "uq.execution.child" in child.cmdline():
                process_ids.add(child)
    return process_ids


@contextlib.contextmanager
def cluster(**options):
    """Yield a cluster as somebody else may have started it."""
    how = {"processes": False, "protocol": "tcp://", "host": "127.0.0.1", "memory_limit": 0}
    with clusters.scratch(), LocalCluster(dashboard_address=None, **how, **options) as there:
        yield there


@pytest.fixture
def tidy(folder, monkeypatch):
    """Check that neither processes nor temporary files outlive the test."""
    temporary = folder / "temporary"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    yield
    assert not any(temporary.iterdir())
    assert not [place for place in sys.path if place.startswith(str(temporary))]
    assert not workers()


@pytest.mark.parametrize(
    ("model", "parameters", "workers"),
    [
        pytest.param("ishigami", ("x1", "x2", "x3"), 2, marks=pytest.mark.slow),
        ("sample_models:KINDS", ("x1",), 1),
    ],
)
def test_workers_give_the_bits_of_this_process(write_study, tidy, model, parameters, workers):
    path = write_study(method="saltelli", samples=128, replicates=2, uncertain=parameters)
    study = load_study(path, model)
    here = compute(study, workers=0)
    assert compute(study, workers=workers, chunk_rows=100).identical(here)


@pytest.mark.slow
def test_all_workers_work(write_study, tidy):
    study = load_study(write_study(uncertain=("x1",), samples=400), "process_models:PROCESS")
    ds = compute(study, workers=2, chunk_rows=2)
    assert len(set(ds["y"].values)) == 2
    assert float(os.getpid()) not in ds["y"].values


@pytest.mark.slow
def test_workers_have_the_environment_of_this_process(write_study, tidy, monkeypatch):
    monkeypatch.setenv("UQ_TEST", "1")
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "1")
    # Numba has read its settings: what the environment says now must not reach the workers.
    monkeypatch.setenv("NUMBA_CPU_FEATURES", "+sse2")
    monkeypatch.setattr(process_models.numba.config, "CACHE_DIR", "some folder")
    study = load_study(write_study(uncertain=("x1",)), "process_models:ENVIRONMENT")
    ds = compute(study, workers=1, chunk_rows=1)
    assert len(set(ds["y"].values)) == 1
    monkeypatch.setenv("UQ_TEST", "2")
    assert compute(study, workers=0)["y"].values[0] != ds["y"].values[0]


@pytest.mark.parametrize(
    ("seconds", "processes"), [(60.0, 1), pytest.param(0.1, 2, marks=pytest.mark.slow)]
)
def test_workers_are_started_for_longer_studies_only(
    write_study, tidy, monkeypatch, seconds, processes
):
    monkeypatch.setattr(executor, "CHUNK_SECONDS", 0.05)
    monkeypatch.setattr("uq.execution.executor.SHORT_SECONDS", seconds)
    monkeypatch.setattr("dask.system.CPU_COUNT", 2)
    path = write_study(uncertain=("x1",), samples=300, more="[settings]\nseconds = 0.01")
    ds = compute(load_study(path, "process_models:PROCESS"))
    assert len(set(ds["y"].values)) == processes


def test_workers_are_not_counted_for_every_chunk(write_study):
    counted = []
    client = SimpleNamespace(
        status="running", nthreads=lambda: counted.append(1) or {"a": 2}, loop=object()
    )
    crew = Workers(client, workload_of(load_study(write_study())))
    assert [crew.threads for _ in range(100)] == [2] * 100
    assert len(counted) < 100
    client.status = "closed"
    assert crew.threads == 0


@pytest.mark.slow
def test_an_existing_cluster_is_used(write_study, tidy):
    study = load_study(write_study(uncertain=("x1",), samples=100), "process_models:PROCESS")
    with cluster(n_workers=1, threads_per_worker=1) as there:
        ds = compute(study, scheduler=there.scheduler_address, chunk_rows=5)
    assert len(set(ds["y"].values)) == 2


@pytest.mark.slow
def test_a_cluster_that_cannot_help_is_named(write_study, monkeypatch):
    study = load_study(write_study())
    with monkeypatch.context() as hasty:
        hasty.setattr(clusters, "_REMOTE_SECONDS", 1)
        for address, why in (
            ("tcp://127.0.0.1:9", "cannot connect: .+"),
            ("nonsense://x", "not an address such as tcp://host:8786"),
        ):
            with pytest.raises(InputError, match=rf"^scheduler {address}: {why}$"):
                compute(study, scheduler=address)
    with cluster(n_workers=0) as empty:
        address = empty.scheduler_address
        with pytest.raises(InputError, match=rf"^scheduler {address}: .* no workers; "):
            compute(study, scheduler=address)


def test_other_versions_on_the_workers_are_refused_in_one_line(write_study, monkeypatch):
    study = load_study(write_study())
    other = provenance.versions() | {"numpy": "1.0", "Python": "2.7"}
    monkeypatch.setattr(clusters, "versions", lambda: other)
    with cluster(n_workers=1) as there:
        address = there.scheduler_address
        with pytest.raises(InputError) as refused:
            compute(study, scheduler=address)
    (line,) = refused.value.lines
    here = provenance.versions()
    assert re.fullmatch(
        rf"scheduler {address}: worker tcp://\S+ has Python {here['Python']}, numpy "
        rf"{here['numpy']}; this process has Python 2.7, numpy 1.0: install the same on both",
        line,
    )


def test_a_worker_that_differs_is_refused_with_its_first_rows():
    x, seed = np.full((2, 3), 0.5), np.zeros(2, np.uint64)
    with pytest.raises(InputError, match="computes rows has version 1 of model 'ishigami'.* has 2"):
        evaluate_rows(ModelSpec("ishigami", "2", ()), provenance.versions(), None, x, seed, 0)
    with pytest.raises(InputError, match="computes rows has other code of model 'ishigami' than"):
        evaluate_rows(
            ModelSpec("ishigami", "1", (), code="x"), provenance.versions(), None, x, seed, 0
        )
    later = provenance.versions() | {"vibrolife": "99"}
    with pytest.raises(InputError, match=r"^a worker has vibrolife \S+; this process has .* 99"):
        evaluate_rows(ModelSpec("ishigami", "1", ()), later, None, x, seed, 0)


@pytest.mark.slow
def test_rows_go_to_the_child_that_started_before_them(write_study, tidy):
    study = load_study(write_study(uncertain=("x1",)), "process_models:PROCESS")
    work = workload_of(study)
    rows, spec = work.block(0, 4), spec_of(work)
    children = Children()
    children.begin(1, spec)
    try:
        limit = time.monotonic() + 10
        while not workers() and time.monotonic() < limit:  # it has just been started
            time.sleep(0.01)
        (child,) = workers()
        with dask_task.named(children) as run:
            data = rows.x, rows.seed, 0, run
            chunk, _ = evaluate_rows(spec, provenance.versions(), None, *data)
    finally:
        children.close()
    assert set(chunk.columns["y"]) == {float(child.pid)}


@pytest.mark.slow
def test_a_script_needs_no_main_guard(write_study, folder):
    path = write_study(samples=200)
    temporary = folder / "temporary"
    temporary.mkdir()
    script = folder / "script.py"
    script.write_text(
        "print('once')\n"
        "import uq\n"
        f"ds = uq.run({str(path)!r}, 'out.nc', workers=2, chunk_rows=20)\n"
        "print(ds.sizes['row'])\n"
    )
    ended = subprocess.run(
        [sys.executable, script],
        capture_output=True,
        text=True,
        env=os.environ | {"TMPDIR": str(temporary)},
        timeout=60,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "once\n200\n", "")
    assert not any(temporary.iterdir())
    assert {entry.name for entry in folder.iterdir()} == {
        path.name,
        "out.nc",
        "script.py",
        "temporary",
    }


@pytest.mark.slow
def test_a_notebook_with_a_running_event_loop_can_use_workers(write_study, tidy):
    path = write_study(samples=200)

    async def cell():
        return uq.run(path, "out.nc", workers=1, chunk_rows=20)

    assert asyncio.run(cell()).identical(uq.open_result("out.nc"))


@pytest.mark.slow
def test_workers_end_with_their_parent(write_study, folder):
    path = write_study(samples=200)
    temporary = folder / "temporary"
    temporary.mkdir()
    program = (
        "import os, psutil, uq\n"
        "def end(progress):\n"
        "    if progress.done > 100:\n"
        "        print(*(one.pid for one in psutil.Process().children()), flush=True)\n"
        "        os.kill(os.getpid(), 9)\n"
        f"uq.run({str(path)!r}, 'out.nc', workers=2, chunk_rows=5, progress=end)\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env=os.environ | {"TMPDIR": str(temporary)},
        timeout=60,
    )
    started = [int(word) for word in ended.stdout.split()]
    assert len(started) == 2
    for worker in started:
        with contextlib.suppress(psutil.NoSuchProcess):
            psutil.Process(worker).wait(30)
        assert not psutil.pid_exists(worker)
    assert not any(temporary.iterdir())
