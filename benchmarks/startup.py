"""What commands take before and beside their arithmetic: ``python -m benchmarks.startup``.

CPU time, user and system, of complete commands in fresh processes with everything compiled: the
median of five, each beside the import of numba and xarray.
"""

import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median

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


def cpu_seconds(command: Sequence[str]) -> float:
    """Return the CPU time of a command and its children [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def commands(folder: Path) -> dict[str, tuple[str, ...]]:
    """Return the commands by name; what they read is made here."""
    uq = (sys.executable, "-m", "uq")
    found = {
        f"simulate {model}": (*uq, "simulate", model) for model in ("beam", "vibrator", "mole")
    }
    found["simulate ishigami"] = (*uq, "simulate", "ishigami")
    for name, samples in STUDIES.items():
        result = str(folder / f"{name}.nc")
        size = ("--samples", samples, "--quiet", "-o", result)
        subprocess.run((*uq, "run", f"studies/{name}.toml", *size), check=True)
        for verb in ("summary", "sensitivity"):
            found[f"{verb} {name}"] = (*uq, verb, result)
    study = folder / "few.toml"
    study.write_text(FEW_ROWS)
    for workers in ("0", "2"):
        options = ("-o", str(folder / "few.nc"), "--fresh", "--workers", workers)
        found[f"run, {workers} workers"] = (*uq, "run", str(study), *options)
    return found


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        rivals = commands(Path(folder))
        taken: dict[str, list[float]] = {name: [] for name in rivals}
        reference = []
        for command in rivals.values():  # compile
            subprocess.run(
                command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
        for _ in range(REPEATS):
            reference.append(cpu_seconds(REFERENCE))
            for name, command in rivals.items():
                taken[name].append(cpu_seconds(command))
    unit = median(reference)
    print(f"{'import numba, xarray':<32}{unit:6.2f} s")
    for name, seconds in taken.items():
        print(f"{name:<32}{median(seconds):6.2f} s {median(seconds) / unit:6.2f}")


if __name__ == "__main__":
    main()
