"""The wear rate of one site along the path, from noisy means at some nodes.

The reciprocal of a noisy mean is biased upwards. So the logarithm of the wear rate along the path
is fitted by a cubic such that the ratios of means to fit average to one (the quasi-likelihood of a
gamma law). This is unbiased, and the scatter about it gives its error, including the misfit of the
cubic, with Student's factor for so few nodes. Precise means are interpolated instead.
"""

import numpy as np

from models.beam.response.averages import NINE_IN_TEN
from models.beam.structure.modal import Array
from models.numerics.batch_means import student
from models.numerics.elementary import exp, expm1, log
from models.numerics.linear import inverse, product

_GOOD = 0.05  # relative error up to which means are interpolated
_CUBIC = 3
_STEEPEST = 300.0  # largest logarithm by which a fit may fall short of a rate
_GRID = 129  # points of a quadrature
_ITERATIONS = 30
_HALVINGS = 40


class FittedWear:
    """The wear rate of one site along the path, known at nodes with a standard error."""

    def __init__(self, x: Array, rate: Array, error: Array):
        worn = rate > 0
        relative = error[worn] / rate[worn]
        self.x, self.interpolated = x, bool(worn.all() and np.sqrt((relative**2).mean()) < _GOOD)
        if self.interpolated:
            self.log, self.relative = log(rate), relative
        else:
            self.coefficient, self.covariance = fit(x / x[-1], rate)
            freedom = max(1, len(x) - len(self.coefficient))
            self.covariance *= (student(freedom) / NINE_IN_TEN) ** 2

    def life(self, end: float) -> tuple[float, float]:
        """Return the integral of dx/rate up to an end, and its error.

        This is the half-width of a 90 % interval over `NINE_IN_TEN`.
        """
        if self.interpolated:
            inside = np.append(self.x[self.x < end], end)
            level = np.interp(inside, self.x, self.log)
            piece = np.diff(inside) * exp(-level[:-1]) * _mean_exponential(-np.diff(level))
            coarse = np.append(inside[:-1:2], end)
            level = np.interp(coarse, self.x, self.log)
            other = np.diff(coarse) * exp(-level[:-1]) * _mean_exponential(-np.diff(level))
            weight = (np.append(piece, 0.0) + np.append(0.0, piece)) / 2
            noise = weight * np.interp(inside, self.x, self.relative)
            change = (other.sum() - piece.sum()) / 3
            return float(piece.sum()), float(np.sqrt((noise**2).sum() + change**2))
        grid = np.linspace(0.0, end, _GRID)
        basis = np.vander(grid / self.x[-1], len(self.coefficient), increasing=True)
        with np.errstate(over="ignore", invalid="ignore"):
            inverse = exp(-_values(basis, self.coefficient))
            slope = -np.trapezoid(basis * inverse[:, None], grid, axis=0)
            life = np.trapezoid(inverse, grid)
            return float(life), float(np.sqrt((slope[:, None] * self.covariance * slope).sum()))

    def grown(self, time: float) -> float:
        """Return the end up to which the integral of dx/rate is a time: the inverse of `life`."""
        low, high = 0.0, float(self.x[-1])
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if self.life(middle)[0] < time else (low, middle)
        return (low + high) / 2


def fit(t: Array, rate: Array) -> tuple[Array, Array]:
    """Fit log rate by a polynomial in t such that rate/fit averages to one; with covariance."""
    degree = min(_CUBIC, (len(t) - 1) // 3)
    basis = np.vander(t, degree + 1, increasing=True)
    coefficient = np.zeros(degree + 1)
    coefficient[0] = log(rate.mean())
    normal = inverse(product(basis.T[None], basis[None]))[0][0]
    for _ in range(_ITERATIONS):
        residual = rate * exp(np.minimum(-_values(basis, coefficient), _STEEPEST)) - 1
        # Steps are limited to changes of the fit by a factor e: fits of noise would diverge.
        change = _values(normal, _values(basis.T, residual))
        coefficient += change / max(1.0, np.abs(_values(basis, change)).max())
    residual = rate * exp(np.minimum(-_values(basis, coefficient), _STEEPEST)) - 1
    scatter = (residual**2).sum() / max(1, len(t) - degree - 1)
    return coefficient, scatter * normal


def _values(basis: Array, coefficient: Array) -> Array:
    """Return the product of a matrix and a vector."""
    return product(basis[None], coefficient[None, :, None])[0, :, 0]


def _mean_exponential(a: Array) -> Array:
    """Return the mean of exp over [0, a]."""
    small = np.abs(a) < 1e-6
    safe = np.where(small, 1.0, a)
    return np.where(small, 1 + a / 2, expm1(safe) / safe)
