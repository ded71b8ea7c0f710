"""Adaptive importance sampling of new rows: Student mixtures, in independent repetitions."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.stats.importance_weights import effective_rows

FREEDOM = 5.0
"""Degrees of freedom of the Student laws: tails heavier than those of a posterior."""

_CENTRES = 100
_LEAST = 100.0
_EDGE = 8.0
_HALVINGS = 60
_COLDEST = 1e-9
_LOG_ROOT = float(np.log(2 * np.pi) / 2)

_WIDER = 2.0
"""Widening factor of the last proposal: light tails bias estimates, heavy ones only cost rows."""


class Proposal(NamedTuple):
    """A mixture of equal Student laws in some of the normal scores of the inputs.

    The other scores keep their prior law, the standard normal.

    Attributes
    ----------
    columns : ndarray of int, shape (k,)
        The scores drawn from the mixture.
    centres : ndarray, shape (c, k)
    root : ndarray, shape (k, k)
        Lower triangular root of their common matrix.
    """

    columns: NDArray[np.intp]
    centres: Floats
    root: Floats

    def drawn(self, count: int, inputs: int, rng: np.random.Generator) -> Floats:
        """Draw normal scores of `count` rows, shape (count, inputs)."""
        scores = rng.standard_normal((count, inputs))
        chosen = self.centres[rng.integers(len(self.centres), size=count)]
        tail = np.sqrt(FREEDOM / rng.chisquare(FREEDOM, size=count))
        scores[:, self.columns] = chosen + tail[:, None] * (scores[:, self.columns] @ self.root.T)
        return np.asarray(scores.clip(-_EDGE, _EDGE))

    def log_ratio(self, scores: Floats) -> Floats:
        """Return the log ratio of the proposal density to the prior density, shape (n,)."""
        at, k = scores[:, self.columns], len(self.columns)
        constant = (
            special.gammaln((FREEDOM + k) / 2)
            - special.gammaln(FREEDOM / 2)
            - k / 2 * np.log(FREEDOM * np.pi)
            - np.log(np.diag(self.root)).sum()
        )
        square = np.zeros((len(at), len(self.centres)))
        for coordinate, centre in zip(
            self._whitened(at), self._whitened(self.centres), strict=True
        ):
            square += np.subtract.outer(coordinate, centre) ** 2
        density = np.mean((1 + square / FREEDOM) ** (-(FREEDOM + k) / 2), axis=1)
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(density) + constant + (at**2 / 2).sum(axis=1) + k * _LOG_ROOT)

    def wider(self, factor: float) -> "Proposal":
        """Return the mixture with its scale multiplied by a factor."""
        return self._replace(root=factor * self.root)

    def _whitened(self, at: Floats) -> Floats:
        # Without BLAS: for few columns its threads cost more than the computation.
        return np.einsum("ij,nj->in", np.linalg.inv(self.root), at)


def tempered(log_before: Floats, log_likelihood: Floats) -> Floats:
    """Return tempered weights with a sufficient effective sample size.

    Parameters
    ----------
    log_before : ndarray, shape (n,)
        Log weights without the likelihood.
    log_likelihood : ndarray, shape (n,)
        Not all -inf.

    Returns
    -------
    ndarray, shape (n,)
        Weights with the likelihood raised to the largest power, at most 1, that keeps an effective
        sample size of 100, or half of that of the rows that the likelihood allows.
    """

    def weights(power: float) -> Floats:
        log_weights = log_before + power * log_likelihood
        return np.exp(log_weights - log_weights.max())

    least = min(_LEAST, effective_rows(weights(_COLDEST)) / 2)
    if effective_rows(weights(1.0)) >= least:
        return weights(1.0)
    low, high = np.log(_COLDEST), 0.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (
            (middle, high)
            if effective_rows(weights(float(np.exp(middle)))) >= least
            else (low, middle)
        )
    return weights(float(np.exp(low)))


def fitted(
    scores: Floats, weights: Floats, columns: NDArray[np.intp], rng: np.random.Generator
) -> Proposal:
    """Return a proposal around weighted rows: a kernel estimate of their density [1]_.

    Parameters
    ----------
    scores : ndarray, shape (n, inputs)
    weights : ndarray, shape (n,)
    columns : ndarray of int, shape (k,)
        The scores to give a law of their own.
    rng : numpy.random.Generator

    References
    ----------
    .. [1] M. West, "Approximating posterior distributions by mixtures", J. R. Stat. Soc. B 55,
       409-422 (1993).
    """
    at, k = scores[:, columns], len(columns)
    rows = effective_rows(weights)
    covariance = np.atleast_2d(np.cov(at.T, aweights=weights, ddof=0))
    floor = 1e-6 * np.trace(covariance) / k + 1e-12
    width = (4 / ((k + 2) * rows)) ** (1 / (k + 4))
    root = width * np.linalg.cholesky(covariance + floor * np.eye(k))
    above = np.cumsum(weights) / weights.sum()
    places = (np.arange(_CENTRES) + rng.random()) / _CENTRES
    chosen = np.minimum(np.searchsorted(above, places), len(at) - 1)
    return Proposal(columns, at[chosen], root)


class Repetition:
    """The rows of one sampler repetition, in order of rounds, with their importance weights.

    Parameters
    ----------
    scores : ndarray, shape (own, inputs)
        Normal scores of the initial rows, from the study.
    round_size : int
        Rows drawn per round.
    last : Proposal, optional
        Fixed proposal for all rows; by default a new one is fitted in each round.

    Attributes
    ----------
    log_importance : ndarray, shape (n,)
        Log prior importance weights: prior density over the mixture of the prior and all proposals
        used [1]_, in proportion to their rows (balance heuristic). Weights are at most n / `own`.

    References
    ----------
    .. [1] A. Owen, Y. Zhou, "Safe and effective importance sampling", J. Am. Stat. Assoc. 95,
       135-143 (2000).
    """

    def __init__(self, scores: Floats, round_size: int, last: Proposal | None = None):
        self.log_importance = np.zeros(len(scores))
        self._scores, self._each, self._own, self._last = scores, round_size, len(scores), last
        self._proposals: list[Proposal] = []
        self._log_mixture = np.full(len(scores), np.log(len(scores)))

    def drawn(
        self,
        log_likelihoods: Sequence[Floats],
        columns: NDArray[np.intp],
        rng: np.random.Generator,
    ) -> Floats:
        """Draw a round.

        Parameters
        ----------
        log_likelihoods : sequence of ndarray, shape (n,)
            Of its rows as each inspected unit.
        columns : ndarray of int
            The scores to draw from the proposal.
        rng : numpy.random.Generator

        Returns
        -------
        ndarray, shape (round_size, inputs)
            Normal scores.
        """
        proposal = self._last
        if proposal is None:
            proposal = _around(self._scores, self.log_importance, log_likelihoods, columns, rng)
        new = proposal.drawn(self._each, self._scores.shape[1], rng)
        self._add(proposal, new)
        return new

    def _add(self, proposal: Proposal, new: Floats) -> None:
        log_each = np.log(self._each)
        mixture = np.full(len(new), np.log(self._own))
        for previous in self._proposals:
            mixture = np.logaddexp(mixture, log_each + previous.log_ratio(new))
        self._scores = np.concatenate([self._scores, new])
        self._proposals.append(proposal)
        before = np.concatenate([self._log_mixture, mixture])
        self._log_mixture = np.logaddexp(before, log_each + proposal.log_ratio(self._scores))
        self.log_importance = np.log(len(self._scores)) - self._log_mixture

    @staticmethod
    def settled(
        repetitions: Sequence["Repetition"],
        log_likelihoods: Sequence[Sequence[Floats]],
        columns: NDArray[np.intp],
        rng: np.random.Generator,
    ) -> "list[Repetition]":
        """Restart the repetitions from the rows of the study, with one fixed proposal.

        The proposal is fitted to all rows so far, and widened. The new rows are conditionally
        independent given the proposal. Rows used to fit a proposal are biased: their weights are
        too small, because the proposal is denser near them.

        Parameters
        ----------
        repetitions : sequence of Repetition
        log_likelihoods : sequence of sequence of ndarray
            Of each repetition, as for `drawn`.
        columns, rng
            As for `drawn`.
        """
        scores = np.concatenate([repetition._scores for repetition in repetitions])
        log_importance = np.concatenate([repetition.log_importance for repetition in repetitions])
        of_units = [np.concatenate(parts) for parts in zip(*log_likelihoods, strict=True)]
        last = _around(scores, log_importance, of_units, columns, rng).wider(_WIDER)
        return [
            Repetition(repetition._scores[: repetition._own], repetition._each, last)
            for repetition in repetitions
        ]


def _around(
    scores: Floats,
    log_importance: Floats,
    log_likelihoods: Sequence[Floats],
    columns: NDArray[np.intp],
    rng: np.random.Generator,
) -> Proposal:
    """Fit a proposal to rows with tempered weights."""
    weights = np.zeros(len(scores))
    for log_likelihood in log_likelihoods:
        possible = (
            log_likelihood if np.isfinite(log_likelihood).any() else np.zeros(len(log_likelihood))
        )
        of_unit = tempered(log_importance, possible)
        weights += of_unit / of_unit.sum()
    return fitted(scores, weights, columns, rng)
