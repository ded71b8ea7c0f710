"""What a second worker gains: ``python -m benchmarks.scaling [STUDY]``.

Whole commands with one worker and with two, by turns, on compiled code. CPU time says what workers
cost whatever else the computer does; the times of a busy computer mean little.
"""

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STUDY = "studies/beam-lifetime.toml"
WORKERS = (1, 2)
REPEAT = 3


def timed(study, workers, output):
    """Return the time and the CPU time of a whole run, all its processes together [s]."""
    options = ["-o", str(output), "--fresh", "--quiet", "--workers", str(workers)]
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, "-m", "uq", "run", study, *options], check=True)
    seconds, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(study=STUDY):
    """Print the times of a study, and their ratio to those of one worker."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "result.nc"
        timed(study, WORKERS[-1], output)  # compiles
        turns = [[timed(study, n, output) for n in WORKERS] for _ in range(REPEAT)]
    print(f"{study}, the whole command, best of {REPEAT}")
    best = [[min(times) for times in zip(*own, strict=True)] for own in zip(*turns, strict=True)]
    for workers, (seconds, cpu) in zip(WORKERS, best, strict=True):
        gain = best[0][0] / seconds
        print(f"  {workers} workers {seconds:7.1f} s {cpu:7.1f} s CPU {gain:6.2f} times as fast")


if __name__ == "__main__":
    main(*sys.argv[1:])
