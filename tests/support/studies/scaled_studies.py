"""Studies of lives of which some inputs are only a scale."""

from computed import study_of

from uq.assess.integrated_inputs import elements_with_laws, why_not_integrated
from uq.assess.weighted_mixture import WeightedMixture
from uq.result.elements import dependence_of, independent_rows
from uq.result.result import Result

NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}


def lognormal(sigma, median=1.0, **more):
    return {"distribution": "lognormal", "median": median, "sigma": sigma, **more}


def scaled_study(uncertain, design=None, samples=400, **tables):
    return study_of(
        {
            "study": {"name": "scaled", "model": "scaled"},
            "design": {"method": "monte-carlo", "samples": samples, "seed": 3} | (design or {}),
            "uncertain": uncertain,
            "analysis": {"outputs": ["life"], "thresholds": {"life": [1.0]}},
            **tables,
        },
        "sample_models:SCALED",
    )


def populated(ds):
    rows = independent_rows(ds)
    element = next(elements_with_laws(Result(rows), ["life"]))
    return WeightedMixture(element, dependence_of(rows)), why_not_integrated(Result(rows), element)


WHOLE = {"a": lognormal(0.5), "z": NORMAL}
