"""Average effects of inputs: slopes of a regression whose truth is known."""

import numpy as np
from scipy import special

from benchmarks.coverage.tally import Tally
from uq.assess.effects import effects
from uq.stats.dependent_rows import INDEPENDENT, Dependence

ROWS = 400
SIGMAS = {"x": 0.3, "z": 0.1, "idle": 0.2}
CURVED = 0.8
"""Coefficient of the square of ln(x): the function is not linear in the logarithms."""

REPLICATES = 8


def average(repetitions):
    """Count the slopes of ln(y) = -2 ln(x) + 0.8 ln(x)^2 + ln(z) + noise.

    The inputs are lognormal with median 1, and the noise grows with x. The slopes of the closest
    linear function are then -2, 1 and 0.

    Parameters
    ----------
    repetitions : int

    Returns
    -------
    list of Line
    """
    truth = {"x": -2.0, "z": 1.0, "idle": 0.0}
    alone = Tally(f"average effects, {ROWS} independent rows")
    replicated = Tally(f"average effects, latin-hypercube, {REPLICATES} replicates")
    for seed in range(repetitions):
        rng = np.random.default_rng(seed)
        normal = rng.normal(size=(ROWS, len(SIGMAS)))
        _count(alone, truth, normal, INDEPENDENT, rng)
        replicates = Dependence(np.repeat(np.arange(REPLICATES), ROWS // REPLICATES))
        stratified = [_latin(ROWS // REPLICATES, rng) for _ in range(REPLICATES)]
        _count(replicated, truth, np.concatenate(stratified), replicates, rng)
    return [*alone.lines(), *replicated.lines()]


def _count(tally, truth, normal, dependence, rng):
    logs = dict(zip(SIGMAS, (normal * [*SIGMAS.values()]).T, strict=True))
    noise = 0.2 * np.exp(2 * logs["x"]) * rng.normal(size=len(normal))
    y = -2 * logs["x"] + CURVED * logs["x"] ** 2 + logs["z"] + noise
    fitted = effects(y, {name: np.exp(values) for name, values in logs.items()}, dependence)
    for name, slope in truth.items():
        tally.estimate(f"slope of {name}", slope, fitted[name].slope)


def _latin(rows, rng):
    """Return normal numbers, one in each of as many strata, shape (rows, d)."""
    strata = np.argsort(rng.random((len(SIGMAS), rows)), axis=1).T
    return special.ndtri((strata + rng.random(strata.shape)) / rows)
