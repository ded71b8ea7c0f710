"""What a second worker gains: ``python -m benchmarks.scaling [STUDY]``.

Whole commands with one worker and with two, by turns, on compiled code. CPU time says what workers
cost whatever else the computer does; the times of a busy computer mean little.
"""

import sys
import tempfile
from pathlib import Path

from benchmarks import children
from benchmarks.figures import Figure, keep

STUDY = "studies/beam-lifetime.toml"
WORKERS = (1, 2)
REPEAT = 3


def timed(study, workers, output):
    """Return the time and the CPU time of a whole run, all its processes together [s]."""
    options = ["-o", str(output), "--fresh", "--quiet", "--workers", str(workers)]
    taken = children.run([sys.executable, "-m", "uq", "run", study, *options])
    return taken.seconds, taken.cpu


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
    if study == STUDY:
        rows = "6,000 rows of `beam-lifetime`, the whole command"
        keep("scaling", [Figure(f"{rows}, two processes", "one process", gain)])


if __name__ == "__main__":
    main(*sys.argv[1:])
