"""Lifetimes under a random load: the gaps grow by increments, with a time mean of the wear at each.

A random load leaves no branches to follow and no memory of the path: the mean wear of a site
depends on the gaps alone, and its life is the integral of dx over it (eqs 10 to 12 of Knudsen &
Massih 2002). An accelerated life would take each burst of the load for a hundred, and each lull.

The means are noisy, and one over a noisy mean is too large. So the logarithm of the wear along the
path is taken for a cubic, fitted such that the ratios of means and fit average to one (the
quasi-likelihood of a gamma law): unbiased, and the scatter about it says how well it is known, what
the cubic misses included. Where the means are good it is interpolated instead.
"""

from types import ModuleType
from typing import Any

import numpy as np

from models.beam.response.averages import SHORTEST, time_mean
from models.beam.response.settling import NINE_IN_TEN
from models.beam.structure.modal import Array
from models.beam.wear.lives import Lives
from models.numerics.elementary import exp, expm1, log, log1p
from models.numerics.linear import inverse, product

INCREMENTS = 12  # in which the faster gap grows to the last depth
_OVERTIME = 3  # times as many for the slower one
_LONGEST = 82  # over the accuracy: periods at each increment
_ANY = 1e9  # error of a mean whose length is given
_MEMORY = 0.3  # weight of the newest node in the sites' shares of wear
_GOOD = 0.05  # relative error of means that are interpolated
_CUBIC = 3
_STEEPEST = 300.0  # logarithm by which a fit may fall short of a rate
_GRID = 129  # points of a quadrature
_ITERATIONS = 30


def find_random_lives(
    propagator: ModuleType,
    system: Any,
    state: Array,
    gaps: Array,
    work: Array,
    error: Array,
    share: Array,
    growths: Array,
    accuracy: float,
) -> Lives:
    """Integrate the lives of n beams.

    Parameters
    ----------
    propagator, system, state, gaps, work, share, growths
        As in `models.beam.wear.accelerated_life.run`.
    error : ndarray, shape (n, 2)
        Standard error of `work`.
    accuracy : float
        Sets how long a time mean is taken at each increment. What the lives lack in accuracy their
        errors say.

    Returns
    -------
    Lives
        With the errors within which nine in ten lie.
    """
    n = len(state)
    periods = SHORTEST << max(0, round(np.log2(_LONGEST / accuracy / SHORTEST)))
    periods = min(periods, system.longest)
    nodes = 1 + _OVERTIME * INCREMENTS
    grown = np.zeros((nodes, n, 2))
    rate, doubt = np.full((2, nodes, n, 2), np.nan)
    rate[0], doubt[0] = work * share, error * share
    running = rate[0].copy()
    left, state, last = np.arange(n), state.copy(), np.zeros(n, int)
    for node in range(1, nodes):
        grown[node, left] = _step(grown[node - 1, left], running[left], growths[left])
        left = left[~np.isnan(grown[node, left]).any(axis=1)]
        if not len(left):
            break
        now, here = state[left], gaps[left] + grown[node, left]
        mean = time_mean(propagator, system.take(left), now, here, _ANY, periods)
        state[left], last[left] = now, node
        rate[node, left], doubt[node, left] = mean.work * share[left], mean.error * share[left]
        running[left] += _MEMORY * (rate[node, left] - running[left])
    out = Lives.nothing(n, growths.shape[1])
    for i in range(n):
        some = slice(0, last[i] + 1)
        narrow = (gaps[i] + grown[last[i], i]).min()
        silent = not rate[last[i], i].any() and system.reach[i] < narrow
        _note(i, out, gaps[i], grown[some, i], rate[some, i], doubt[some, i], growths[i], silent)
        # A random load knows one regime until contact ends.
        out.changes[i] = float(silent and bool(rate[0, i].any()))
    out.error[:] *= NINE_IN_TEN
    return out


def _step(grown: Array, rate: Array, growths: Array) -> Array:
    """Return what the gaps of n beams have grown to at the next node, NaN where there is none.

    The faster of the sites that have not finished goes to its next grid point; the grid is finer
    where the gap is new. A site that has finished long ago may be very much faster still: its
    growth, with the last depth, no more than doubles.
    """
    head_start = growths[:, :1] / 2
    whole = log1p(growths[:, -1:] / head_start)
    unfinished = grown < growths[:, -1:] * (1 - 1e-9)
    control = np.where(unfinished, rate, 0.0)
    fast = control.argmax(axis=1)[:, None]
    here, top = (np.take_along_axis(a, fast, axis=1) for a in (grown, control))
    point = log1p(here / head_start) / whole * INCREMENTS
    goal = head_start * expm1((np.floor(point + 1e-6) + 1) / INCREMENTS * whole)
    with np.errstate(invalid="ignore", divide="ignore"):
        step = (goal - here) * rate / top
        most = grown.max(axis=1, keepdims=True) + growths[:, -1:]
        step *= np.minimum(1.0, most / step.max(axis=1, keepdims=True))
        return np.where(top > 0, grown + step, np.nan)


def _note(
    i: int,
    out: Lives,
    gaps: Array,
    grown: Array,
    rate: Array,
    doubt: Array,
    growths: Array,
    silent: bool,
) -> None:
    """Note the lives of beam i, from how its sites had grown and wore at the nodes."""
    if np.isnan(rate).any():
        return
    at = np.full((2, len(growths)), np.nan)
    simulated = 0.0
    for site in range(2):
        x = grown[:, site]
        if x[-1] == 0:
            continue
        wear = _Wear(x, rate[:, site], doubt[:, site])
        whole, _ = wear.life(x[-1])
        simulated = max(simulated, whole if np.isfinite(whole) else 0.0)
        for depth in np.flatnonzero(growths <= x[-1] * (1 + 1e-9)).tolist():
            life, uncertainty = wear.life(growths[depth])
            if not np.isfinite(life):  # a fit of next to nothing
                break
            out.time[i, site, depth], out.error[i, site, depth] = life, uncertainty
            out.reached[i, site, depth] = True
            at[site, depth] = np.interp(growths[depth], x, np.arange(len(x)))
    out.time[i, :2][~out.reached[i, :2]] = np.inf if silent else simulated
    for depth, goal in enumerate(growths):
        times = np.where(out.reached[i, :2, depth], out.time[i, :2, depth], np.inf)
        first = int(times.argmin())
        for field in (out.time, out.error, out.reached):
            field[i, 2, depth] = field[i, first, depth]
        if out.reached[i, 2, depth]:
            other = np.interp(at[first, depth], np.arange(len(grown)), grown[:, 1 - first])
            out.ratio[i, depth] = (gaps[1 - first] + other) / (gaps[first] + goal)


class _Wear:
    """How fast one site wears along the path, known at nodes with a standard error."""

    def __init__(self, x: Array, rate: Array, error: Array):
        worn = rate > 0
        relative = error[worn] / rate[worn]
        self.x, self.interpolated = x, bool(worn.all() and np.sqrt((relative**2).mean()) < _GOOD)
        if self.interpolated:
            self.log, self.relative = log(rate), relative
        else:
            self.coefficient, self.covariance = _fit(x / x[-1], rate)

    def life(self, end: float) -> tuple[float, float]:
        """Return the integral of dx over the rate up to an end, and its standard error."""
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


def _fit(t: Array, rate: Array) -> tuple[Array, Array]:
    """Fit log rate by a polynomial in t such that rate over fit averages to one; and covariance."""
    degree = min(_CUBIC, (len(t) - 1) // 3)
    basis = np.vander(t, degree + 1, increasing=True)
    coefficient = np.zeros(degree + 1)
    coefficient[0] = log(rate.mean())
    normal = inverse(product(basis.T[None], basis[None]))[0][0]
    for _ in range(_ITERATIONS):
        residual = rate * exp(np.minimum(-_values(basis, coefficient), _STEEPEST)) - 1
        # Steps are kept where the fit changes by no more than a factor e: fits of noise run away.
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
