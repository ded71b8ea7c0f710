"""What a second worker gains: ``python -m benchmarks.scaling [STUDY]``.

Whole commands with one worker and with two, by turns, on compiled code: of the study as it is,
whose rows take about as long as starting everything, and of eight times its rows. The times of a
busy computer mean little.
"""

import sys
import tempfile
from pathlib import Path

from benchmarks import children
from benchmarks.figures import Figure, keep
from uq import load_study

STUDY = "studies/beam-lifetime.toml"
TIMES = (1, 8)
WORKERS = (1, 2)
REPEAT = 3


def timed(study, samples, workers, output):
    """Return the time of a whole run [s]."""
    options = ["-o", str(output), "--fresh", "--quiet", "--workers", str(workers)]
    command = [sys.executable, "-m", "uq", "run", study, "--samples", str(samples), *options]
    return children.run(command).seconds


def main(study=STUDY):
    """Print the times of a study, and their ratio to those of one worker."""
    study_samples = load_study(study).design.samples
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "result.nc"
        timed(study, 256, WORKERS[-1], output)  # compiles
        for times in TIMES:
            samples = study_samples * times
            turns = [[timed(study, samples, n, output) for n in WORKERS] for _ in range(REPEAT)]
            best = [min(own_turns) for own_turns in zip(*turns, strict=True)]
            print(f"{study}, {samples:,} samples, the whole command, best of {REPEAT}")
            for workers, seconds in zip(WORKERS, best, strict=True):
                gain = best[0] / seconds
                print(f"  {workers} workers {seconds:7.1f} s {gain:6.2f} times as fast")
            rows = f"{samples:,} rows of `beam-lifetime`, the whole command"
            figures.append(Figure(f"{rows}, two processes", "one process", gain))
    if study == STUDY:
        keep("scaling", figures)


if __name__ == "__main__":
    main(*sys.argv[1:])
