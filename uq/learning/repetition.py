"""One of the independent repetitions of the sampler of new rows."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.learning.proposal import Proposal, fitted, tempered

_WIDER = 2.0
"""Of a last proposal: tails that are too light bias what its rows say, and too heavy ones only cost
rows."""


class Repetition:
    """The rows of one repetition, in the order of their rounds, and how much they count.

    Parameters
    ----------
    scores : ndarray, shape (own, inputs)
        Normal scores of the rows of the study with which it begins.
    each : int
        Rows that it draws in a round.
    last : Proposal, optional
        From which it draws all its rows; by default it fits one anew in each round.

    Attributes
    ----------
    log_importance : ndarray, shape (n,)
        How much its rows count before the inspections: the density before the inspections over the
        mixture of all that they were drawn from [1]_, each in proportion to its rows. At most
        n / `own`.

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
            The scores to draw from a law of their own.
        rng : numpy.random.Generator

        Returns
        -------
        ndarray, shape (each, inputs)
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
        """Return repetitions that begin anew, and draw around all rows that these have so far.

        Their rows are independent of the proposal, and of each other given it. Those to which
        proposals were fitted are not: they count too little, for the proposals are denser there.

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
    """Return a proposal around rows, weighted with as much likelihood as they bear."""
    weights = np.zeros(len(scores))
    for log_likelihood in log_likelihoods:
        possible = (
            log_likelihood if np.isfinite(log_likelihood).any() else np.zeros(len(log_likelihood))
        )
        of_unit = tempered(log_importance, possible)
        weights += of_unit / of_unit.sum()
    return fitted(scores, weights, columns, rng)
