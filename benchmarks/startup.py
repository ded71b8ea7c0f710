"""What commands take before and beside their arithmetic: ``python -m benchmarks.startup``.

CPU time, user and system, of complete commands in fresh processes with everything compiled, the
sources of Python too: the median of five, each beside the import of numba and xarray.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from subprocess import DEVNULL

from benchmarks import children
from benchmarks.figures import Figure, keep

REFERENCE = (sys.executable, "-c", "import numba, xarray")
REPEATS = 5
STUDIES = {"ishigami": "256", "exponential-wear": "10000"}  # 10,240 and 10,000 rows

FEW_ROWS = """
[study]
name = "few-rows"
model = "exponential-wear"
[design]
method = "monte-carlo"
samples = 1000
seed = 2026
[uncertain.rate]
distribution = "lognormal"
median = 2.5e-10
sigma = 0.5
"""


def commands(folder: Path) -> dict[str, tuple[str, ...]]:
    """Return the commands by name; what they read is made here."""
    uq = (sys.executable, "-m", "uq")
    by_name = {
        f"simulate {model}": (*uq, "simulate", model) for model in ("beam", "vibrator", "mole")
    }
    by_name["simulate ishigami"] = (*uq, "simulate", "ishigami")
    for name, samples in STUDIES.items():
        result = str(folder / f"{name}.nc")
        size = ("--samples", samples, "--quiet", "-o", result)
        subprocess.run((*uq, "run", f"studies/{name}.toml", *size), check=True)
        for verb in ("summary", "sensitivity"):
            by_name[f"{verb} {name}"] = (*uq, verb, result)
    study = folder / "few.toml"
    study.write_text(FEW_ROWS)
    for workers in ("0", "2"):
        options = ("-o", str(folder / "few.nc"), "--fresh", "--workers", workers)
        by_name[f"run, {workers} workers"] = (*uq, "run", str(study), *options)
    return by_name


def main() -> None:
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # as where users work
    with tempfile.TemporaryDirectory() as folder:
        rivals = commands(Path(folder))
        taken: dict[str, list[float]] = {name: [] for name in rivals}
        reference = []
        for command in rivals.values():  # compile
            children.run(command, stdout=DEVNULL, stderr=DEVNULL)
        for _ in range(REPEATS):
            reference.append(children.run(REFERENCE).cpu)
            for name, command in rivals.items():
                taken[name].append(children.run(command, stdout=DEVNULL).cpu)
    unit = median(reference)
    print(f"{'import numba, xarray':<32}{unit:6.2f} s")
    for name, seconds in taken.items():
        print(f"{name:<32}{median(seconds):6.2f} s {median(seconds) / unit:6.2f}")
    peer = "importing numba and xarray"
    keep(
        "startup",
        [
            Figure(f"CPU time of {_title(name)}", peer, median(seconds) / unit, longer=True)
            for name, seconds in taken.items()
        ],
    )


def _title(name: str) -> str:
    """Name a command as users know it."""
    verb, subject, *_ = name.split()
    if verb == "run,":
        return f"`uq run` of 1,000 rows that cost nothing, `--workers {subject}`"
    rows = "" if verb == "simulate" else ", 10,000 rows"
    return f"`uq {verb}` of `{subject}`{rows}"


if __name__ == "__main__":
    main()
