"""Pairs of results to compare."""

from computed import UNIFORM, computed, study_of

NARROW = {"distribution": "uniform", "lower": 0.3, "upper": 0.7, "source": "better made"}
FOUR = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)


def study(uncertain, more=None, **design):
    tables = {
        "study": {"name": "one", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 200} | design,
        "uncertain": uncertain,
        "analysis": {"thresholds": {"y": [4.0]}},
    }
    return computed(study_of(tables | (more or {})))
