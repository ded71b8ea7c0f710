"""A random model: the shares of its inputs and of its noise, in closed form.

y = x1 + (1 + 2 x2) e, with inputs uniform on [0, 1] and e on [-1/2, 1/2], independent from seed to
seed. In units of 1/12 the variance is 16/3: 1 of x1, and 13/3 that remain once both inputs are
known. The interaction of e and x2 contributes 1/3.
"""

import numpy as np

from benchmarks.coverage.problems import Inputs, Settings, indices_of, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.contract import Model, Output

LAWS = dict.fromkeys(("x1", "x2"), {"distribution": "uniform", "lower": 0.0, "upper": 1.0})
NAME = "benchmarks.coverage.noise:NOISY"

TRUTH = {
    "S1": {"x1": 3 / 16, "x2": 0.0},
    "ST": {"x1": 3 / 16, "x2": 1 / 16},
    "S2": {"x1,x2": 0.0},
}
SHARE = 13 / 16
AT_ONE_SEED = {"x1": 3 / 4, "x2": 1 / 4}


def _batch(x, seed, settings):
    x1, x2 = np.ascontiguousarray(x.T)[:2]
    e = (seed >> np.uint64(11)) * 2.0**-53 - 0.5
    return {"y": x1 + (1 + 2 * x2) * e}, np.zeros(len(x), np.int8)


NOISY = Model(
    "noisy",
    "A random model with known answers",
    "1",
    Inputs,
    Settings,
    {"y": Output("1", "x1 and noise that grows with x2")},
    _batch,
    random=True,
    block=1024,
)


def noise(repetitions):
    """Count the Sobol' indices, the share of noise and the Shapley effects."""
    study = study_of("saltelli", 128, 8, NAME, LAWS, second_order=True)
    tally = Tally("random model, saltelli, 8 replicates of 128 groups of 7 rows", {})
    for ds in repeated(study, repetitions):
        entry = indices_of(ds)["y"]
        for kind, values in TRUTH.items():
            for label, truth in values.items():
                tally.entry(f"{kind} {label}", truth, entry[kind][label])
        tally.entry("noise", SHARE, entry["noise"])
    study = study_of("shapley", 512, model=NAME, laws=LAWS)
    paths = Tally("random model, shapley, 512 paths of 3 rows", {})
    for ds in repeated(study, repetitions):
        entry = indices_of(ds)["y"]
        for name, truth in AT_ONE_SEED.items():
            paths.entry(f"shapley {name}", truth, entry["shapley"][name])
    return tally.lines() + paths.lines()
