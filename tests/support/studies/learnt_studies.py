"""Studies of exponential wear whose posterior is known in closed form."""

import numpy as np
from computed import computed, study_of

RATE, DEPTH = (2.5e-10, 0.5), (2.5e-4, 0.3)
"""Median, and standard deviation of the logarithm."""


def lognormal(median, sigma, level="own"):
    return {"distribution": "lognormal", "median": median, "sigma": sigma, "level": level}


def wear(samples=6000, seed=3, rate="own", depth="own", analysis=None, dependence=None, **design):
    """Return a result: life = depth / rate, both lognormal."""
    asked = {"outputs": ["life"], "thresholds": {"life": [1e6]}}
    return computed(
        study_of(
            {
                "study": {"name": "wear", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": samples, "seed": seed} | design,
                "uncertain": {"rate": lognormal(*RATE, rate), "depth": lognormal(*DEPTH, depth)},
                "analysis": asked | (analysis or {}),
            }
            | ({"dependence": dependence} if dependence else {})
        )
    )


def measured(*lives, cv=0.1):
    """Return inspections of lives, each of a unit of its own: A, B, ..."""
    units = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    return [
        {"unit": unit, "output": "life", "kind": "measured", "value": life, "cv": cv}
        for unit, life in zip(units, lives, strict=False)
    ]


def exactly(lives, cv=0.1, shared_rate=False):
    """Return mean and covariance of the logarithms of rate and depths given measured lives.

    The first variables are the rates, one if it is shared, then the depths of the units.
    """
    n, m = len(lives), 1 if shared_rate else len(lives)
    mean = np.log([RATE[0]] * m + [DEPTH[0]] * n)
    cov = np.diag(np.square([RATE[1]] * m + [DEPTH[1]] * n))
    look = np.hstack([-np.ones((n, 1)) if shared_rate else -np.eye(n), np.eye(n)])
    gain = cov @ look.T @ np.linalg.inv(look @ cov @ look.T + np.log1p(cv**2) * np.eye(n))
    return mean + gain @ (np.log(lives) - look @ mean), cov - gain @ look @ cov
