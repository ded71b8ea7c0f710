"""The cost of never losing a row: ``python -m benchmarks.store``.

Complete commands, with rows kept on disk as they arrive and with rows in memory until the end; and
the memory that many rows take.
"""

import contextlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil

from benchmarks.figures import Figure, keep

STUDY = """
[study]
name = "linear"
model = "linear"
[design]
method = "monte-carlo"
samples = 100_000
seed = 2026
[uncertain]
x1 = {distribution = "uniform", lower = 0.0, upper = 1.0}
x2 = {distribution = "uniform", lower = 0.0, upper = 1.0}
x3 = {distribution = "uniform", lower = 0.0, upper = 1.0}
x4 = {distribution = "uniform", lower = 0.0, upper = 1.0}
"""

IN_MEMORY = """
from uq.execution import runner
from uq.files import whole_files
from uq.cli import main
from uq.result.result_file import open_result
from uq.result.workload import workload_of

def run(study, output, options):
    ds = runner.carry_out(workload_of(study), options)
    whole_files.write_result(ds, output)
    return open_result(output)

runner.run_study = run
main()
"""

REPEAT = 7
ROWS = 10_000_000


def clock(command):
    """Return the time of a command [s]."""
    began = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - began


def overhead(study):
    """Print how much longer a run takes whose rows are kept on disk, and return it."""
    given = ["run", str(study), "--fresh", "-o"]
    kept = [sys.executable, "-m", "uq", *given, "kept.nc"]
    memory = [sys.executable, "-c", IN_MEMORY, *given, "memory.nc"]
    pairs = [(clock(kept), clock(memory)) for _ in range(REPEAT + 1)][1:]  # the first one warms up
    with_store, without = (min(times) for times in zip(*pairs, strict=True))
    print(f"100,000 rows of 'linear', the whole command, best of {REPEAT}")
    print(f"  rows kept on disk   {with_store:6.2f} s")
    print(f"  rows in memory      {without:6.2f} s")
    ratio = with_store / without
    print(f"  ratio               {ratio:6.2f}")
    return Figure("100,000 rows kept on disk as they arrive", "kept in memory", ratio, longer=True)


def memory(study):
    """Print the largest memory of a run of many rows, all of its processes together."""
    command = [sys.executable, "-m", "uq", "run", str(study), "-o", "many.nc", "--quiet"]
    began, most = time.perf_counter(), 0
    run = psutil.Popen([*command, "--samples", str(ROWS)])
    while run.poll() is None:
        most = max(most, _memory(run))
        time.sleep(0.1)
    assert run.returncode == 0
    print(f"{ROWS:,} rows of 'linear', all processes together")
    print(f"  largest memory      {most / 1e6:6.0f} MB")
    print(f"  time                {time.perf_counter() - began:6.0f} s")
    print(f"  result              {Path('many.nc').stat().st_size / 1e6:6.0f} MB")


def _memory(process):
    total = 0
    for member in (process, *process.children(recursive=True)):
        with contextlib.suppress(psutil.NoSuchProcess):  # it ended just now
            total += member.memory_info().rss
    return total


def main():
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        study = Path("linear.toml")
        study.write_text(STUDY)
        figure = overhead(study)
        memory(study)
    keep("store", [figure])


if __name__ == "__main__":
    main()
