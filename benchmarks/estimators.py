"""Estimators of Sobol' indices on the same rows: ``python -m benchmarks.estimators``.

Bias, error, width and coverage of each estimator of S1 and of ST, by the size of the index and the
tail of the output, from designs as `uq run` draws them. All see the same rows, standardised.
"""

import argparse
from typing import NamedTuple

import numpy as np

from uq.indices.index import S1, ST
from uq.indices.method import DesignSample
from uq.indices.sobol import first_order, sobol_indices, total_order
from uq.sampling.designs import DESIGNS
from uq.stats.quantile_functions import normal

D, REPLICATES = 4, 8
NAMES = ("x1", "x2", "x3", "x4")
SHARES = np.array([0.8, 0.15, 0.05, 0.0])
FACTORS = np.array([1.5, 1.0, 0.5, 0.0])
G_WEIGHTS = np.array([0.0, 1.0, 4.5, 99.0])


class Case(NamedTuple):
    """A function of four uniform inputs, with its indices."""

    function: object
    first: np.ndarray
    total: np.ndarray


def _additive(transform, spread=1.0):
    return Case(lambda u: spread * (transform(u) @ np.sqrt(SHARES)), SHARES, SHARES)


def _uniform(u):
    return np.sqrt(12) * (u - 0.5)


def _lognormal(sigma):
    parts, everything = np.expm1(sigma**2 * SHARES), np.expm1(sigma**2)
    rest = np.expm1(sigma**2 * (1 - SHARES))
    function = lambda u: np.exp(sigma * (normal(u) @ np.sqrt(SHARES)))  # noqa: E731
    return Case(function, parts / everything, 1 - rest / everything)


def _product(factors, transform=_uniform):
    """Return a product of 1 + factor times a function of each input, of mean 0 and variance 1."""
    everything = np.prod(1 + factors**2) - 1
    total = factors**2 * (everything + 1) / (1 + factors**2) / everything
    return Case(
        lambda u: np.prod(1 + factors * transform(u), axis=-1), factors**2 / everything, total
    )


def _far(case):
    return case._replace(function=lambda u: 1e3 + case.function(u))


CASES = {
    "light: sum of uniform inputs": _additive(_uniform),
    "normal: sum of normal inputs": _additive(normal),
    "the same, mean of 1000 sd": _far(_additive(normal)),
    "interactions: a product": _product(FACTORS),
    "interactions: the g-function": _product(
        1 / (np.sqrt(3) * (1 + G_WEIGHTS)), lambda u: np.sqrt(3) * (np.abs(4 * u - 2) - 1)
    ),
    "skewed: lognormal, sigma 0.7": _lognormal(0.7),
    "heavy: lognormal, sigma 1.2": _lognormal(1.2),
}


def saltelli(a, ab, b):
    """Return S1: Saltelli et al. (2010), Table 2 (b)."""
    return float(np.mean(b * (ab - a)) / np.var(np.r_[a, b]))


def janon(a, ab, b):
    """Return S1 with the moments of B and AB_i together: Janon et al. (2014)."""
    mean = (b.mean() + ab.mean()) / 2
    return float((np.mean(b * ab) - mean**2) / ((b**2 + ab**2).mean() / 2 - mean**2))


def martinez(a, ab, b):
    """Return S1 as a correlation: Martinez (2011)."""
    return float(np.corrcoef(b, ab)[0, 1])


ESTIMATORS = {
    S1: {"uq": first_order, "Saltelli": saltelli, "Janon": janon, "Martinez": martinez},
    ST: {
        "uq, Jansen": total_order,
        "Janon": lambda a, ab, b: 1 - janon(b, ab, a),
        "Martinez": lambda a, ab, b: 1 - martinez(b, ab, a),
        "with control": lambda a, ab, b: 1 - first_order(b, ab, a),
    },
}


def sample_of(case, samples, seed):
    """Return the rows of a design, with the output of a case."""
    sizes = {"seed": seed, "replicates": REPLICATES, "samples": samples}
    u = DESIGNS["saltelli"].unit_rows(d=D, second_order=False, start=0, stop=samples, **sizes)
    y = np.moveaxis(case.function(u), 1, 0)
    groups = np.arange(y.size).reshape(y.shape)
    return DesignSample(y.ravel(), {}, groups, ("A", *(f"AB_{name}" for name in NAMES), "B"))


def estimates(blocks, y):
    """Return the estimates: kind -> "name, estimator" -> index."""
    block = dict(zip(blocks, y.T, strict=True))
    a, b = block["A"], block["B"]
    return {
        kind: {
            f"{name}, {by}": estimator(a, block[f"AB_{name}"], b)
            for name in NAMES
            for by, estimator in estimators.items()
        }
        for kind, estimators in ESTIMATORS.items()
    }


def measured(case, samples, repetitions):
    """Return kind -> "name, estimator" -> value and interval of each repetition."""
    numbers = {kind: {} for kind in ESTIMATORS}
    for seed in range(repetitions):
        values = sobol_indices(sample_of(case, samples, seed), estimates).values
        for kind, by_label in values.items():
            for label, estimate in by_label.items():
                numbers[kind].setdefault(label, []).append(estimate.numbers)
    return numbers


def main():
    """Measure every case and print a table in Markdown."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimators")
    parser.add_argument("--repetitions", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=128, help="of each of 8 replicates")
    parser.add_argument("cases", nargs="*", help="words of their names")
    asked = parser.parse_args()
    for label, case in CASES.items():
        if asked.cases and not any(word in label for word in asked.cases):
            continue
        print(f"\n## {label}\n", flush=True)
        print("| index | truth | estimator | bias | error | width | covered |")
        print("| --- | --- | --- | --- | --- | --- | --- |")
        for kind, by_name in measured(case, asked.samples, asked.repetitions).items():
            truth = dict(zip(NAMES, case.first if kind is S1 else case.total, strict=True))
            for named, numbers in by_name.items():
                name, _, by = named.partition(", ")
                print(_line(f"{kind.key} {name}", truth[name], by, np.array(numbers)), flush=True)


def _line(label, truth, by, numbers):
    value, low, high = numbers.T
    finite = np.isfinite(low)
    bias, error = (value - truth).mean(), np.sqrt(((value - truth) ** 2).mean())
    width = np.median((high - low)[finite]) if finite.any() else np.nan
    covered = ((low <= truth) & (truth <= high))[finite].mean() if finite.any() else np.nan
    cells = (label, f"{truth:.3f}", by, f"{bias:+.4f}", f"{error:.4f}", f"{width:.4f}")
    return f"| {' | '.join(cells)} | {covered:.1%} |"


if __name__ == "__main__":
    main()
