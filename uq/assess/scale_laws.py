"""Law of the life of a row given the inputs that are not integrated: P(T < t), moments."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy import special

from uq.assess.row_inputs import Inputs
from uq.contract import Floats
from uq.result.element import RowLaw
from uq.result.result import Result
from uq.result.weights import INPUT, LAW_SCORES, SCALE_SCORES
from uq.sampling.copulas import PairCopula
from uq.sampling.law import Law
from uq.sampling.log_sums import Term, normal_rule
from uq.sampling.truncation import cdf_between, cdf_within, factor_ends, ppf_between, ppf_within

_NODES = 200


def share_below(
    input_below: Callable[[Floats], Floats],
    drawn: Floats,
    exponent: float,
    lives: Floats,
    time: float,
) -> Floats:
    """Return P(T < time) of each row, shape (n,); 0 where the life is NaN.

    Parameters
    ----------
    input_below : callable
        Probability that the input of each row is below a value.
    drawn : ndarray, shape (n,)
        The value of each row.
    exponent : float
        Of the input in lives.
    lives : ndarray, shape (n,)
    time : float
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        share = input_below(drawn * (time / lives) ** (1 / exponent))
    return np.where(np.isnan(lives), 0.0, share if exponent > 0 else 1 - share)


_BLOCK = 2**14  # rows whose intermediate numbers stay in the cache of the processor


@dataclass(frozen=True)
class IndependentScale:
    """Inputs that are independent of all others.

    Attributes
    ----------
    inputs : tuple of str
    term : Term
        The law of the sum of the logarithms, each times its exponent.
    drawn : ndarray, shape (n,)
        The sum that each row has drawn.
    """

    inputs: tuple[str, ...]
    term: Term
    drawn: Floats

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of lives due to the inputs."""
        return float(self.drawn.std())

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,)."""
        below = np.empty(len(lives))
        with np.errstate(divide="ignore", invalid="ignore"):
            moment = np.log(time)
            for start in range(0, len(lives), _BLOCK):
                block = slice(start, start + _BLOCK)
                share = self.term.below(moment - np.log(lives[block]) + self.drawn[block])
                below[block] = np.where(np.isnan(lives[block]), 0.0, share)
        return below

    def above_each(self, lives: Floats, times: Floats) -> Iterator[Floats]:
        """Yield P(T >= time) of each row, shape (n,), for each time; 0 where the life is NaN.

        As 1 - `below`, but only of the rows at which it is not certain: these are neighbours in the
        order of the logarithms of lives less what was drawn.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            logarithms = np.log(lives)
            order = np.argsort(self.drawn - logarithms)[: len(lives) - np.isnan(lives).sum()]
            logarithms, drawn = logarithms[order], self.drawn[order]
            ends, places = np.array(self.term.certain), drawn - logarithms
            for moment in np.log(times):
                first, last = np.searchsorted(places, ends - moment)
                above = np.zeros(len(lives))
                above[order[:first]] = 1.0
                for start in range(first, last, _BLOCK):
                    block = slice(start, min(start + _BLOCK, last))
                    share = self.term.below(moment - logarithms[block] + drawn[block])
                    above[order[block]] = 1 - share
                yield above

    def log_life_shifts(self, z: Floats) -> Iterator[Floats]:
        """Yield the increase of logarithms of lives, shape (n,), at standard normal quantiles."""
        for at in self.term.at(z):
            yield at - self.drawn

    @property
    def moments(self) -> tuple[Floats, Floats]:
        """Mean growth of the logarithm of each life, and its variance, shapes (n,)."""
        mean, variance = self.term.moments
        return mean - self.drawn, np.full(self.drawn.shape, variance)


@dataclass(frozen=True)
class NormalGiven:
    """Conditional law of the probability of an input given others: normal copula.

    Attributes
    ----------
    mean : ndarray, shape (n,)
        Of the input's standard normal variable, given those of the other inputs.
    deviation : float
    """

    mean: Floats
    deviation: float

    def below(self, share: Floats) -> Floats:
        """Return P(U <= share) of each row, shape (n,)."""
        return np.asarray(special.ndtr((special.ndtri(share) - self.mean) / self.deviation))

    def quantile(self, z: float) -> Floats:
        """Return the quantile of U in each row, shape (n,), at a standard normal quantile."""
        return np.asarray(special.ndtr(self.mean + self.deviation * z))


@dataclass(frozen=True)
class CopulaGiven:
    """Conditional law of the probability of an input given another: copula of two inputs.

    Attributes
    ----------
    copula : PairCopula
    other : ndarray, shape (n,)
        The probability of the other input.
    """

    copula: PairCopula
    other: Floats

    @property
    def deviation(self) -> float:
        """Standard deviation of the normal copula with the same rank correlation."""
        return float(np.sqrt(1 - (2 * np.sin(np.pi / 6 * self.copula.rank_correlation)) ** 2))

    def below(self, share: Floats) -> Floats:
        """Return P(U <= share) of each row, shape (n,)."""
        part = self.copula.conditional(np.clip(share, 1e-300, 1 - 2.0**-53), self.other)
        return np.where(share <= 0, 0.0, np.where(share >= 1, 1.0, part))

    def quantile(self, z: float) -> Floats:
        """Return the quantile of U in each row, shape (n,), at a standard normal quantile."""
        below = np.clip(special.ndtr(z), 2.0**-54, 1 - 2.0**-53)
        return self.copula.conditional_quantile(np.full(self.other.shape, below), self.other)


@dataclass(frozen=True)
class ConditionalScale:
    """One input whose law depends on the other inputs of the row.

    Attributes
    ----------
    inputs : tuple of str
        Its name.
    law : Law
        Of the input, or of its factor.
    bounds : tuple of float
    exponent : float
    drawn : ndarray, shape (n,)
        The values of the rows.
    given : NormalGiven or CopulaGiven
        Of the input's probability, given the other inputs.
    other : ndarray, shape (n,), optional
        The input that it is a multiple of; positive.
    """

    inputs: tuple[str, ...]
    law: Law
    bounds: tuple[float, float]
    exponent: float
    drawn: Floats
    given: NormalGiven | CopulaGiven
    other: Floats | None = None

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of lives due to the inputs."""
        drawn = self.drawn if self.other is None else self.drawn / self.other
        return float(abs(self.exponent) * np.log(drawn).std())

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,)."""
        return share_below(self._given_others, self.drawn, self.exponent, lives, time)

    def _given_others(self, value: Floats) -> Floats:
        """Return the probability that the input of each row is below a value."""
        if self.other is None:
            share = cdf_within(self.law, value, self.bounds)
        else:
            ends = factor_ends(self.other, self.bounds)
            share = cdf_between(self.law, value / self.other, *ends)
        return self.given.below(share)

    def log_life_shifts(self, z: Floats) -> Iterator[Floats]:
        """Yield the increase of logarithms of lives, shape (n,), at standard normal quantiles."""
        for at in np.sign(self.exponent) * z:
            u = np.clip(self.given.quantile(at), 2.0**-54, 1 - 2.0**-53)
            if self.other is None:
                value = ppf_within(self.law, u, self.bounds)
            else:
                ends = factor_ends(self.other, self.bounds)
                value = self.other * ppf_between(self.law, u, *ends)
            yield self.exponent * np.log(value / self.drawn)

    @property
    def moments(self) -> tuple[Floats, Floats]:
        """Mean growth of the logarithm of each life, and its variance, shapes (n,)."""
        nodes, weights = (array[0] for array in normal_rule(np.array([-np.inf, np.inf]), _NODES))
        mean = square = np.zeros(self.drawn.shape)
        for weight, shifts in zip(weights, self.log_life_shifts(nodes), strict=True):
            mean, square = mean + weight * shifts, square + weight * shifts**2
        return mean, np.maximum(square - mean**2, 0.0)


Scale = IndependentScale | ConditionalScale


SCORES = np.linspace(-6.0, 6.0, 25)
"""Normal scores of the quantiles that are kept of the law of the integrated input."""

_DEGREE = 8
"""Degree of the polynomials of the probability below a value, which is smooth in the input."""

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
    """Legendre terms in rows that each have a posterior law of the input.

    Parameters
    ----------
    law : ndarray, shape (q,)
        As for `terms_at`.
    scores : ndarray, shape (n, q)
        Normal scores of the quantiles in each row.
    """

    def __init__(self, law: Floats, scores: Floats):
        densities = terms_at(law, scores.ravel()).reshape(*scores.shape, -1) * _DENSITY[:, None]
        steps = (densities[:, 1:] + densities[:, :-1]) * (_STEP / 2)
        self._up_to = np.concatenate(
            [np.zeros_like(densities[:, :1]), np.cumsum(steps, axis=1)], axis=1
        )

    @property
    def means(self) -> Floats:
        """Mean of each term over the law of each row, shape (n, terms)."""
        return np.asarray(self._up_to[:, -1])

    def below(self, probability: Floats) -> Floats:
        """Return the means of terms times whether the input is below a quantile of each row."""
        place = (special.ndtri(probability).clip(SCORES[0], SCORES[-1]) - SCORES[0]) / _STEP
        node = np.minimum(place.astype(int), len(SCORES) - 2)
        row, part = np.arange(len(node)), (place - node)[:, None]
        low, high = self._up_to[row, node], self._up_to[row, node + 1]
        return np.asarray(low + part * (high - low))


_FINE = np.linspace(-6.0, 6.0, 97)


@dataclass(frozen=True)
class PosteriorScale:
    """An input that scales lives, given the inspections and all else in a row.

    Attributes
    ----------
    inputs : tuple of str
        Its name.
    law : Law
        Of the input before the inspections.
    bounds : tuple of float
    exponent : float
    drawn : ndarray, shape (n,)
        The values of the rows.
    scores : ndarray, shape (n, 97)
        Normal scores, by the law before the inspections, of evenly spread scores from -6 to 6 given
        them: linear between these, and nothing beyond.
    terms : TermsOfLaws or None
        Of the law that the rows share.
    """

    inputs: tuple[str, ...]
    law: Law
    bounds: tuple[float, float]
    exponent: float
    drawn: Floats
    scores: Floats
    terms: TermsOfLaws | None = None

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of lives due to the input."""
        return float(abs(self.exponent) * np.log(self.drawn).std())

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,)."""
        return share_below(self._given_inspections, self.drawn, self.exponent, lives, time)

    def terms_below(self, lives: Floats, time: float, terms: TermsOfLaws) -> Floats:
        """Return the means of the terms times whether T < time, shape (n, terms)."""
        share = self.below(lives, time)
        return terms.below(share) if self.exponent > 0 else terms.means - terms.below(1 - share)

    def _given_inspections(self, value: Floats) -> Floats:
        """Return the probability that the input of each row is below a value."""
        score = special.ndtri(cdf_within(self.law, value, self.bounds))
        passed = (self.scores <= score[:, None]).sum(axis=1)
        after = np.clip(passed, 1, len(_FINE) - 1)
        row = np.arange(len(score))
        low, high = self.scores[row, after - 1], self.scores[row, after]
        part = (score - low) / (high - low)
        share = special.ndtr(_FINE[after - 1] + part * (_FINE[after] - _FINE[after - 1]))
        return np.where(passed == 0, 0.0, np.where(passed == len(_FINE), 1.0, share))


def posterior_scale(
    rows: Result, inputs: Inputs, exponents: Mapping[str, float]
) -> PosteriorScale | None:
    """Return the posterior law of the integrated input, if it only scales lives.

    Parameters
    ----------
    rows : Result
        Rows of an inspected unit; others have no posterior law.
    inputs : Inputs
        Of these rows.
    exponents : dict of str to float
        Of the inputs that only scale the lives.
    """
    name = posterior_input(rows)
    if name not in exponents:
        return None
    from scipy.interpolate import PchipInterpolator  # late: it takes a while to import

    arguments = inputs.laws[name], inputs.bounds[name], exponents[name], inputs.values[name]
    scores = PchipInterpolator(SCORES, rows.dataset[SCALE_SCORES].values, axis=1)(_FINE)
    terms = None
    if LAW_SCORES in rows.dataset:
        terms = TermsOfLaws(rows.dataset[LAW_SCORES].values, rows.dataset[SCALE_SCORES].values)
    return PosteriorScale((name,), *arguments, scores, terms)


def posterior_input(rows: Result) -> str:
    """Return the input with a posterior law in each row, or ""."""
    return str(rows.dataset[SCALE_SCORES].attrs[INPUT]) if SCALE_SCORES in rows.dataset else ""


def moments_of_input(rows: Result, inputs: Inputs) -> tuple[Floats, Floats]:
    """Return mean and variance of the integrated input in each row of an inspected unit, (n,)."""
    name = posterior_input(rows)
    below = special.ndtr(rows.dataset[SCALE_SCORES].values)
    flat = ppf_within(inputs.laws[name], below.ravel(), inputs.bounds[name])
    values, worth = flat.reshape(below.shape), np.exp(-(SCORES**2) / 2)
    mean = values @ worth / worth.sum()
    return mean, (values - mean[:, None]) ** 2 @ worth / worth.sum()


@dataclass(frozen=True)
class ConditionalLaw:
    """The law of lives that outlast a time.

    Attributes
    ----------
    law : RowLaw
        Of all lives.
    gone : ndarray, shape (n,)
        The probability of each row that its life has ended by then.
    since : float
        That time.
    """

    law: RowLaw
    gone: Floats
    since: float

    @property
    def inputs(self) -> tuple[str, ...]:
        """Inputs that are integrated."""
        return self.law.inputs

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of lives due to the integrated inputs."""
        return self.law.spread

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,); 0 where no life outlasts that time."""
        more = np.maximum(self.law.below(lives, time) - self.gone, 0.0)
        with np.errstate(invalid="ignore"):
            return np.where(self.gone < 1, more / (1 - self.gone), 0.0)


def posterior_terms(law: RowLaw | None, lives: Floats, time: float) -> tuple[Floats, Floats] | None:
    """Return the means of Legendre terms of a shared input in each row, or None without one.

    Parameters
    ----------
    law : RowLaw or None
    lives : ndarray, shape (n,)
    time : float

    Returns
    -------
    tuple of ndarray, shape (n, terms), or None
        The means over the law of each row of the terms of the shared law
        (`uq.stats.dependent_rows.SharedInfluence`), and of the terms times whether T < time.
    """
    if isinstance(law, PosteriorScale) and law.terms is not None:
        return law.terms.means, law.terms_below(lives, time, law.terms)
    if not isinstance(law, ConditionalLaw):
        return None
    earlier, all_by = (posterior_terms(law.law, lives, at) for at in (law.since, time))
    if earlier is None or all_by is None:
        return None
    left = np.maximum(1 - law.gone, 1e-300)[:, None]
    by = np.where(law.gone[:, None] < 1, (all_by[1] - earlier[1]) / left, 0.0)
    return np.where(law.gone[:, None] < 1, (earlier[0] - earlier[1]) / left, 0.0), by
