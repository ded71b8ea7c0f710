"""Studies for screening, and what is found in them."""

from math import pi

import numpy as np
from asked_indices import sensitivities
from computed import study_of

A = np.array([0, 1, 4.5, 9, 99, 99, 99, 99.0])


def ishigami(method, samples, replicates=1, seed=0):
    return _of("ishigami", ("x1", "x2", "x3"), -pi, pi, method, samples, replicates, seed)


def g_function(method, samples, replicates=1, seed=0):
    names = tuple(f"x{i}" for i in range(1, 9))
    return _of("g-function", names, 0.0, 1.0, method, samples, replicates, seed)


def _of(model, names, lower, upper, method, samples, replicates, seed):
    law = {"distribution": "uniform", "lower": lower, "upper": upper}
    design = {"method": method, "samples": samples, "replicates": replicates, "seed": seed}
    tables = {"study": {"name": "a", "model": model}, "design": design}
    return study_of(tables | {"uncertain": dict.fromkeys(names, law)})


def index_entry(ds, output="y", method=None):
    return sensitivities(ds, method)["outputs"][output]
