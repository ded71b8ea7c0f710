"""Studies of runs that stop when they know enough."""

from computed import UNIFORM, study_of

INPUTS = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)

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
