"""Inputs of the beam that are uncertain unless a study says otherwise, and their laws."""

from collections.abc import Mapping
from typing import Any

# fmt: off
UNCERTAIN: Mapping[str, Mapping[str, Any]] = {
    "forcing_frequency": {
        "distribution": "normal", "mean": 57.1042, "sd": 0.1428,
        "source": "assumed: +-0.5 % as two standard deviations, drift of the excitation",
    },
    "contact_stiffness": {
        "distribution": "lognormal", "mean": 13750.0, "cv": 0.15,
        "source": "assumed: +-30 % as two standard deviations; the paper's value is itself "
        "inferred",
    },
    "initial_gap": {
        "distribution": "normal", "mean": 0.00025, "sd": 2.5e-05,
        "source": "assumed: +-20 % manufacturing tolerance of grid and cladding as two standard "
        "deviations",
    },
    "force_amplitude": {
        "distribution": "normal", "mean": 6.0, "sd": 0.45,
        "source": "assumed: +-15 % as two standard deviations; the force represents flow-induced "
        "excitation",
    },
    "rotational_support_stiffness": {
        "distribution": "normal", "mean": 535.0, "sd": 53.5,
        "source": "assumed: +-20 % as two standard deviations",
    },
    "lateral_support_stiffness": {
        "distribution": "lognormal", "median": 184000.0, "sigma": 0.3466,
        "source": "assumed: a factor of 2 as two standard deviations; values from 1.2e5 to 2.1e5 "
        "fit the paper",
    },
    "flexural_rigidity": {
        "distribution": "normal", "mean": 14.9, "sd": 0.3725,
        "source": "assumed: +-5 % as two standard deviations, pellet-cladding interaction",
    },
    "mass_per_length": {
        "distribution": "normal", "mean": 0.71, "sd": 0.0355,
        "source": "assumed: +-10 % as two standard deviations; the pellet density is assumed",
    },
    "mass_damping": {
        "distribution": "uniform", "lower": 1.0, "upper": 6.0,
        "source": "range that reproduces the paper's results equally well",
    },
    "stiffness_damping": {
        "distribution": "loguniform", "lower": 8e-06, "upper": 4e-05,
        "source": "wider than the range 1e-5 to 2.5e-5 that reproduces the paper's results equally "
        "well",
    },
    "wear_coefficient": {
        "distribution": "loguniform", "lower": 3e-15, "upper": 3e-14,
        "source": "assumed: a decade around 1e-14 m2/N; the paper keeps k symbolic",
    },
}
# fmt: on
"""Input -> its law in a new study, as in a study file."""
