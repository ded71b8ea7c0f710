"""Distribution of the failure probability over shared inputs, without the noise of units."""

from collections.abc import Callable
from dataclasses import replace
from math import isfinite, isnan

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.stats.counting import mixing_bounds
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import effective_rows
from uq.stats.intervals import ROUNDING, share_interval
from uq.stats.weighted_means import EXACT, weighted_share

FEWEST_WORLDS = 20
"""Fewer do not show 5 and 95 % points."""

_CELLS = 200
_MARGIN = 3.0  # of the grid beyond the probits seen, where no world has all or none of its units
_FARTHEST = 8.0
_NARROWEST = 1.5  # the likelihood of n units is wider than sqrt(1.5 / n) on the scale of probits
_MOST_NODES = 41
_STEP = 1e-4
_STEPS = 100
_SETTLED = 1e-7

ASSUMES = (
    "that probits of the units' probabilities are about normal where noise hides their spread;"
    " intervals do not assume this"
)
FEW = f"{FEWEST_WORLDS} samples are required for points over shared inputs"
FEW_ENDED = f"fewer than {FEWEST_WORLDS} units have ended, or not ended, by then"
REPEATED = "samples share one of a few values, with no points between: study each of them alone"
NO_SPREAD = "samples do not differ by more than the noise of their units"
ONE_UNIT = "one unit per sample cannot separate shared inputs from differences between units"

Exceeding = Callable[[float], Estimate]
"""Probability -> the share of worlds in which a unit has a larger one."""


def noise_free(
    ended: Floats, nodes: Floats, dependence: Dependence, weights: Floats | None
) -> Exceeding:
    """Return the share of worlds with larger probabilities, which are known without noise.

    Parameters
    ----------
    ended : ndarray, shape (samples, nodes)
        Falling along nodes.
    nodes : ndarray, shape (nodes,)
        Standard normal quantiles of integrated shared inputs; a single one if there are none.
    dependence : Dependence
        Of the samples.
    weights : ndarray, shape (samples,), or None

    Returns
    -------
    callable
    """
    labels = dependence.labels

    def of_one_node(probability: float) -> Estimate:
        hits = ended[:, 0] > probability
        if weights is not None:
            return _mean(hits.astype(float), dependence, weights)
        low, high = share_interval(hits, dependence)
        if isnan(low) and labels is not None and np.ptp(labels) > 0:  # replicates agree
            low, high = share_interval(hits)
        return Estimate(float(hits.mean()), low, high)

    def exceeding(probability: float) -> Estimate:
        z, level = _probit(ended), _probit(probability)
        count = (z > level).sum(axis=1)
        after = np.clip(count, 1, len(nodes) - 1)
        row = np.arange(len(z))
        above, below = z[row, after - 1], z[row, after]
        gap = np.where(above > below, above - below, 1.0)
        at = nodes[after - 1] + np.clip((above - level) / gap, 0, 1) * (nodes[1] - nodes[0])
        share = np.where(count == 0, 0.0, np.where(count == len(nodes), 1.0, special.ndtr(at)))
        return _mean(share, dependence, weights)

    return of_one_node if len(nodes) == 1 else exceeding


def certain(ended: Floats, dependence: Dependence, weights: Floats | None) -> Exceeding:
    """Return the share of worlds with larger probabilities, where all units end together.

    Parameters
    ----------
    ended : ndarray, shape (samples,)
        Probability that the units of a sample have ended, over the integrated shared inputs.
    dependence : Dependence
        Of the samples.
    weights : ndarray, shape (samples,), or None

    Returns
    -------
    callable
    """
    share = _mean(ended, dependence, weights)
    return lambda probability: share


def _mean(share: Floats, dependence: Dependence, weights: Floats | None) -> Estimate:
    estimate = weighted_share(share, weights, dependence)
    alike = estimate.reason == EXACT
    return Estimate(estimate.value, estimate.value, estimate.value) if alike else estimate


class DeconvolvedProbability:
    """Distribution over worlds of a probability that is estimated from several units of each.

    Its law is normal on the scale of probits [1]_, fitted by maximum likelihood to the numbers of
    units that ended, as if these were binomial with as many units as give the scatter seen within
    worlds. The mean of the worlds' posteriors under this law replaces it [2]_: with little noise it
    is that of the worlds, whatever their law. The interval covers the error of the fit, and what
    the counts allow whatever the law (`mixing_bounds`).

    Parameters
    ----------
    ended : ndarray, shape (samples, units, nodes)
        NaN for units that do not take part.
    weights : ndarray, shape (nodes,)
    dependence : Dependence
        Of the samples.
    of_worlds : ndarray, shape (samples,), or None
        Their weights.

    References
    ----------
    .. [1] B. Efron, "Empirical Bayes deconvolution estimates", Biometrika 103, 1-20 (2016).
    .. [2] N. M. Laird, T. A. Louis, "Smoothing the non-parametric estimate of a prior distribution
       by roughening", Comput. Stat. Data Anal. 12, 27-37 (1991).
    """

    def __init__(
        self,
        ended: Floats,
        weights: Floats,
        dependence: Dependence,
        of_worlds: Floats | None = None,
    ):
        thinned = slice(None, None, -(-len(weights) // _MOST_NODES))  # the likelihood is smooth
        ended, weights = ended[..., thinned], weights[thinned] / weights[thinned].sum()
        units = np.isfinite(ended).sum(axis=1)
        worth = np.ones(len(ended)) if of_worlds is None else of_worlds
        kept = (units > 1).all(axis=1) & (worth > 0)
        effective = effective_rows(worth[kept])
        self.refusal = "" if effective >= FEWEST_WORLDS * (1 - ROUNDING) else FEW
        if ended.shape[1] == 1:
            self.refusal = ONE_UNIT
        if self.refusal:
            return
        self._dependence = dependence[kept]
        ended, units = ended[kept], units[kept].astype(float)
        self._worth = worth = worth[kept] / worth[kept].mean()
        self._weights = weights
        mean = np.nanmean(ended, axis=1)
        within = np.nanvar(ended, axis=1, ddof=1)
        binomial = worth @ (mean - mean**2 + within / units) @ weights / len(worth)
        noise = worth @ within @ weights / len(worth)
        hits, total = worth @ (mean * units) @ weights, worth @ units @ weights
        if min(hits, total - hits) * effective / len(worth) < FEWEST_WORLDS:
            self.refusal = FEW_ENDED
            return
        size = units * (binomial / max(noise, 1e-12) if binomial > 0 else 1.0)
        seen = _probit((mean * size + 0.5) / (size + 1))
        low = max(float(seen.min()) - _MARGIN, -_FARTHEST) if mean.min() > 0 else -_FARTHEST
        high = min(float(seen.max()) + _MARGIN, _FARTHEST) if mean.max() < 1 else _FARTHEST
        self._z = np.linspace(low, high, _CELLS)
        self._cell = self._z[1] - self._z[0]
        is_counted = bool(np.isin(ended, (0.0, 1.0)).all(where=np.isfinite(ended)))
        points = special.ndtr(self._z)
        of_counts = units if is_counted else size
        self._bounds = mixing_bounds(
            points, mean, of_counts, weights, worth, self._dependence, is_counted
        )
        size = np.minimum(size, _NARROWEST / self._cell**2)
        counts = np.stack([(mean * size).ravel(), ((1 - mean) * size).ravel()], axis=1)
        counts, place = np.unique(counts, axis=0, return_inverse=True)
        self._place = place.reshape(mean.shape)
        self._share = np.bincount(place.ravel(), np.outer(worth, weights).ravel()) / len(mean)
        logs = counts @ special.log_ndtr([self._z, -self._z])
        self._likelihood = np.exp(logs - logs.max(axis=1, keepdims=True))
        spread = np.sqrt(max(float(seen.var()) - _NARROWEST / float(size.mean()), 0.01))
        self._fit(np.array([float(seen.mean()), np.log(spread)]))

    def __call__(self, probability: float) -> Estimate:
        """Return the share of worlds in which the probability of a unit is larger."""
        if self.refusal:
            return Estimate(reason=self.refusal)
        level = float(_probit(probability))
        above = np.clip((self._z - level) / self._cell + 0.5, 0.0, 1.0)
        expected = self._posterior @ above
        slopes = self._posterior @ (above * self._statistics).T - expected[:, None] * self._given
        of_worlds = expected[self._place] @ self._weights + self._influences @ (
            self._share @ slopes
        )
        estimate = weighted_share(of_worlds, self._worth, self._dependence, hits=[])
        if not isfinite(estimate.low):
            estimate = replace(estimate, low=estimate.value, high=estimate.value)
        least, most = self._bounds(probability)
        low, high = min(estimate.low, least), max(estimate.high, most)
        return replace(estimate, low=low, high=high, assumes=ASSUMES)

    def _fit(self, parameters: Floats) -> None:
        """Fit the law, by steps from the scatter of the scores that never increase the loss."""
        narrow, wide = np.log(2 * self._cell), np.log(_FARTHEST)
        ends = np.array([[self._z[0], narrow], [self._z[-1], wide]])
        loss, scores = self._loss(parameters), self._scores(parameters)
        for _ in range(_STEPS):
            slope = self._share @ scores
            scatter = scores.T @ (self._share[:, None] * scores) + 1e-12 * np.eye(2)
            step = np.linalg.solve(scatter, slope)
            while np.abs(step).max() > _SETTLED:
                trial = np.clip(parameters + step, *ends)
                if (reached := self._loss(trial)) < loss:
                    break
                step /= 4
            else:
                break
            parameters, loss, scores = trial, reached, self._scores(trial)
        if parameters[1] <= narrow + _STEP:
            self.refusal = NO_SPREAD
            return
        curvature = np.stack(
            [
                self._share @ (self._scores(parameters - step) - self._scores(parameters + step))
                for step in _STEP * np.eye(2)
            ]
        ) / (2 * _STEP)
        scores = np.einsum("snk,n->sk", self._scores(parameters)[self._place], self._weights)
        self._influences = np.linalg.solve((curvature + curvature.T) / 2, scores.T).T
        prior, self._statistics = self._prior(parameters)
        joint = self._likelihood * prior
        self._posterior = joint / joint.sum(axis=1, keepdims=True)
        self._given = self._posterior @ self._statistics.T

    def _prior(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Return the law at the grid, and its derivatives but for constants, shape (2, cells)."""
        mean, sd = parameters[0], np.exp(parameters[1])
        u = (self._z - mean) / sd
        density = np.exp(-(u**2) / 2)
        return density / density.sum(), np.stack([u / sd, u**2])

    def _loss(self, parameters: Floats) -> float:
        prior, _ = self._prior(parameters)
        return -float(self._share @ np.log(np.maximum(self._likelihood @ prior, 1e-300)))

    def _scores(self, parameters: Floats) -> Floats:
        """Return the derivatives of the logarithms of the likelihoods, shape (counts, 2)."""
        prior, statistics = self._prior(parameters)
        total = np.maximum(self._likelihood @ prior, 1e-300)
        given = self._likelihood @ (prior * statistics).T / total[:, None]
        return np.asarray(given - statistics @ prior)


def _probit(p: Floats | float) -> Floats:
    return np.asarray(np.clip(special.ndtri(p), -_FARTHEST - 0.3, _FARTHEST + 0.3))
