"""Indices of a curve: of all its points together.

``front`` jumps by 3 where x1 + x2 exceeds an edge that falls with time, added to x1, fading, and
x3. ``worn``, r1 r2^t with lognormal rates, is a product.
"""

from functools import cache

import numpy as np

from benchmarks.coverage.problems import Inputs, Settings, indices_of, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.contract import Model, Output

TIMES = np.linspace(0.0, 3.5, 8)
EDGES, FADING, JUMP = 1.7 - 0.25 * TIMES, 2 * np.exp(-TIMES), 3.0

SIGMA, SPREAD = 0.3, 0.1
"""Standard deviations of the logarithms of r1 and r2."""

LAWS = {
    **dict.fromkeys(("x1", "x2", "x3"), {"distribution": "uniform", "lower": 0.0, "upper": 1.0}),
    "r1": {"distribution": "lognormal", "median": 1.0, "sigma": SIGMA},
    "r2": {"distribution": "lognormal", "median": 1.0, "sigma": SPREAD},
}
NAME = "benchmarks.coverage.whole:CURVES"


def _batch(x, seed, settings):
    x1, x2, x3, r1, r2, *_ = np.ascontiguousarray(x.T)[:, :, None]
    front = FADING * x1 + x3 + JUMP * (x1 + x2 > EDGES)
    return {"front": front, "worn": r1 * r2**TIMES}, np.zeros(len(x), np.int8)


CURVES = Model(
    "curves",
    "Curves with known answers",
    "1",
    Inputs,
    Settings,
    {
        "front": Output("1", "a front that passes", dims=("time",)),
        "worn": Output("1", "a depth that grows at an uncertain rate", dims=("time",)),
    },
    _batch,
    coordinates=lambda settings: {"time": TIMES},
    dimensions={"time": ("s", "time")},
    block=1024,
)


@cache
def truths():
    """Return the indices of both curves: output -> kind -> input -> index."""
    front, everything = _of_front()
    mean, of_square = (np.exp(k**2 * SIGMA**2 / 2) for k in (1, 2))
    means, of_squares = (np.exp(k**2 * (SPREAD * TIMES) ** 2 / 2) for k in (1, 2))
    first = {
        "r1": (of_square - mean**2) * means**2,
        "r2": mean**2 * (of_squares - means**2),
    }
    of_worn = of_square * of_squares - (mean * means) ** 2
    shared = of_worn - first["r1"] - first["r2"]
    worn = {
        "S1": first,
        "ST": {name: variance + shared for name, variance in first.items()},
        "shapley": {name: variance + shared / 2 for name, variance in first.items()},
    }
    return {"front": _shares(front, everything), "worn": _shares(worn, of_worn)}


def _of_front(n=1000):
    """Return parts and sum of the variance at each time, by the midpoint rule over x1 and x2."""
    mid = (np.arange(n) + 0.5) / n
    first = {name: np.empty(len(TIMES)) for name in ("x1", "x2")}
    both = np.empty(len(TIMES))
    for i, (edge, fading) in enumerate(zip(EDGES, FADING, strict=True)):
        upper = np.clip((mid[:, None] + mid - edge) * n + 0.5, 0.0, 1.0)  # share of each cell
        share, of_x1 = upper.mean(), fading * mid + JUMP * upper.mean(axis=1)
        first["x1"][i], first["x2"][i] = of_x1.var(), JUMP**2 * upper.mean(axis=0).var()
        together = 2 * JUMP * fading * (np.mean(mid * upper.mean(axis=1)) - share / 2)
        both[i] = fading**2 / 12 + JUMP**2 * share * (1 - share) + together
    shared, of_x3 = both - first["x1"] - first["x2"], np.full(len(TIMES), 1 / 12)
    parts = {
        kind: {name: variance + part * shared for name, variance in first.items()} | {"x3": of_x3}
        for kind, part in (("S1", 0), ("ST", 1), ("shapley", 0.5))
    }
    return parts, both + of_x3


def _shares(parts, variance):
    return {
        kind: {
            name: float(variances.sum() / variance.sum()) for name, variances in by_input.items()
        }
        for kind, by_input in parts.items()
    }


ROWS = {
    "saltelli": "8 replicates of 128 groups of 7 rows",
    "shapley": "512 paths of 6 rows",
}
KINDS = {"saltelli": ("S1", "ST"), "shapley": ("shapley",)}


def whole(method, repetitions):
    """Count the indices of all points together, by a design of `ROWS`."""
    sizes = (128, 8) if method == "saltelli" else (512, 1)
    study = study_of(method, *sizes, NAME, LAWS)
    tallies = {
        name: Tally(f"{words} at eight times, {method}, {ROWS[method]}", reasons)
        for name, words, reasons in (("front", "a front", {}), ("worn", "worn depth", REASONS))
    }
    for ds in repeated(study, repetitions):
        entries = indices_of(ds, output=[f"{name}[:]" for name in tallies])
        for name, tally in tallies.items():
            entry = entries[f"{name}[:]"]
            for kind in KINDS[method]:
                for label, truth in truths()[name][kind].items():
                    index = entry[kind][label] if kind in entry else {"low": None, "high": None}
                    tally.entry(f"{kind} {label}", truth, index)
    return [line for tally in tallies.values() for line in tally.lines()]


WIDENED = (
    "conservative: the variance rests on fewer than 50 rows of each replicate, so intervals are"
    " widened by the effect of one more such row"
)
REASONS = {"S1": WIDENED, "ST": WIDENED}
