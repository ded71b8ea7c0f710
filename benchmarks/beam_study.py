"""Complete lifetime studies of the beam: run time and error, and those of the alternatives.

For the paper's two cases, the second also at a small error: the wall time of the shipped lifetime
study to a depth of one initial gap, by the command a user types, on two worker processes; the error
of its lives, on rows computed again at the tightest settings, and how many of them are off by more
than the stated errors; and the core-milliseconds of a row compared with the paper's method, gaps
that grow in increments with settled work-rates at each, by the exact propagator and by Newmark's
method, each at its cheapest setting of equal accuracy.
"""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks import newmark
from benchmarks.figures import Figure, keep
from models.beam import MODEL, exact
from models.beam.parameters import REGIMES, Params, Settings
from tests.support.references.incremental import follow
from uq.study.definition import load_study
from uq.study.row_sampling import row_block

STUDIES = Path(__file__).parent.parent / "studies"
DEPTH = 2.5e-4  # [m], one initial gap
TIGHT = Settings(depths=(DEPTH,), accuracy=0.002)
CHECKED, RIVALLED, BLOCK = 50, 20, 512
# Study, its rows, the cheapest settings without failed rows, and the median error of its lives that
# is good enough.
CASES = (
    ("beam-lifetime-561", 1000, {"accuracy": 0.1, "steps_per_period": 128}, 0.02),
    ("beam-lifetime", 10_000, {"accuracy": 1.0, "steps_per_period": 64}, 0.01),
    ("beam-lifetime", 10_000, {"accuracy": 0.1, "steps_per_period": 64}, 0.0005),
)
# Increments, tolerance of settled work, blocks of 64 periods if unsettled: by cost.
WAYS = ((4, 1e-2, 8), (6, 1e-3, 16), (10, 1e-3, 32), (20, 1e-4, 64), (40, 1e-5, 128))
NEWMARK_STEPS = (500, 500, 1000, 1000, 2000)


def text_of(name, rows, settings):
    """Return the shipped study with other settings."""
    text = (STUDIES / f"{name}.toml").read_text().split("[settings]")[0]
    lines = [f"{key} = {value}" for key, value in {"depths": [DEPTH], **settings}.items()]
    return re.sub(r"samples = \d+", f"samples = {rows}", text) + "\n".join(["[settings]", *lines])


def wall_time(study, folder):
    """Return the run time of the complete command [s]."""
    command = [sys.executable, "-m", "uq", "run", study, "-o", folder / "out.nc"]
    began = time.perf_counter()
    subprocess.run([*command, "--workers", "2", "--quiet", "--fresh"], check=True)
    return time.perf_counter() - began


def by_rows(rows, settings, block=BLOCK):
    """Return the lives, their stated errors, the regimes and the core-seconds of a row."""
    lives, errors, regimes = [], [], []
    began = time.process_time()
    for first in range(0, len(rows.x), block):
        part = slice(first, first + block)
        outputs, _ = MODEL.batch(rows.x[part], rows.seed[part], settings)
        lives.append(outputs["first_time_to_depth"][:, 0])
        errors.append(outputs["first_time_to_depth_error"][:, 0])
        regimes.append(outputs["regime"])
    seconds = (time.process_time() - began) / len(rows.x)
    return np.concatenate(lives), np.concatenate(errors), np.concatenate(regimes), seconds


def by_increments(rows, way, propagator, steps):
    """Return the lives [s], and the core-seconds of a row."""
    increments, tolerance, blocks = way
    settings = Settings(propagator="exact") if steps == 0 else Settings(steps_per_period=steps)
    lives = np.empty(len(rows.x))
    began = time.process_time()
    for i, x in enumerate(rows.x):
        p = Params(*x)
        growths = [DEPTH / p.initial_gap]
        how = {"propagator": propagator, "tolerance": tolerance, "blocks": blocks, "most": 1.0}
        time_to, _, unit, *_ = follow(p, settings, growths, increments, **how)
        lives[i] = time_to[2, 0] * unit
    return lives, (time.process_time() - began) / len(rows.x)


def rival(name, rows, reference, goal, our_seconds, propagator, every_steps):
    """Print a rival's cheapest setting of equal accuracy, and return its cost relative to ours."""
    by_increments(rows._replace(x=rows.x[:1]), WAYS[0], propagator, every_steps[0])  # compiles
    for way, steps in zip(WAYS, every_steps, strict=True):
        lives, seconds = by_increments(rows, way, propagator, steps)
        off = np.median(np.abs(lives / reference - 1))
        if off <= goal:
            break
    label = f"{way[0]} increments" + (f", {steps} steps" if steps else "")
    verdict = "" if off <= goal else "  (not as good)"
    print(
        f"    {name:18s} {label:28s} {off:7.2%} {seconds * 1e3:10.1f} ms "
        f"{seconds / our_seconds:7.0f}{verdict}",
        flush=True,
    )
    return seconds / our_seconds


def report(name, count, settings, goal):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.toml"
        path.write_text(text_of(name, count, settings))
        study = load_study(path)
        rows = row_block(study, 0, count)
        by_rows(rows._replace(x=rows.x[:64], seed=rows.seed[:64]), study.settings)  # compiles
        print(f"{name}, {settings}: {count} rows in {wall_time(path, Path(folder)):.1f} s")
    checked = rows._replace(x=rows.x[:CHECKED], seed=rows.seed[:CHECKED])
    reference, _, _, _ = by_rows(checked, TIGHT)
    every, errors, regimes, our_seconds = by_rows(rows, study.settings)
    off = np.abs(every[:CHECKED] / reference - 1)
    print(
        f"  error of {CHECKED} lives: median {np.median(off):.2%}, mean {off.mean():.2%}, "
        f"ninth decile {np.quantile(off, 0.9):.2%}"
    )
    beyond = np.mean(off > errors[:CHECKED] / reference)
    reached = np.isfinite(errors)
    stated, asked = errors[reached] / every[reached], study.settings.accuracy
    print(
        f"  beyond the error stated: {beyond:.0%} of them; stated: median {np.median(stated):.2%}, "
        f"larger than the accuracy {np.mean(stated > asked):.0%}"
    )
    print(f"  core-milliseconds per row: {our_seconds * 1e3:.2f}; of each regime alone:")
    for code, regime in enumerate(REGIMES):
        mine = np.flatnonzero(regimes == code)
        if len(mine):
            part = rows._replace(x=rows.x[mine], seed=rows.seed[mine])
            each = by_rows(part, study.settings)[3] * 1e3
            print(f"    {regime:20s} {len(mine):5d} rows {each:8.2f}")
    rivalled = rows._replace(x=rows.x[:RIVALLED], seed=rows.seed[:RIVALLED])
    reference, off = reference[:RIVALLED], off[:RIVALLED]
    print(f"  a life of the first {RIVALLED} rows, to a median error of {100 * goal:g}%:")
    print(f"    {'accelerated wear':47s} {np.median(off):7.2%} {our_seconds * 1e3:10.1f} ms")
    ways = {"exact": (exact, (0,) * len(WAYS)), "Newmark": (newmark, NEWMARK_STEPS)}
    ratios = [
        rival(f"{way}, increments", rivalled, reference, goal, our_seconds, *ways[way])
        for way in ways
    ]
    task = f"a life of `{name}`, median error {100 * goal:g}%"
    peers = (f"gaps that grow in increments, {way}" for way in ("exact", "Newmark's method"))
    return [Figure(task, peer, ratio) for peer, ratio in zip(peers, ratios, strict=True)]


if __name__ == "__main__":
    keep("beam_study", [figure for case in CASES for figure in report(*case)])
