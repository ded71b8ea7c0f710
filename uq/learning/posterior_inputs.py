"""Prior and posterior of the inputs, and pairs of inputs correlated in the posterior."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uq.assess.row_inputs import inputs_of
from uq.assess.scale_laws import moments_of_input, posterior_input
from uq.contract import Floats
from uq.learning.importance import importance_of
from uq.learning.posterior_result import every_unit, prior_of
from uq.result.result import Result
from uq.result.weights import WEIGHT
from uq.sampling.levels import SHARED
from uq.stats.estimate import Estimate
from uq.stats.weighted_means import if_reliable, moments_of_rows

QUANTILES = (0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975)

CONFOUNDED = 0.3
"""Smallest reported rank correlation of a pair, in magnitude."""

_FEW_ROWS = "it depends on a few rows, and more hardly help; use the quantiles"


@dataclass(frozen=True)
class PosteriorMoments:
    """Mean, standard deviation and quantiles of an input.

    Attributes
    ----------
    mean, sd : Estimate
        For the posterior with confidence intervals for the sampling error; missing, with the
        reason, if Pareto k of weight times value, or times its square, is too large.
    quantiles : dict of float to float
    """

    mean: Estimate
    sd: Estimate
    quantiles: dict[float, float]


@dataclass(frozen=True)
class InputLearnt:
    """Prior and posterior moments of an input.

    Attributes
    ----------
    name : str
        Of an input that a unit has of its own: ``initial_gap[unit=A1]``.
    units : str
    prior, posterior : PosteriorMoments
    """

    name: str
    units: str
    prior: PosteriorMoments
    posterior: PosteriorMoments

    @property
    def unit(self) -> str:
        """Label of the unit that the input belongs to, "" for a shared input."""
        return self.name.partition("[unit=")[2].removesuffix("]")


@dataclass(frozen=True)
class Confounded:
    """Two inputs with correlated ranks in the posterior.

    Attributes
    ----------
    first, second : str
    correlation : float
        Of their ranks, given the inspections.
    """

    first: str
    second: str
    correlation: float


def inputs_learnt(result: Result) -> Iterator[InputLearnt]:
    """Yield the shared inputs of a posterior, then the inputs of each inspected unit."""
    levels, before = result.levels, prior_of(result)
    asked = tuple(sorted({*QUANTILES, *result.analysis.quantiles}))
    counted = importance_of(before)
    prior = {name: _before(before.dataset[name].values, counted, asked) for name in levels}
    for label, rows in every_unit(result):
        for name, level in levels.items():
            if (level == SHARED) == (label == ""):
                full_name = f"{name}[unit={label}]" if label else name
                units = str(result.dataset[name].attrs["units"])
                yield InputLearnt(full_name, units, prior[name], _after(rows, name, asked))


def confounded(result: Result) -> list[Confounded]:
    """Return the pairs of inputs correlated in the posterior, the most correlated first.

    Pairs of shared inputs and, for each inspected unit, pairs with an input of the unit.
    """
    levels, before = result.levels, prior_of(result)
    shared = [name for name, level in levels.items() if level == SHARED]
    pairs = []
    for label, rows in every_unit(result):
        names, wanted = (list(levels), {*levels} - {*shared}) if label else (shared, {*shared})
        pairs += _pairs(rows, before, names, wanted, label)
    return sorted(pairs, key=lambda pair: -abs(pair.correlation))


def _pairs(
    result: Result, before: Result, names: list[str], wanted: set[str], label: str
) -> list[Confounded]:
    """Return the correlated pairs with at least one requested input."""
    if len(names) < 2:
        return []
    after = _correlations(result, names, result.dataset[WEIGHT].values)
    first = _correlations(before, names, importance_of(before))
    called = {name: f"{name}[unit={label}]" if label and name in wanted else name for name in names}
    return [
        Confounded(called[name], called[other], float(after[i, j]))
        for i, name in enumerate(names)
        for j, other in enumerate(names[:i])
        if {name, other} & wanted and abs(after[i, j]) >= CONFOUNDED > abs(first[i, j])
    ]


def _correlations(rows: Result, names: list[str], weights: Floats) -> Floats:
    """Return the rank correlation matrix of inputs in weighted rows."""
    ranks = np.empty((len(names), len(rows)))
    for name, rank in zip(names, ranks, strict=True):
        order, share = _ascending(rows.dataset[name].values, weights)
        rank[order] = share
    with np.errstate(invalid="ignore", divide="ignore"):
        covariance = np.cov(ranks, aweights=weights)
        size = np.sqrt(np.diag(covariance))
        return np.asarray(covariance / np.outer(size, size))


def _ascending(values: Floats, weights: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the ascending order of values and their midpoint cumulative weights."""
    order = np.argsort(values, kind="stable")
    worth = weights[order] / weights.sum()
    return order, np.cumsum(worth) - worth / 2


def _before(values: Floats, weights: Floats, asked: tuple[float, ...]) -> PosteriorMoments:
    mean = float(np.average(values, weights=weights))
    sd = float(np.sqrt(np.average((values - mean) ** 2, weights=weights)))
    return PosteriorMoments(Estimate(mean), Estimate(sd), quantiles(values, weights, asked))


def _after(result: Result, name: str, asked: tuple[float, ...]) -> PosteriorMoments:
    values, weights = result.dataset[name].values, result.dataset[WEIGHT].values
    dependence, of_rows, within = result.dependence, values, np.zeros(len(values))
    if name == posterior_input(result):
        of_rows, within = moments_of_input(result, inputs_of(result))
    mean, sd = moments_of_rows(of_rows, weights, dependence, within)
    mean = if_reliable(mean, weights * of_rows, dependence, hopeless=_FEW_ROWS)
    sd = if_reliable(sd, weights * (of_rows**2 + within), dependence, hopeless=_FEW_ROWS)
    return PosteriorMoments(mean, sd, quantiles(values, weights, asked))


def quantiles(values: Floats, weights: Floats, asked: tuple[float, ...]) -> dict[float, float]:
    """Return weighted quantiles at the given probabilities."""
    order, share = _ascending(values, weights)
    return dict(zip(asked, np.interp(asked, share, values[order]).tolist(), strict=True))
