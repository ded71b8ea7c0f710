"""Studies of samples with several units and repeats."""

import numpy as np
from computed import UNIFORM, computed, once, study_of

LEVELS = {"x1": "shared", "x2": "own", "x3": "chance"}
SHARED, OWN, CHANCE = LEVELS.values()
VARIANCES = {SHARED: 1.0, OWN: 4.0, CHANCE: 9.0}
"""Of the linear function, in twelfths."""


def nested(levels=LEVELS, model=None, uncertain=None, analysis=None, **design):
    """Return a study of the linear function, or of a sample model, with an input on each level."""
    inputs = {name: UNIFORM | {"level": level} for name, level in levels.items()}
    table = {"method": "monte-carlo", "samples": 16, "units": 3, "repeats": 2, "seed": 5}
    tables = {
        "study": {"name": "nested", "model": "linear"},
        "design": table | design,
        "uncertain": inputs | (uncertain or {}),
        "analysis": analysis or {},
    }
    return study_of(tables, model)


@once
def nested_result(**options):
    """Return its result."""
    return computed(nested(**options))


def regimes(ds, codes):
    """Return a result with regimes."""
    attrs = {
        "role": "output",
        "kind": "category",
        "units": "1",
        "long_name": "regime",
        "may_be_undefined": 0,
        "flag_values": np.array([-1, 0, 1], np.int8),
        "flag_meanings": "none calm wild",
    }
    return ds.assign(regime=("row", np.asarray(codes, np.int8), attrs))
