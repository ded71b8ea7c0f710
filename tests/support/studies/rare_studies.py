"""Studies whose rare events have known probabilities."""

import numpy as np
from computed import UNIFORM, study_of
from limit_states import PLANE

UNIFORMS = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)
LAST = 10.0 - 576e-6**0.25  # P(x1 + 2 x2 + 3 x3 + 4 x4 > 10 - h) = h^4/576 for h < 1
WEAR = {
    "rate": {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5},
    "depth": {"distribution": "lognormal", "median": 2.5e-4, "sigma": 0.2},
}


def study(model, inputs, **tables):
    names = {"branches": "limit_states:BRANCHES", "oscillator": "limit_states:OSCILLATOR"}
    tables = {"design": {"method": "monte-carlo", "samples": 64, "seed": 3}} | tables
    return study_of(
        {"study": {"name": "rare", "model": "linear"}, "uncertain": inputs, **tables},
        names.get(model, model),
    )


def branches(**tables):
    return study("branches", PLANE, **tables)


def linear(**tables):
    return study("linear", UNIFORMS, **tables)


def interval(ds):
    return float(ds["low"]), float(ds["high"])


def close(ds, truth):
    """Return whether the truth lies within twice the half-width: one seed is one draw."""
    low, high = np.log(interval(ds))
    return abs(np.log(truth) - (low + high) / 2) <= high - low
