"""Inputs of the mole that are uncertain unless a study says otherwise, and their laws."""

from collections.abc import Mapping
from typing import Any

# fmt: off
UNCERTAIN: Mapping[str, Mapping[str, Any]] = {
    "bar_friction": {
        "distribution": "truncated-normal", "mean": 0.295, "sd": 0.0295,
        "lower": 0.2, "upper": 0.39,
        "source": "assumed: +-20 % as two standard deviations; the paper fitted the value",
    },
    "mole_friction": {
        "distribution": "truncated-normal", "mean": 0.235, "sd": 0.017625,
        "lower": 0.17, "upper": 0.3,
        "source": "assumed: +-15 % as two standard deviations",
    },
    "contact_stiffness": {
        "distribution": "lognormal", "mean": 124000.0, "cv": 0.15,
        "source": "assumed: +-30 % as two standard deviations; the paper differentiated "
        "displacements twice",
    },
    "viscous_damping": {
        "distribution": "lognormal", "mean": 0.155, "cv": 0.25,
        "source": "assumed: +-50 % as two standard deviations; the paper fitted the value",
    },
    "spring_stiffness": {
        "distribution": "normal", "mean": 200.0, "sd": 10.0,
        "source": "assumed: +-10 % as two standard deviations",
    },
    "stop_gap": {
        "distribution": "normal", "mean": -0.002, "sd": 0.00025,
        "source": "assumed: +-0.5 mm as two standard deviations",
    },
    "spring_rest": {
        "distribution": "normal", "mean": -0.022, "sd": 0.0005,
        "source": "assumed: +-1 mm as two standard deviations",
    },
}
# fmt: on
"""Input -> its law in a new study, as in a study file."""
