"""What tests of sensitivity indices share: results, and the indices of them in plain data."""

import json

import numpy as np
from computed import computed, study_of

from uq.assess import sensitivities as estimation
from uq.assess.sensitivity_table import sensitivity_facts
from uq.indices.method import DesignSample
from uq.indices.methods import METHODS
from uq.result.result import Result

INPUTS = ("x1", "x2", "x3")


def ishigami(method="saltelli", samples=128, replicates=8, seed=1, **more_design):
    design = {"method": method, "samples": samples, "replicates": replicates, "seed": seed}
    law = {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}
    return computed(
        study_of(
            {
                "study": {"name": "ishigami", "model": "ishigami"},
                "design": design | more_design,
                "uncertain": dict.fromkeys(INPUTS, law),
            }
        )
    )


def sensitivities(ds, *asked, **more):
    """Return the indices of a result as ``uq sensitivity --json`` has them."""
    return sensitivity_facts(estimation.sensitivities(Result.of(ds), *asked, **more)).json


def indices(ds, method=None, output=None):
    """Return what is said of each output; JSON without any number that is not finite."""
    return json.loads(json.dumps(sensitivities(ds, method, output), allow_nan=False))


def values(entry, kind):
    return [index["value"] for index in entry[kind].values()]


def of_plain_sample(method, x, y, quantiles):
    """Return the indices by one method of an output of a plain sample."""
    return METHODS[method].indices(DesignSample.plain(y, x, quantiles=quantiles))
