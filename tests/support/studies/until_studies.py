"""Studies of runs that stop when they know enough."""

from computed import UNIFORM, study_of

INPUTS = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)
PAIR = dict.fromkeys(("x1", "x2"), UNIFORM)
WEAR = {
    "rate": {"distribution": "lognormal", "median": 1e-9, "sigma": 0.5},
    "depth": {"distribution": "lognormal", "median": 1e-3, "sigma": 0.3},
}

ESTIMATES = ("above", "below", "quantile", "b_life", "index", "input", "difference")


def tables(until, samples=4096, method="monte-carlo", replicates=1, settings=None):
    design = {"method": method, "samples": samples, "replicates": replicates, "until": until}
    return {
        "study": {"name": "until", "model": "linear"},
        "design": design,
        "uncertain": INPUTS,
        "settings": settings or {},
    }


def study(half_width, **more):
    estimate = {key: more.pop(key) for key in ESTIMATES if key in more}
    return study_of(tables({"output": "y", "half_width": half_width} | estimate, **more))


def wear(until, laws=WEAR, **more):
    given = tables({"output": "life", **until}, **more) | {"uncertain": laws}
    return study_of(given | {"study": {"name": "wear", "model": "exponential-wear"}})
