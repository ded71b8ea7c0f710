"""What limits a run on a cluster: ``python -m benchmarks.cluster [SECTION]...``.

On loopback, with rows that cost nothing, of ten inputs and twenty outputs: the CPU time of driver,
scheduler and workers for a chunk and for a row, with few workers and with a thousand; the memory of
the driver, and of the analyses of its result, against the number of rows. `docs/scaling.md` shows
what follows from it.
"""

import asyncio
import contextlib
import json
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np
import psutil
from distributed import Client

from benchmarks import children
from benchmarks.coverage.problems import study_of
from benchmarks.large import INPUTS, LAWS, OUTPUTS, machine
from uq.execution import dask_task, resuming
from uq.execution.clusters import remote_workers
from uq.execution.environment import command, inherited
from uq.execution.executor import Dispatcher
from uq.execution.options import RunOptions
from uq.result.workload import workload_of
from uq.study.evaluate import evaluate

CHUNKS = {250: 200_000, 4000: 1_600_000}
"""Rows of a chunk -> rows of a run."""

CREWS = {8: 1, 200: 2}
"""Workers -> processes that they share."""

MOST_MEMORY = 8e9
"""A process that takes more is ended [bytes]."""

SIZES = (100_000, 1_000_000, 10_000_000)
"""Rows of the runs whose memory is measured."""


def _batch(x, seed, settings):
    outputs = {f"y{k}": x[:, k % INPUTS].copy() for k in range(OUTPUTS)}
    return outputs, np.zeros(len(x), np.int8)


FREE = machine("free", "rows that cost nothing", _batch)


def free_study(rows, method="monte-carlo"):
    """Return a study of about so many free rows; a crossed design has eight replicates."""
    samples, replicates = rows, 1
    if method == "saltelli":
        samples, replicates = 2 ** round(np.log2(rows / (8 * (INPUTS + 2)))), 8
    return study_of(method, samples, replicates, "benchmarks.cluster:FREE", LAWS)


# Scheduler and workers, each in processes of their own -------------------------------------------


class InWorker:
    """Rows computed in the worker itself, in place of `uq.execution.isolation.Isolated`."""

    def __init__(self, spec, limit):
        self.spec, self.limit = spec, limit
        self._loaded = spec.load()

    def start(self):
        """Do nothing: it is ready."""

    def evaluate(self, x, seed, start):
        """Compute some rows."""
        return evaluate(*self._loaded, x, seed, start)

    def close(self):
        """Do nothing: nothing is open."""


def serve(address, count):
    """Be `count` workers of one thread each in this process."""
    from distributed import Worker

    dask_task.Isolated = InWorker

    async def crew():
        workers = [Worker(address, nthreads=1, dashboard=False) for _ in range(count)]
        await asyncio.gather(*workers)
        await asyncio.gather(*(worker.finished() for worker in workers))

    asyncio.run(crew())


@contextlib.contextmanager
def cluster(workers, processes, folder):
    """Yield the address of a scheduler with so many workers, and all their processes."""
    file = Path(folder) / "scheduler.json"
    environment = inherited() | {"DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False"}
    with contextlib.ExitStack() as stack:

        def start(*arguments):
            process = psutil.Popen(
                command(*arguments), env=environment, stderr=subprocess.DEVNULL, cwd=folder
            )
            stack.callback(process.wait)
            stack.callback(process.kill)
            return process

        options = ("--host", "tcp://127.0.0.1", "--port", "0", "--no-dashboard")
        scheduler = start("distributed.cli.dask_scheduler", *options, "--scheduler-file", str(file))
        while not file.exists():
            time.sleep(0.1)
        address = str(json.loads(file.read_text())["address"])
        each = str(workers // processes)
        crew = [start("benchmarks.cluster", "serve", address, each) for _ in range(processes)]
        yield address, scheduler, crew


def used(*processes):
    """Return the CPU time of processes so far [s]."""
    return sum(sum(process.cpu_times()[:2]) for process in processes)


def costs(address, scheduler, crew, rows, chunk_rows, folder):
    """Run some rows; return the CPU time of driver, scheduler and workers [s], and the time."""
    study = free_study(rows)
    workload = workload_of(study)
    with (
        remote_workers(address, workload) as workers,
        resuming.keep(study, Path(folder) / "rates.nc", RunOptions(fresh=True)) as kept,
    ):
        options = RunOptions(chunk_rows=chunk_rows)
        dispatcher = Dispatcher(workload, options, kept, None)
        parts = [psutil.Process()], [scheduler], crew
        before, began = [used(*part) for part in parts], time.perf_counter()
        dispatcher.finish_on(workers)
        seconds = time.perf_counter() - began
        return np.subtract([used(*part) for part in parts], before), seconds


def rates():
    """Print what a chunk and a row cost each part of a cluster."""
    for workers, processes in CREWS.items():
        print(f"{workers} workers", flush=True)
        with (
            tempfile.TemporaryDirectory() as folder,
            cluster(workers, processes, folder) as members,
        ):
            with Client(members[0], set_as_default=False) as client:
                client.wait_for_workers(workers)
            costs(*members, 20_000, 250, folder)  # imports and first connections
            cpu_times = []
            for chunk_rows, rows in CHUNKS.items():
                cpu, seconds = costs(*members, rows, chunk_rows, folder)
                cpu_times.append(cpu)
                print(f"  {rows:,} rows, {chunk_rows} a chunk: {seconds:.1f} s", flush=True)
        counts = [(rows / chunk_rows, rows) for chunk_rows, rows in CHUNKS.items()]
        for part, (chunk, row) in zip(
            ("driver", "scheduler", "workers"), np.linalg.solve(counts, cpu_times).T, strict=True
        ):
            print(f"  {part:10} {chunk * 1e3:7.2f} ms a chunk {row * 1e6:7.2f} us a row")


# Memory against rows -----------------------------------------------------------------------------


def measured(title, arguments):
    """Print time and largest memory of one Python process."""
    most = 0
    with children.clocked() as taken:
        process = psutil.Popen([sys.executable, *arguments], stdout=subprocess.DEVNULL)
        while process.poll() is None:
            with contextlib.suppress(psutil.NoSuchProcess):
                most = max(most, process.memory_info().rss)
            if most > MOST_MEMORY:
                process.kill()
            time.sleep(0.05)
    outcome = "" if process.returncode == 0 else f"  ended with {process.returncode}"
    print(f"  {title:32} {taken.cpu:7.1f} s CPU {most / 1e6:7.0f} MB{outcome}", flush=True)


def drive(rows, method, path):
    """Compute a study of free rows in this process, kept on disk as they arrive."""
    study = free_study(int(rows), method)
    with resuming.keep(study, Path(path), RunOptions(fresh=True)) as kept:
        dispatcher = Dispatcher(
            workload_of(study), RunOptions(), kept, partial(evaluate, study.model, study.settings)
        )
        dispatcher.finish_here()
        print(f"{rows} rows kept: {time.process_time():.1f} s CPU", file=sys.stderr, flush=True)
        kept.dataset()


def memory():
    """Print time and memory of runs and of what is asked of their results."""
    with tempfile.TemporaryDirectory(dir=".") as folder:
        for rows in SIZES:
            print(f"{rows:,} rows", flush=True)
            plain, crossed = (str(Path(folder) / f"{name}.nc") for name in ("plain", "crossed"))
            here = "-m", "benchmarks.cluster", "drive", str(rows)
            measured("driver and merge", [*here, "monte-carlo", plain])
            measured("the same, crossed", [*here, "saltelli", crossed])
            measured("uq summary", ["-m", "uq", "summary", plain])
            measured("uq sensitivity", ["-m", "uq", "sensitivity", crossed])


SECTIONS = {"rates": rates, "memory": memory}


def main(chosen):
    """Print the chosen sections, or all."""
    for name in chosen or SECTIONS:
        SECTIONS[name]()


if __name__ == "__main__":
    if sys.argv[1:2] == ["serve"]:
        serve(sys.argv[2], int(sys.argv[3]))
    elif sys.argv[1:2] == ["drive"]:
        drive(*sys.argv[2:])
    else:
        main(sys.argv[1:])
