"""The beam: the fast propagator compared with Newmark's method at equal accuracy.

Prints, for the paper's two cases, the error of the work-rate and the time per forcing period and
row. Everything on one core, in one run.
"""

import time

import numpy as np

from benchmarks import newmark
from benchmarks.figures import Figure, keep
from models.beam import lanes
from models.beam.parameters import Params, Settings
from models.beam.structure.modal import beams
from models.numerics.blocks import LANES

KNOWN = {32.3591: (3.394367, 3.919359), 57.1042: (29.56878, 82.55679)}  # light, heavy site
TRANSIENT, PERIODS = 1500, 200


def clock(function, repeat=3):
    """Return the result and the best time of some calls [s], after one that compiles."""
    best = np.inf
    result = function()
    for _ in range(repeat):
        began = time.perf_counter()
        result = function()
        best = min(best, time.perf_counter() - began)
    return result, best


def nominal(frequency, n=1):
    fields = {**Params._field_defaults, "forcing_frequency": frequency}
    return Params._make(np.full(n, float(value)) for value in fields.values())


def error_of(rates, reference):
    return np.abs(np.sort(rates) / reference - 1).max()


def by_lanes(frequency, steps):
    n = LANES
    settings = Settings(steps_per_period=steps)
    b = beams(nominal(frequency, n), settings)
    ((_, system),) = lanes.groups(b, settings)
    to_rate = b.forcing[0] / b.frequency[0, 0] / (2 * np.pi)

    def run():
        state, gaps = lanes.start(system, np.zeros(n), np.zeros(n)), np.ones((n, 2))
        lanes.advance(system, state, gaps, np.zeros((n, 2)), TRANSIENT)
        return lanes.advance(system, state, gaps, np.zeros((n, 2)), PERIODS)

    record, seconds = clock(run)
    rates = record.work[0].mean(axis=0) * to_rate
    return error_of(rates, KNOWN[frequency]), seconds / n / (TRANSIENT + PERIODS), system.steps


def by_newmark(frequency, steps):
    b = beams(nominal(frequency), Settings())
    to_rate = b.forcing[0] / b.frequency[0, 0] / (2 * np.pi)
    system = newmark.System(b, steps)

    def run():
        state, gaps = newmark.start(system, 0.0, 0.0), np.ones((1, 2))
        newmark.advance(system, state, gaps, 0 * gaps, TRANSIENT)
        return newmark.advance(system, state, gaps, 0 * gaps, PERIODS)

    record, seconds = clock(run, repeat=1)
    rates = record.work[0].mean(axis=0) * to_rate
    return error_of(rates, KNOWN[frequency]), seconds / (TRANSIENT + PERIODS)


def work_rates():
    print("Work-rate: error of the worse site, and microseconds per forcing period and row")
    figures = []
    for frequency in KNOWN:
        print(f"  {frequency} Hz")
        for steps in (0, 96, 192, 400):
            error, seconds, used = by_lanes(frequency, steps)
            chosen = "chosen" if steps == 0 else "given"
            print(f"    lanes, {used:5d} steps {chosen:7s} {error:10.2e} {seconds * 1e6:9.2f}")
            if steps == 0:
                goal, fast = error, seconds
        for steps in (500, 1000, 2000, 4000):
            error, seconds = by_newmark(frequency, steps)
            print(f"    Newmark, {steps:5d} steps       {error:10.2e} {seconds * 1e6:9.2f}")
            if error <= goal:
                break
        print(f"    ratio at equal error: {seconds / fast:.0f}")
        task = f"a forcing period of the beam at {frequency} Hz, work-rate to {goal:.1g}"
        figures.append(Figure(task, "Newmark's method", seconds / fast))
    keep("beam", figures)


if __name__ == "__main__":
    work_rates()
