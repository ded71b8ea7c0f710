"""Every 95 % interval of a Sobol' index holds the truth in 90 to 99 % of 200 repetitions.

``pytest -m slow -s tests/uq/indices/test_coverage_indices.py`` prints the table.
"""

from math import prod

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import UNIFORM, summarised
from coverage_tally import DEPTH, LIFE, LIMIT, RATE, SIGMA, SPREAD, WEAR, Tally, repeat, title
from scipy import stats

pytestmark = pytest.mark.slow


def tally_indices(tally, entry, truth, prefix=""):
    """Count indices of one output: truth is kind -> label -> index."""
    for kind, values in truth.items():
        for label, value in values.items():
            index = entry[kind][label]
            tally.add(f"{prefix}{kind} {label}", value, index["low"], index["high"])


ISHIGAMI = {
    "S1": {"x1": 0.3139, "x2": 0.4424, "x3": 0.0},
    "ST": {"x1": 0.5576, "x2": 0.4424, "x3": 0.2437},
}
PAIRS = {"S2": {"x1,x2": 0.0, "x1,x3": 0.2437, "x2,x3": 0.0}}


@pytest.mark.parametrize(("samples", "second_order"), [(128, True), (1024, False)])
def test_indices_of_ishigami(samples, second_order):
    law = {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}
    inputs, design = dict.fromkeys(("x1", "x2", "x3"), law), ("saltelli", samples, 8)
    tally = Tally(title("ishigami", design) + ", pairs" * second_order)
    for ds in repeat("ishigami", design, inputs, second_order=second_order):
        entry = sensitivities(ds)["outputs"]["y"]
        tally_indices(tally, entry, ISHIGAMI | (PAIRS if second_order else {}))
        tally.add("mean", 3.5, **summarised(ds)["outputs"]["y"]["mean_interval"])
    tally.check(conservative=("mean",))  # it allows for jumps that the rows cannot exclude


def test_indices_of_the_g_function():
    partial = {f"x{i}": 1 / (3 * (1 + a) ** 2) for i, a in enumerate((0, 1, 4.5, 9), start=1)}
    everything = prod(1 + v for v in (*partial.values(), *[1 / 30000] * 4))
    truth = {
        "S1": {name: v / (everything - 1) for name, v in partial.items()},
        "ST": {name: v / (1 + v) * everything / (everything - 1) for name, v in partial.items()},
    }
    inputs, design = {f"x{i}": UNIFORM for i in range(1, 9)}, ("saltelli", 256, 8)
    tally = Tally(title("g-function", design))
    for ds in repeat("g-function", design, inputs):
        tally_indices(tally, sensitivities(ds)["outputs"]["y"], truth)
    # Errors of a scrambled Sobol' sequence have a long tail on smooth functions.
    tally.check(conservative=("S1 x4",))


def test_indices_of_a_lifetime():
    design = ("saltelli", 256, 8)
    tally = Tally(title("wear", design))
    # The logarithm is a sum of two normal laws.
    whole = SIGMA**2 + SPREAD**2
    shares = {"rate": SIGMA**2 / whole, "depth": SPREAD**2 / whole}
    logarithm = {"S1": shares, "ST": shares}
    # The rate 1/life = rate/depth is a product of two lognormals.
    a, b = np.expm1(SIGMA**2), np.expm1(SPREAD**2)
    variance = (1 + a) * (1 + b) - 1
    truth = {
        "S1": {"rate": a / variance, "depth": b / variance},
        "ST": {"rate": a * (1 + b) / variance, "depth": b * (1 + a) / variance},
    }
    # P(life < t): variance of the event's probability when one input is known.
    share = LIFE.cdf(LIMIT)
    by = {
        "rate": _variance(lambda z: stats.norm.cdf((_limit() + SIGMA * z) / SPREAD)),
        "depth": _variance(lambda z: stats.norm.cdf((_limit() + SPREAD * z) / SIGMA)),
    }
    first = {name: v / (share * (1 - share)) for name, v in by.items()}
    event = {"S1": first, "ST": {"rate": 1 - first["depth"], "depth": 1 - first["rate"]}}
    for ds in repeat("exponential-wear", design, WEAR, analysis={"thresholds": {"life": LIMIT}}):
        outputs = sensitivities(ds)["outputs"]
        tally_indices(tally, outputs["log(life)"], logarithm, "logarithm: ")
        by_rate = sensitivities(ds, output="rate(life)")["outputs"]["rate(life)"]
        tally_indices(tally, by_rate, truth, "rate: ")
        tally_indices(tally, outputs[f"P(life<{LIMIT!r})"], event, "event: ")
    tally.check()


def _limit():
    return np.log(LIMIT * RATE / DEPTH)


def _variance(of_normal):
    z = stats.norm.ppf((np.arange(200_000) + 0.5) / 200_000)
    return of_normal(z).var()
