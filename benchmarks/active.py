"""Rare events with few rows: ``python -m benchmarks.active``.

Coverage, rows and width of `uq rare-event --method active` beside its other methods, over seeds.
The event is that of four branches (Waarts 2000, k = 7), moved out until its probability is 1e-6,
which is an integral over a single variable; beside it a plane, a stair, a cliff without any slope
towards it, and a limit in six inputs.
"""

import argparse
import math
import time
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from scipy import integrate, optimize, stats

from benchmarks.coverage.problems import study_of, with_seed
from uq.contract import Model, Output, Parameter
from uq.errors import InputError
from uq.explore.rare_events import rare_event

RARE = 1e-6


def exact(shift):
    """Return the probability that any of four margins plus a shift is negative."""
    edge = 3.5 + shift / math.sqrt(2.0)  # of the two planes, in t = (x1 - x2) / sqrt(2)

    def density(t):
        return 2 * stats.norm.sf(3.0 + shift + 0.2 * t**2) * stats.norm.pdf(t)

    bends, _ = integrate.quad(density, -edge, edge, epsabs=0, epsrel=1e-10)
    return 2 * stats.norm.sf(edge) + bends


SHIFT = optimize.brentq(lambda shift: exact(shift) / RARE - 1, 0.0, 4.0)


@dataclass(frozen=True)
class Settings:
    """None."""


def _any(symbol):
    return Parameter(symbol, "1", "a number", (-100.0, 100.0), "definition of the problem")


Six = NamedTuple("Six", [(f"x{i}", Annotated[float, _any(f"x_{i}")]) for i in range(1, 7)])
Six._field_defaults = dict.fromkeys(Six._fields, 0.0)
Six.__new__.__defaults__ = (0.0,) * 6


def _batch(x, seed, settings):
    a, b = x[:, 0], x[:, 1]
    s, k = math.sqrt(2.0), 7.0
    bend = 3.0 + 0.1 * (a - b) ** 2
    limits = [(a + b) / s - bend, -(a + b) / s - bend, b - a - k / s, a - b - k / s]
    outputs = {f"branch{i}": limit for i, limit in enumerate(limits, 1)}
    outputs |= {
        "branches": np.max(limits, axis=0),
        "sum": (a + b) / s,
        "stair": np.floor(4.0 * (a + b) / s) / 4.0,
        "cliff": np.where(b < -4.0, 10.0, a),
        "total": x.sum(axis=1) / math.sqrt(6.0),
    }
    return outputs, np.zeros(len(x), np.int8)


NAMES = [f"branch{i}" for i in range(1, 5)] + ["branches", "sum", "stair", "cliff", "total"]
LIMITS = Model(
    "limits",
    "a known probability",
    "1",
    Six,
    Settings,
    {name: Output("1", "distance") for name in NAMES},
    _batch,
    block=64,
)

FOUR = {"any_of": [(f"branch{i}", SHIFT, "above") for i in range(1, 5)]}
EDGE = stats.norm.isf(RARE**0.5)
BOTH = {
    "all_of": [("sum", EDGE, "above"), ("branch3", math.sqrt(2) * EDGE - 7 / math.sqrt(2), "above")]
}
CLIFF = stats.norm.sf(4.0) + stats.norm.sf(5.0)
CASES = {
    "four branches": (2, {"output": "branches", "threshold": SHIFT}, RARE),
    "four branches, any of four limits": (2, FOUR, RARE),
    "corner, all of two limits": (2, BOTH, RARE),
    "plane of six inputs": (6, {"output": "total", "threshold": stats.norm.isf(RARE)}, RARE),
    "stair": (2, {"output": "stair", "threshold": 4.5}, stats.norm.sf(4.75)),
    "cliff of one of two inputs": (2, {"output": "cliff", "threshold": 5.0}, CLIFF),
    "cliff of one of six inputs": (6, {"output": "cliff", "threshold": 5.0}, CLIFF),
}
"""Problem -> its inputs, its event, and its probability."""


def counted(name, method, seeds, **options):
    """Return the line of a table: coverage of a method over seeds, rows and widths."""
    d, event, truth = CASES[name]
    laws = {f"x{i}": {"distribution": "normal", "mean": 0.0, "sd": 1.0} for i in range(1, d + 1)}
    study = study_of("monte-carlo", 64, model="benchmarks.active:LIMITS", laws=laws)
    covered, rows, ratios, values, begun = 0, [], [], [], time.perf_counter()
    for seed in range(seeds):
        try:
            ds = rare_event(with_seed(study, seed), method=method, workers=0, **event, **options)
        except InputError:
            continue
        low, high = float(ds["low"]), float(ds["high"])
        covered += low <= truth <= high
        rows.append(int(ds["rows"]))
        values.append(float(ds["probability"]))
        ratios.append(high / low if low else math.inf)
    if not rows:
        return f"| {name}, P = {truth:.2g} | {method} | none given | | | | | | |"
    interval = stats.binomtest(covered, len(rows)).proportion_ci()
    bias, scatter = np.mean(values) / truth - 1, np.std(values) / truth
    seconds = (time.perf_counter() - begun) / seeds
    return (
        f"| {name}, P = {truth:.2g} | {method} | {covered} of {len(rows)} ({interval.low:.0%} to"
        f" {interval.high:.0%}) | {np.median(rows):,.0f} | {max(rows):,} |"
        f" {np.median(ratios):.2f} | {bias:+.0%} | {scatter:.0%} | {seconds:.1f} s |"
    )


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--others", type=int, default=100, help="seeds of the other methods")
    parser.add_argument("--cases", default="", help="words that a case contains")
    asked = parser.parse_args()
    print(f"shift {SHIFT:.6f}, P = {exact(SHIFT):.6g}")
    print(
        "| event | method | covered | rows, median | most | high / low, median | bias | sd | time |"
    )
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name in CASES:
        if asked.cases in name:
            print(counted(name, "active", asked.seeds), flush=True)
            for method in ("subset", "importance"):
                if asked.others:
                    print(counted(name, method, asked.others), flush=True)


if __name__ == "__main__":
    main()
