"""The law of a life in each row, of which some inputs are integrated exactly."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy import special

from uq.contract import Floats
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
        Probability that the input of each row lies below a value.
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
        with np.errstate(divide="ignore", invalid="ignore"):
            share = self.term.below(np.log(time) - np.log(lives) + self.drawn)
        return np.where(np.isnan(lives), 0.0, share)

    def longer(self, z: Floats) -> Iterator[Floats]:
        """Yield the increase of logarithms of lives, shape (n,), at standard normal quantiles."""
        for at in self.term.at(z):
            yield at - self.drawn

    @property
    def moments(self) -> tuple[Floats, Floats]:
        """Mean growth of the logarithm of each life, and its variance, shapes (n,)."""
        mean, variance = self.term.moments
        return mean - self.drawn, np.full(self.drawn.shape, variance)


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
    mean : ndarray, shape (n,)
        Of the input's standard normal variable, given those of the other inputs.
    deviation : float
    other : ndarray, shape (n,), optional
        The input that it is a multiple of; positive.
    """

    inputs: tuple[str, ...]
    law: Law
    bounds: tuple[float, float]
    exponent: float
    drawn: Floats
    mean: Floats
    deviation: float = 1.0
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
        """Return the probability that the input of each row lies below a value."""
        if self.other is None:
            share = cdf_within(self.law, value, self.bounds)
        else:
            ends = factor_ends(self.other, self.bounds)
            share = cdf_between(self.law, value / self.other, *ends)
        return np.asarray(special.ndtr((special.ndtri(share) - self.mean) / self.deviation))

    def longer(self, z: Floats) -> Iterator[Floats]:
        """Yield the increase of logarithms of lives, shape (n,), at standard normal quantiles."""
        for at in np.sign(self.exponent) * z:
            u = special.ndtr(self.mean + self.deviation * at)
            u = np.clip(u, 2.0**-54, 1 - 2.0**-53)
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
        for weight, longer in zip(weights, self.longer(nodes), strict=True):
            mean, square = mean + weight * longer, square + weight * longer**2
        return mean, np.maximum(square - mean**2, 0.0)


Scale = IndependentScale | ConditionalScale
