"""Terms of the law of an input that all units share: how rows follow its errors."""

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy import special

from uq.contract import Floats

SCORES = np.linspace(-6.0, 6.0, 25)
"""Normal scores of the quantiles that are kept of the law of the integrated input."""

_DEGREE = 8
"""Of the polynomials of the probability below a value: what follows the input is smooth."""

_STEP = SCORES[1] - SCORES[0]
_DENSITY = np.exp(-(SCORES**2) / 2) / np.sqrt(2 * np.pi)


def terms(probability: Floats) -> Floats:
    """Return Legendre polynomials of mean square 1 over the probabilities, shape (n, terms)."""
    size = np.sqrt(2 * np.arange(1, _DEGREE + 1) + 1)
    return np.asarray(size * legvander(2 * probability - 1, _DEGREE)[..., 1:])


def terms_at(law: Floats, scores: Floats) -> Floats:
    """Return the terms at values of the input, shape (n, terms).

    Parameters
    ----------
    law : ndarray, shape (q,)
        Normal scores, by the law before the inspections, of quantiles at `SCORES` given them.
    scores : ndarray, shape (n,)
        Normal scores of the values before the inspections.
    """
    return terms(special.ndtr(np.interp(scores, law, SCORES)))


class TermsOfLaws:
    """The terms in rows each of which has a law of the input.

    Parameters
    ----------
    law : ndarray, shape (q,)
        As for `terms_at`.
    scores : ndarray, shape (n, q)
        The same of each row.
    """

    def __init__(self, law: Floats, scores: Floats):
        each = terms_at(law, scores.ravel()).reshape(*scores.shape, -1) * _DENSITY[:, None]
        steps = (each[:, 1:] + each[:, :-1]) * (_STEP / 2)
        self._up_to = np.concatenate([np.zeros_like(each[:, :1]), np.cumsum(steps, axis=1)], axis=1)

    @property
    def means(self) -> Floats:
        """Over the law of each row, shape (n, terms)."""
        return np.asarray(self._up_to[:, -1])

    def below(self, probability: Floats) -> Floats:
        """Return the means of terms times whether the input is below a quantile of each row."""
        place = (special.ndtri(probability).clip(SCORES[0], SCORES[-1]) - SCORES[0]) / _STEP
        node = np.minimum(place.astype(int), len(SCORES) - 2)
        row, part = np.arange(len(node)), (place - node)[:, None]
        low, high = self._up_to[row, node], self._up_to[row, node + 1]
        return np.asarray(low + part * (high - low))
