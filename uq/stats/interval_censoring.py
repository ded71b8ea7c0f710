"""Nonparametric maximum likelihood for lives known within intervals, with late entry.

A life T is known to lie in (low, high]: exactly known where both are equal, right-censored where
high is infinite, left-censored where low is 0. A row with an entry time e was observed only because
T > e (left truncation). The estimate puts mass on finitely many disjoint intervals, within which
its place does not change the likelihood: there the data cannot tell the distribution function.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, log, nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.estimate import Estimate
from uq.stats.intervals import CONFIDENCE, upper_probability
from uq.stats.quantile_functions import normal

_Places = NDArray[np.intp]

MOST_STEPS = 20_000
"""Largest number of EM-ICM steps of one estimate."""

_GAP = 1e-7  # of the log-likelihood per row, at which an estimate counts as converged
_PROFILE_GAP = 2e-3  # of a profile log-likelihood, where the critical drop is 1.92
_PROFILE_STEPS = 2_000
_TINY = 1e-300
_LEFT, _RIGHT, _AFTER = 0, 1, 2  # order of ends at one time: [t, t], then (t, ...


class LifeIntervals(NamedTuple):
    """Lives of n rows: in (low, high], given that they exceed `entered`; shapes (n,)."""

    low: Floats
    high: Floats
    entered: Floats

    @property
    def is_exact(self) -> NDArray[np.bool_]:
        """Mask of rows whose life is known exactly."""
        return np.asarray((self.low == self.high) & np.isfinite(self.low))

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.low)


class Turnbull(NamedTuple):
    """Nonparametric maximum likelihood estimate: masses of disjoint intervals.

    Attributes
    ----------
    low, high : ndarray, shape (m,)
        The intervals (low, high], in order; a point where both are equal.
    mass : ndarray, shape (m,)
        Sums to 1.
    log_likelihood : float
    gap : float
        Upper bound of the further gain in log-likelihood, from the Fenchel conditions.
    steps : int
    converged : bool
    """

    low: Floats
    high: Floats
    mass: Floats
    log_likelihood: float
    gap: float
    steps: int
    converged: bool

    def ended_by(self, time: Floats) -> tuple[Floats, Floats]:
        """Return the least and the largest P(T <= t) that the data allow, at each time."""
        total = np.append(0.0, np.cumsum(self.mass))
        least = total[np.searchsorted(self.high, time, side="right")]
        is_point = self.low == self.high
        start = np.where(is_point, self.high, np.nextafter(self.low, inf))
        return least, np.minimum(total[np.searchsorted(start, time, side="right")], 1.0)


@dataclass(frozen=True)
class _Problem:
    """The likelihood as a function of the masses of candidate intervals.

    Attributes
    ----------
    low, high : ndarray, shape (m,)
        Candidate intervals.
    first, beyond, entry : ndarray of int, shape (k,)
        Of each distinct row: it has the candidates first..beyond - 1, given those from `entry` on.
    count : ndarray, shape (k,)
        Number of equal rows.
    """

    low: Floats
    high: Floats
    first: _Places
    beyond: _Places
    entry: _Places
    count: Floats

    @cached_property
    def is_open(self) -> NDArray[np.bool_]:
        """Mask of rows that reach the last candidate: right-censored."""
        return np.asarray(self.beyond == len(self.low))

    @cached_property
    def is_explicit(self) -> bool:
        """Whether one EM step gives the estimate: every life is exact or right-censored."""
        return bool(((self.beyond - self.first == 1) | self.is_open).all())

    def log_likelihood(self, total: Floats) -> float:
        """Return the log-likelihood from the cumulated masses, shape (m + 1,)."""
        of_row, of_entry = total[self.beyond] - total[self.first], total[-1] - total[self.entry]
        if (of_row <= 0).any() or (of_entry <= 0).any():
            return -inf
        return float(self.count @ (np.log(of_row) - np.log(of_entry)))

    def slope(self, total: Floats) -> Floats:
        """Return the derivative of the log-likelihood with respect to each mass, shape (m,)."""
        of_row = self.count / np.maximum(total[self.beyond] - total[self.first], _TINY)
        of_entry = self.count / np.maximum(total[-1] - total[self.entry], _TINY)
        size = len(total)
        steps = (
            np.bincount(self.first, of_row, size)
            - np.bincount(self.beyond, of_row, size)
            - np.bincount(self.entry, of_entry, size)
        )
        return np.cumsum(steps)[:-1]

    def em_step(self, total: Floats, fixed: tuple[int, float] | None) -> Floats:
        """Return the cumulated masses after a step of the EM algorithm [Turnbull 1976].

        The M-step is in the discrete hazards, with risk sets from the entry on; a fixed value F of
        the distribution function after its first k masses adds a Lagrange multiplier.
        """
        mass, size = np.diff(total), len(total)
        count = np.where(self.is_open, 0.0, self.count)
        share = count / np.maximum(total[self.beyond] - total[self.first], _TINY)
        cover = np.cumsum(
            np.bincount(self.first, share, size) - np.bincount(self.beyond, share, size)
        )[:-1]
        ended = mass * np.maximum(cover, 0.0)
        # At risk: those that entered, without those that ended or were censored before.
        entered = np.cumsum(np.bincount(self.entry, self.count, size))[:-1]
        censored = np.cumsum(np.bincount(self.first, self.count - count, size))[:-1]
        at_risk = np.maximum(entered - censored - np.append(0.0, np.cumsum(ended))[:-1], ended)
        if fixed is not None:
            return _pinned(ended, at_risk, *fixed)
        with np.errstate(divide="ignore", invalid="ignore"):
            hazard = np.where(at_risk > 0, np.minimum(ended / at_risk, 1.0), 0.0)
        hazard[-1] = 1.0
        return np.append(0.0, 1 - np.cumprod(1 - hazard))

    def icm_step(self, total: Floats, fixed: tuple[int, float] | None) -> Floats:
        """Return the target of a step of the iterative convex minorant algorithm."""
        size = len(total)
        of_row = np.maximum(total[self.beyond] - total[self.first], _TINY)
        of_entry = np.maximum(total[-1] - total[self.entry], _TINY)
        single = self.count / of_row
        slope = (
            np.bincount(self.beyond, single, size)
            - np.bincount(self.first, single, size)
            + np.bincount(self.entry, self.count / of_entry, size)
        )[1:-1]
        double = single / of_row
        curvature = (
            np.bincount(self.beyond, double, size) + np.bincount(self.first, double, size)
        )[1:-1]
        weights: Floats = curvature.astype(float)
        wanted = total[1:-1] + slope / np.where(weights > 0, weights, 1.0)
        if fixed is None:
            target = _minorant(wanted, weights, 0.0, 1.0)
        else:
            k, value = fixed
            before = _minorant(wanted[: k - 1], weights[: k - 1], 0.0, value)
            after = _minorant(wanted[k:], weights[k:], value, 1.0)
            target = np.concatenate([before, [value], after])
        return np.concatenate([[0.0], target, [1.0]])


def _minorant(wanted: Floats, weights: Floats, least: float, most: float) -> Floats:
    """Return the weighted isotonic regression within bounds; entries without weight follow."""
    from scipy.optimize import isotonic_regression  # here: its import takes long

    target, free = np.full(len(wanted), least), weights > 0
    if free.any():
        target[free] = isotonic_regression(wanted[free], weights=weights[free]).x
    return np.clip(np.maximum.accumulate(target), least, most)


def _pinned(ended: Floats, at_risk: Floats, k: int, value: float) -> Floats:
    """Return cumulated masses of largest likelihood whose first k sum to `value`.

    The hazards are d / (Y + multiplier) up to there, as by Thomas and Grunkemeier.
    """
    from scipy.optimize import brentq

    d, y = ended[:k], at_risk[:k]
    some_end = d > 0
    hazard = np.zeros_like(ended)
    if not some_end.any():
        hazard[k - 1] = value
    else:
        least = float(np.max(d[some_end] - y[some_end]))

        def excess(multiplier: float) -> float:
            with np.errstate(divide="ignore"):
                return float(
                    np.log1p(-d[some_end] / (y[some_end] + multiplier)).sum() - log(1 - value)
                )

        low, high = least + 1e-12 * max(1.0, abs(least)), least + 1.0
        while excess(high) < 0:
            high = least + 4 * (high - least)
        if excess(low) >= 0:
            multiplier = low
        else:
            multiplier = float(brentq(excess, low, high, xtol=1e-12, rtol=1e-13))
        hazard[:k][some_end] = d[some_end] / (y[some_end] + multiplier)
    first = 1 - np.cumprod(1 - np.clip(hazard[:k], 0.0, 1.0))
    first *= value / first[-1] if first[-1] > 0 else 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        later = np.where(at_risk[k:] > 0, np.minimum(ended[k:] / at_risk[k:], 1.0), 0.0)
    later[-1] = 1.0
    second = 1 - (1 - value) * np.cumprod(1 - later)
    return np.concatenate([[0.0], first, second])


def _problem(lives: LifeIntervals, split: float | None = None) -> _Problem:
    """Return the likelihood of lives, its candidate intervals cut at a time.

    Candidates are the innermost intervals: from a lower end to the next upper end, or to the next
    entry [Alioum and Commenges 1996]. If the distribution function is fixed at a time, the time,
    the origin and infinity are ends, too.
    """
    exact = lives.is_exact
    left_kind = np.where(exact, _LEFT, _AFTER)
    entries = np.unique(lives.entered[lives.entered > 0])
    lefts = [lives.low]
    left_kinds = [left_kind]
    rights = [lives.high, entries]
    if split is not None:
        lefts.append(np.array([-1.0, split]))
        left_kinds.append(np.array([_AFTER, _AFTER]))
        rights.append(np.array([split, inf]))
    # An end at one time: [t before t] before (t as an entry or a lower end.
    time = np.concatenate([*lefts, *rights])
    kind = np.concatenate([*left_kinds, np.full(sum(map(len, rights)), _RIGHT)])
    is_left = np.arange(len(time)) < sum(map(len, lefts))
    order = np.lexsort((kind, time))
    time, kind, is_left = time[order], kind[order], is_left[order]
    place = np.flatnonzero(is_left[:-1] & ~is_left[1:])
    low, low_kind, high = time[place], kind[place], time[place + 1]
    # A row has a candidate if its lower end is not after, and its upper end not before.
    starts = _key(low, low_kind)
    first = np.searchsorted(starts, _key(lives.low, left_kind), side="left")
    beyond = np.searchsorted(high, lives.high, side="right")
    entry = np.searchsorted(starts, _key(lives.entered, np.full(len(lives), _AFTER)), side="left")
    entry = np.where(lives.entered > 0, entry, 0)
    rows, count = np.unique(np.stack([first, beyond, entry]), axis=1, return_counts=True)
    first, beyond, entry = rows.astype(np.intp)
    return _Problem(low, high, first, beyond, entry, count.astype(float))


def _key(time: Floats, kind: NDArray[np.integer]) -> Floats:
    """Return sortable numbers: a time itself, or the next number for what begins after it."""
    return np.where(kind == _AFTER, np.nextafter(time, inf), time)


def _maximum(
    problem: _Problem, fixed: tuple[int, float] | None = None, start: Floats | None = None
) -> tuple[Floats, float, float, int]:
    """Return cumulated masses, log-likelihood, Fenchel gap and steps of the hybrid EM-ICM."""
    size = len(problem.low)
    total = np.linspace(0.0, 1.0, size + 1) if start is None else start
    if fixed is not None:
        k, value = fixed
        # Any start with the fixed value: uniform on both sides.
        total = np.concatenate(
            [np.linspace(0.0, value, k + 1), np.linspace(value, 1.0, size - k + 1)[1:]]
        )
    best = problem.log_likelihood(total)
    gap, steps = inf, 0
    enough = _GAP * problem.count.sum() if fixed is None else _PROFILE_GAP
    while steps < (MOST_STEPS if fixed is None else _PROFILE_STEPS):
        steps += 1
        after_em = problem.em_step(total, fixed)
        likelihood = problem.log_likelihood(after_em)
        if likelihood >= best or problem.is_explicit:
            total, best = after_em, likelihood
        if size > 2 and not problem.is_explicit:
            target, step = problem.icm_step(total, fixed), 1.0
            while step > 1e-4:
                trial = total + step * (target - total)
                likelihood = problem.log_likelihood(trial)
                if likelihood > best:
                    total, best = trial, likelihood
                    break
                step /= 2
        gap = 0.0 if problem.is_explicit else _gap(problem, total, fixed)
        if gap < enough:
            break
    return total, best, gap, steps


def _gap(problem: _Problem, total: Floats, fixed: tuple[int, float] | None) -> float:
    """Return by how much the log-likelihood may increase at most, as it is concave [Fenchel]."""
    slope, mass = problem.slope(total), np.diff(total)
    if fixed is None:
        return float(slope.max() - slope @ mass)
    k, value = fixed
    sides = ((slope[:k], mass[:k], value), (slope[k:], mass[k:], 1 - value))
    return float(sum(size * side.max() - side @ masses for side, masses, size in sides))


def turnbull(lives: LifeIntervals) -> Turnbull:
    """Return the nonparametric maximum likelihood estimate of a distribution of lives.

    Parameters
    ----------
    lives : LifeIntervals
        Of independent rows.

    Returns
    -------
    Turnbull

    Notes
    -----
    The hybrid of EM steps [1]_ and steps of the iterative convex minorant algorithm converges from
    any start [2]_. It stops when the Fenchel conditions bound the further gain in log-likelihood by
    1e-7 a row. Without intervals, one EM step gives the product-limit estimate, with late entry the
    one with risk sets from the entry on [3]_.

    References
    ----------
    .. [1] B. W. Turnbull, "The empirical distribution function with arbitrarily grouped, censored
       and truncated data", J. R. Stat. Soc. B 38, 290-295 (1976).
    .. [2] J. A. Wellner, Y. Zhan, "A hybrid algorithm for computation of the nonparametric maximum
       likelihood estimator from censored data", J. Am. Stat. Assoc. 92, 945-959 (1997).
    .. [3] A. Alioum, D. Commenges, "A proportional hazards model for arbitrarily censored and
       truncated data", Biometrics 52, 512-524 (1996).
    """
    problem = _problem(lives)
    total, best, gap, steps = _maximum(problem)
    mass = np.maximum(np.diff(total), 0.0)
    done = gap < _GAP * problem.count.sum()
    return Turnbull(problem.low, problem.high, mass / mass.sum(), best, gap, steps, done)


@dataclass(frozen=True)
class LikelihoodIntervals:
    """Estimates from lives known within intervals, with likelihood-ratio intervals.

    Attributes
    ----------
    lives : LifeIntervals
        Of independent rows.
    confidence : float
    """

    lives: LifeIntervals
    confidence: float = CONFIDENCE

    @cached_property
    def estimate(self) -> Turnbull:
        """The nonparametric maximum likelihood estimate."""
        return turnbull(self.lives)

    @cached_property
    def _answers(self) -> dict[float, tuple[Estimate, tuple[float, float]]]:
        return {}

    def ended_by(self, time: float) -> tuple[Estimate, tuple[float, float]]:
        """Estimate P(T <= t), and the range that the data leave open.

        Returns
        -------
        estimate : Estimate
            The middle of the range, with the interval of all values that the likelihood ratio does
            not reject [1]_, [2]_; it contains the range.
        range : tuple of float

        Notes
        -----
        Twice the drop of the profile log-likelihood is compared with chi-squared with one degree of
        freedom: asymptotically exact where inspections are at few common times or lives are known
        exactly, conservative where inspection times are continuous, as the limit is then smaller
        [3]_. Where no row is known to have ended, or all are, the end of the interval is at least
        the exact binomial one.

        References
        ----------
        .. [1] D. R. Thomas, G. L. Grunkemeier, "Confidence interval estimation of survival
           probabilities for censored data", J. Am. Stat. Assoc. 70, 865-871 (1975).
        .. [2] G. Li, "On nonparametric likelihood ratio estimation of survival probabilities for
           censored data", Stat. Probab. Lett. 25, 95-104 (1995).
        .. [3] M. Banerjee, J. A. Wellner, "Likelihood ratio tests for monotone functions", Ann.
           Stat. 29, 1699-1731 (2001).
        """
        if time not in self._answers:
            self._answers[time] = self._ended_by(time)
        return self._answers[time]

    def _ended_by(self, time: float) -> tuple[Estimate, tuple[float, float]]:
        least, most = (float(end[0]) for end in self.estimate.ended_by(np.array([time])))
        low, high = self._ends(time, least, most)
        if least != most:
            return Estimate((least + most) / 2, low, high), (least, most)
        return Estimate(least, low, high), (least, most)

    def _ends(self, time: float, least: float, most: float) -> tuple[float, float]:
        problem = _problem(self.lives, time)
        k = int(np.searchsorted(problem.high, time, side="right"))
        best = self.estimate.log_likelihood
        upper = upper_probability(self.confidence)
        critical = normal(upper)
        size = len(problem.low)
        if k in (0, size):
            return nan, nan

        def root(value: float) -> float:
            """Return the root of twice the drop in log-likelihood."""
            fixed = (k, value)
            drop = best - _maximum(problem, fixed)[1]
            return sqrt(max(2 * drop, 0.0))

        tiny = 1e-9
        low = 0.0 if least <= tiny else _crossing(root, critical, least, 0.0)
        high = 1.0 if most >= 1 - tiny else _crossing(root, critical, most, 1.0)
        lives = self.lives
        seen_beyond = float(((lives.low >= time) & (lives.entered < time)).sum())
        seen_ended = float((lives.high <= time).sum())
        if most <= tiny and seen_beyond:  # nobody ended: the exact binomial bound
            high = max(high, 1 - (1 - upper) ** (1 / seen_beyond))
        if least >= 1 - tiny and seen_ended:
            low = min(low, (1 - upper) ** (1 / seen_ended))
        return low, high


def _crossing(root: Callable[[float], float], critical: float, start: float, end: float) -> float:
    """Return where the root of the likelihood ratio, 0 at `start`, crosses its critical value."""
    inner, outer = start, end
    at_inner, at_outer = 0.0, inf
    place = start + (end - start) * min(0.5, 0.5 / (1 + critical))
    for _ in range(40):
        value = root(place)
        if abs(value - critical) < 2e-3 * critical or abs(outer - inner) < 1e-7:
            return place
        if value < critical:
            inner, at_inner = place, value
        else:
            outer, at_outer = place, value
        if np.isfinite(at_outer):
            share = (critical - at_inner) / (at_outer - at_inner)
            place = inner + (outer - inner) * min(max(share, 0.05), 0.95)
        else:
            place = (inner + outer) / 2
    return place
