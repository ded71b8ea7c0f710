"""The wear rate of one site along the path, from noisy means at some nodes.

The reciprocal of a noisy mean is biased upwards. So the logarithm of the wear rate is fitted by a
cubic spline such that the ratios of means to fit average to one (the quasi-likelihood of a gamma
law), and what its own variance adds to the mean of the reciprocal is taken off. The spline has half
as many coefficients as there are nodes: it follows all that changes over some nodes, and as many
degrees of freedom are left for its error. The scatter about it, misfit included, gives the size of
the noise; the stated errors of the means say where along the path it is larger. Precise means are
interpolated instead.
"""

import numpy as np

from models.beam.response.averages import NINE_IN_TEN
from models.beam.structure.modal import Array
from models.numerics.batch_means import student
from models.numerics.elementary import exp, expm1, log, log1p
from models.numerics.linear import inverse, product

_GOOD = 0.05  # relative error up to which means are interpolated
_ORDER = 4  # of a cubic spline
_STEEPEST = 300.0  # largest logarithm by which a fit may fall short of a rate
_NEIGHBOURS = 2  # nodes on either side with which the variance of a node is averaged
_ITERATIONS = 30
_STILL_FALLING = -0.5  # change of the logarithm where there are no means to fall to
_NEVER = 1e4  # minus the logarithm of a rate at which a life is infinite
_CONVERGED = 1e-9  # largest change of a logarithm at which a fit is done
_HALVINGS = 40


class FittedWear:
    """The wear rate of one site along the path, known at nodes with a standard error."""

    def __init__(self, x: Array, rate: Array, error: Array):
        worn = rate > 0
        relative = np.divide(error, rate, out=np.ones_like(rate), where=worn)
        self.x, self.interpolated = x, bool(worn.all() and np.sqrt((relative**2).mean()) < _GOOD)
        if self.interpolated:
            self.log, self.covariance = log(rate), np.diag(relative**2)
        else:
            self.log, covariance = fit(rate, relative)
            self.log += log1p(np.diag(covariance))
            freedom = len(x) - _coefficients(len(x))
            self.covariance = covariance * (student(freedom) / NINE_IN_TEN) ** 2

    def life(self, end: float) -> tuple[float, float]:
        """Return the integral of dx/rate up to an end, and its error.

        This is the half-width of a 90 % interval over `NINE_IN_TEN`.
        """
        end = min(end, float(self.x[-1]))
        last = int((self.x < end).sum())  # the first node at the end or beyond
        if last == 0:
            return 0.0, 0.0
        inside = np.append(self.x[:last], end)
        with np.errstate(over="ignore", invalid="ignore"):
            piece = self._integrals(inside)
            coarse = self._integrals(np.append(inside[:-1:2], end))
            change = (coarse.sum() - piece.sum()) / 3 if self.interpolated else 0.0
            weight = np.zeros(len(self.x))
            weight[:last] += piece / 2
            weight[1 : last + 1] += piece / 2
            # The rate at the end is interpolated between the nodes before and after.
            before = (self.x[last] - end) / (self.x[last] - self.x[last - 1]) * piece[-1] / 2
            weight[last - 1] += before
            weight[last] -= before
            variance = (weight[:, None] * self.covariance * weight).sum()
            return float(piece.sum()), float(np.sqrt(variance + change**2))

    def _integrals(self, x: Array) -> Array:
        """Return the integrals of dx/rate between neighbouring points."""
        level = np.interp(x, self.x, self.log)
        lower, step = np.minimum(level[:-1], level[1:]), np.abs(np.diff(level))
        return np.asarray(np.diff(x) * exp(-lower) * _mean_exponential(-step))

    def grown(self, time: float) -> float:
        """Return the end up to which the integral of dx/rate is a time: the inverse of `life`."""
        low, high = 0.0, float(self.x[-1])
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if self.life(middle)[0] < time else (low, middle)
        return (low + high) / 2


def fit(rate: Array, relative: Array) -> tuple[Array, Array]:
    """Fit the logarithm of noisy rates along the path by a spline.

    Parameters
    ----------
    rate : ndarray, shape (n,)
        Means at the nodes.
    relative : ndarray, shape (n,)
        Their relative errors, of which only the ratios matter.

    Returns
    -------
    level : ndarray, shape (n,)
        Logarithm of the fit at the nodes. Where there was next to no wear at several nodes in a
        row it has no bound: lives are infinite there.
    covariance : ndarray, shape (n, n)
        Of `level`.
    """
    n = len(rate)
    basis = _splines(n, _coefficients(n))
    normal = inverse(_product(basis.T, basis)[None])[0][0]
    hat = _product(_product(basis, normal), basis.T)
    level = np.full(n, log(rate.mean()))
    for _ in range(_ITERATIONS):
        # Steps are limited to changes of the fit by a factor e: fits of noise would diverge.
        change = _product(hat, _residual(rate, level)[:, None])[:, 0]
        largest = np.abs(change).max()
        level += change / max(1.0, largest)
        if largest < _CONVERGED:
            break
    windows = np.pad(relative**2, _NEIGHBOURS, mode="edge")
    noise = np.lib.stride_tricks.sliding_window_view(windows, 2 * _NEIGHBOURS + 1).mean(axis=1)
    noise *= (_residual(rate, level) ** 2).sum() / ((1 - np.diag(hat)) * noise).sum()
    level[change < _STILL_FALLING] = -_NEVER
    return level, _product(hat * noise, hat)


def _coefficients(nodes: int) -> int:
    """Return the number of coefficients of a spline through the noise of some nodes."""
    return max(1, nodes // 2)


def _residual(rate: Array, level: Array) -> Array:
    """Return the relative deviations of rates from their fit."""
    return np.asarray(rate * exp(np.minimum(-level, _STEEPEST)) - 1)


def _splines(n: int, count: int) -> Array:
    """Return cubic B-splines of equal intervals at n nodes; powers where they are too few."""
    along = np.linspace(0.0, 1.0, n)
    if count < _ORDER:
        return np.vander(along, count, increasing=True)
    away = np.abs(along[:, None] * (count - _ORDER + 1) - np.arange(-1, count - 1))
    near = 2 / 3 - away * away * (1 - away / 2)
    return np.asarray(np.where(away < 1, near, np.maximum(2 - away, 0.0) ** 3 / 6))


def _product(matrix: Array, right: Array) -> Array:
    """Return the product of two matrices."""
    return product(matrix[None], right[None])[0]


def _mean_exponential(a: Array) -> Array:
    """Return the mean of exp over [0, a]."""
    small = np.abs(a) < 1e-6
    safe = np.where(small, 1.0, a)
    return np.where(small, 1 + a / 2, expm1(safe) / safe)
