"""What has become slower: ``make bench-quick``, in less than 90 seconds.

Each loop that decides how long a study takes is timed in turn with a yardstick, a fixed piece of
compiled arithmetic, and each command with the import of numba and xarray: ratios survive a busy
computer, times do not. They are compared with those that `benchmarks/quick.json` keeps for this
kind of processor; what takes longer by more than a tenth is listed, and the exit code is 1.
``--keep`` puts the ratios of this run in their place.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numba
import numpy as np

from benchmarks import children
from benchmarks.figures import machine
from benchmarks.startup import REFERENCE
from models import beam, mole, vibrator
from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from uq.study.definition import load_study
from uq.study.row_sampling import row_block

STUDIES = Path(__file__).parent.parent / "studies"
KEPT = Path(__file__).with_name("quick.json")
ALLOWED = 0.1
TURNS = 5
COMMAND_TURNS = 5
TURNS_OF_YARDSTICK = 2_000_000

# Model, study, rows.
LOOPS = {
    "lives of beam-lifetime": (beam.MODEL, "beam-lifetime", 128),
    "lives of beam-lifetime-561": (beam.MODEL, "beam-lifetime-561", 32),
    "angles of vibrator-tolerances": (vibrator.MODEL, "vibrator-tolerances", 512),
    "starts of vibrator-startup": (vibrator.MODEL, "vibrator-startup", 128),
    "rates of mole-progression": (mole.MODEL, "mole-progression", 128),
}


@numba.njit(error_model="numpy")
def _yardstick(w, turns):
    """Turn sixteen oscillators, a few operations at a time: what lanes do."""
    for _ in range(turns):
        for lane in range(LANES):
            x, v = w[lane], w[LANES + lane]
            a = fma(-0.3, v, -x) / fma(x, x, 2.0)
            v = fma(0.01, a, v)
            w[lane], w[LANES + lane] = fma(0.01, v, x), v


def loops() -> dict[str, Callable[[], object]]:
    """Return the loops by name, after a first call."""
    calls: dict[str, Callable[[], object]] = {}
    for name, (model, study_name, count) in LOOPS.items():
        study = load_study(STUDIES / f"{study_name}.toml")
        rows = row_block(study, 0, count)

        def compute(model=model, rows=rows, settings=study.settings):
            return model.batch(rows.x, rows.seed, settings)

        calls[name] = compute
    for compute in calls.values():
        compute()
    return calls


def loop_ratios() -> dict[str, float]:
    """Return the ratio of each loop's CPU time to that of the yardstick."""
    w = aligned(2 * LANES)
    w[:LANES] = 1.0
    calls = {"": lambda: _yardstick(w, TURNS_OF_YARDSTICK), **loops()}
    calls[""]()
    return _ratios({name: partial(_cpu_of, call) for name, call in calls.items()}, TURNS)


def _cpu_of(call: Callable[[], object]) -> float:
    began = time.process_time()
    call()
    return time.process_time() - began


def _ratios(runs: dict[str, Callable[[], float]], turns: int) -> dict[str, float]:
    """Return the ratios of CPU times to that of the run "", the least of some turns each."""
    best = dict.fromkeys(runs, np.inf)
    for _ in range(turns):  # by turns, so that a busy computer is unfair to none
        for name, run in runs.items():
            best[name] = min(best[name], run())
    unit = best.pop("")
    return {name: seconds / unit for name, seconds in best.items()}


def commands(folder: Path) -> dict[str, tuple[str, ...]]:
    """Return the commands by name; what they read is made here."""
    uq = (sys.executable, "-m", "uq")
    result = str(folder / "ishigami.nc")
    size = ("--samples", "2048", "--quiet", "-o", result)
    subprocess.run((*uq, "run", str(STUDIES / "ishigami.toml"), *size), check=True)
    return {
        "uq simulate beam": (*uq, "simulate", "beam"),
        "uq summary of 81,920 rows": (*uq, "summary", result),
        "uq sensitivity of 81,920 rows": (*uq, "sensitivity", result),
    }


def command_ratios() -> dict[str, float]:
    """Return the ratio of each command's CPU time to that of the import."""

    def cpu_of(command: tuple[str, ...]) -> float:
        return children.run(command, stdout=subprocess.DEVNULL).cpu

    with tempfile.TemporaryDirectory() as folder:
        rivals = {"": REFERENCE, **commands(Path(folder))}
        runs = {name: partial(cpu_of, command) for name, command in rivals.items()}
        return _ratios(runs, COMMAND_TURNS)


def report(ratios: dict[str, float], kept: dict[str, float]) -> list[str]:
    """Print the ratios beside those kept, and return the names of what has become slower."""
    slower = []
    print(f"{'':32}{'now':>8}{'kept':>8}   (times as long as the yardstick or the import)")
    for name, ratio in ratios.items():
        before = kept.get(name)
        change = "" if before is None else f"{ratio / before - 1:+8.0%}"
        print(f"{name:32}{ratio:8.2f}{'-' if before is None else f'{before:.2f}':>8}{change}")
        if before is not None and ratio > before * (1 + ALLOWED):
            slower.append(name)
    return slower


def main() -> int:
    """Measure, compare, and keep where asked to."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quick")
    parser.add_argument("--keep", action="store_true", help="keep the ratios of this run")
    asked = parser.parse_args()
    every = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    computer = machine().split(",")[0]
    ratios = loop_ratios() | command_ratios()
    slower = report(ratios, every.get(computer, {}))
    if asked.keep:
        every[computer] = {name: round(ratio, 3) for name, ratio in ratios.items()}
        KEPT.write_text(json.dumps(every, indent=1, sort_keys=True) + "\n")
        print(f"kept: {KEPT.name}")
        return 0
    if computer not in every:
        print(f"no ratios are kept for {computer}: keep these with --keep")
    if slower:
        print(f"slower by more than {ALLOWED:.0%}: {', '.join(slower)}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
