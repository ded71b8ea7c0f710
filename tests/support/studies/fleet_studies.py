"""Fleets on exponential wear: units share a rate, and each has a depth of its own."""

from itertools import combinations

import numpy as np
from computed import computed, once, study_of

OWN, SHARED = 0.4, 0.3


def lognormal(sigma, median, **more):
    return {"distribution": "lognormal", "median": median, "sigma": sigma, **more}


def fleet_study(units=1, samples=200, tables=(), design=(), **uncertain):
    inputs = {"rate": lognormal(SHARED, 1e-9, level="shared"), "depth": lognormal(OWN, 1e-3)}
    return study_of(
        {
            "study": {"name": "fleet", "model": "exponential-wear"},
            "design": {"method": "monte-carlo", "samples": samples, "units": units, "seed": 4}
            | dict(design),
            "uncertain": inputs | uncertain,
            "analysis": {"thresholds": {"life": [5e5]}},
            **dict(tables),
        }
    )


@once
def fleet_result(**options):
    return computed(fleet_study(**options))


LISTED = {"distribution": "discrete-choice", "values": [5e-4, 1e-3, 2e-3]}
"""A depth that cannot be integrated."""


def brute_force(ended, size, allow):
    """Return P(at most some ended), averaged over all fleets of one world."""
    shares = []
    for chosen in combinations(ended[np.isfinite(ended)], size):
        law = np.ones(1)
        for p in chosen:
            law = np.convolve(law, [1 - p, p])
        shares.append(law[: allow + 1].sum())
    return np.mean(shares) if shares else np.nan
