"""Maximum likelihood for laws of lives under censoring, intervals and late entry.

Each law is a scale family, perhaps shifted. Likelihoods are maximised over transformed parameters
without bounds; intervals are those that the likelihood ratio does not reject.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, inf, isfinite, isnan, log, log1p, nan, sqrt
from typing import Any

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.stats.estimate import Estimate
from uq.stats.interval_censoring import LifeIntervals
from uq.stats.intervals import CONFIDENCE, upper_probability
from uq.stats.quantile_functions import normal

LogFunction = Callable[[Floats, Floats], Floats]
"""Function of times over the scale, shape (n,), and of the transformed other parameters."""

_FARTHEST = 12.0  # from the maximum to an end of an interval, on a logarithmic scale
_SHORTEST = 1e-3  # step of a logarithm towards the end of an interval
_STEEPEST = 6.0  # logarithm of a shape, beyond which a law is a step
_WORST = 1e100


@dataclass(frozen=True)
class LifeLaw:
    """A law of lives with a scale.

    Attributes
    ----------
    names : tuple of str
        Of its parameters as reported.
    log_density, log_survival : callable
        Of lives over the scale.
    quantile : callable
        ``quantile(p, others)`` -> of lives over the scale.
    starts : tuple of tuple
        Transformed other parameters from which to search.
    reported : callable
        ``reported(scale, others, earliest)`` -> the parameters by name.
    has_threshold : bool
        Whether the first of the others is a threshold before which no life ends.
    steep : tuple of int
        Which of the others are logarithms of shapes: large ones mean that there is no maximum.
    """

    names: tuple[str, ...]
    log_density: LogFunction
    log_survival: LogFunction
    quantile: Callable[[float, Floats], float]
    starts: tuple[tuple[float, ...], ...]
    reported: Callable[[float, Floats, float], tuple[float, ...]]
    has_threshold: bool = False
    steep: tuple[int, ...] = ()


def _weibull_density(w: Floats, shape: float) -> Floats:
    with np.errstate(divide="ignore"):
        return log(shape) + (shape - 1) * np.log(w) - w**shape


def _of_shape(place: int, function: Callable[[Floats, float], Floats]) -> LogFunction:
    return lambda w, others: function(w, exp(min(others[place], 50.0)))


def _normal_density(w: Floats, others: Floats) -> Floats:
    z = np.log(w) / exp(others[0])
    return -0.5 * z**2 - 0.5 * log(2 * np.pi) - others[0] - np.log(w)


def _normal_survival(w: Floats, others: Floats) -> Floats:
    with np.errstate(divide="ignore"):
        return np.asarray(special.log_ndtr(-np.log(w) / exp(others[0])))


def _gamma_density(w: Floats, shape: float) -> Floats:
    with np.errstate(divide="ignore"):
        return (shape - 1) * np.log(w) - w - special.gammaln(shape)


def _gamma_survival(w: Floats, shape: float) -> Floats:
    with np.errstate(divide="ignore"):
        return np.log(special.gammaincc(shape, w))


def _mixed(w: Floats, others: Floats) -> tuple[float, tuple[float, float], Floats]:
    """Return the share of the first population, both shapes, and times over the second scale."""
    others = np.clip(others, -40, 40)
    return float(special.expit(others[0])), (exp(others[1]), exp(others[2])), w / exp(others[3])


def _mixture_density(w: Floats, others: Floats) -> Floats:
    share, (first, second), later = _mixed(w, others)
    rest = float(special.expit(-others[0]))
    return np.logaddexp(
        _weibull_density(w, first) + log(share),
        _weibull_density(later, second) - others[3] + log(rest),
    )


def _mixture_survival(w: Floats, others: Floats) -> Floats:
    share, (first, second), later = _mixed(w, others)
    with np.errstate(divide="ignore"):
        return np.log(share * np.exp(-(w**first)) + (1 - share) * np.exp(-(later**second)))


def _mixture_quantile(p: float, others: Floats) -> float:
    """Return where Newton steps in the logarithm of the time end, safeguarded by bisection."""
    share, (first, second), _ = _mixed(np.ones(1), others)
    ratio = min(max(float(others[3]), -40.0), 40.0)
    spread = log(-log1p(-p))
    # The quantile is between those of the two populations.
    low, high = sorted((spread / first, ratio + spread / second))
    x = share * low + (1 - share) * high
    for _ in range(200):
        hazards = exp(min(first * x, 700.0)), exp(min(second * (x - ratio), 700.0))
        alive = share * exp(-hazards[0]), (1 - share) * exp(-hazards[1])
        excess = 1 - sum(alive) - p
        slope = alive[0] * first * hazards[0] + alive[1] * second * hazards[1]
        if excess > 0:
            high = x
        else:
            low = x
        moved = x - excess / slope if slope > 0 else nan
        if not low < moved < high:
            moved = (low + high) / 2
        if abs(moved - x) <= 1e-14 * max(1.0, abs(x)):
            break
        x = moved
    return exp(min(x, 600.0))


def _mixture_reported(scale: float, others: Floats, earliest: float) -> tuple[float, ...]:
    share = float(special.expit(others[0]))
    return share, exp(others[1]), scale, exp(others[2]), scale * exp(others[3])


_MIXTURE_STARTS = tuple(
    (share, first, second, ratio)
    for share in (-1.5, 0.0, 1.5)
    for first, second in ((0.0, 1.0), (1.0, 1.0))
    for ratio in (1.0, 2.5)
)

LAWS: dict[str, LifeLaw] = {
    "weibull": LifeLaw(
        ("shape", "scale"),
        _of_shape(0, _weibull_density),
        _of_shape(0, lambda w, shape: -(w**shape)),
        lambda p, others: (-log(1 - p)) ** exp(-others[0]),
        ((0.3,), (1.2,)),
        lambda scale, others, _: (exp(others[0]), scale),
        steep=(0,),
    ),
    "lognormal": LifeLaw(
        ("median", "sigma"),
        _normal_density,
        _normal_survival,
        lambda p, others: exp(exp(others[0]) * normal(p)),
        ((-0.5,), (0.3,)),
        lambda scale, others, _: (scale, exp(others[0])),
    ),
    "gamma": LifeLaw(
        ("shape", "scale"),
        _of_shape(0, _gamma_density),
        _of_shape(0, _gamma_survival),
        lambda p, others: float(special.gammaincinv(exp(others[0]), p)),
        ((0.3,), (1.5,)),
        lambda scale, others, _: (exp(others[0]), scale),
        steep=(0,),
    ),
    "exponential": LifeLaw(
        ("mean",),
        lambda w, others: -w,
        lambda w, others: -w,
        lambda p, others: -log(1 - p),
        ((),),
        lambda scale, others, _: (scale,),
    ),
    "weibull-3": LifeLaw(
        ("shape", "scale", "threshold"),
        _of_shape(1, _weibull_density),
        _of_shape(1, lambda w, shape: -(w**shape)),
        lambda p, others: (-log(1 - p)) ** exp(-others[1]),
        ((-1.0, 0.3), (1.0, 0.3), (3.0, 0.5), (-2.0, 1.0)),
        lambda scale, others, earliest: (
            exp(others[1]),
            scale,
            earliest * float(special.expit(others[0])),
        ),
        has_threshold=True,
        steep=(1,),
    ),
    "weibull-mixture": LifeLaw(
        ("share", "shape_1", "scale_1", "shape_2", "scale_2"),
        _mixture_density,
        _mixture_survival,
        _mixture_quantile,
        _MIXTURE_STARTS,
        _mixture_reported,
        steep=(1, 2),
    ),
}
"""Name -> law: of two and one parameters, shifted by a threshold, and of two populations."""


class NoMaximumError(Exception):
    """The likelihood has no maximum; the message says why."""


@dataclass(frozen=True)
class LawFit:
    """A law with its maximum likelihood estimates.

    Attributes
    ----------
    law : LifeLaw
    log_likelihood : float
    parameters, quantiles : dict of str to Estimate
        With profile-likelihood intervals; an end is NaN where the likelihood ratio never rejects,
        or where the likelihood is unbounded before it does.
    ended_by : callable
        Times -> P(T <= t) of the law.
    """

    law: LifeLaw
    log_likelihood: float
    parameters: Mapping[str, Estimate]
    quantiles: Mapping[str, Estimate]
    ended_by: Callable[[Floats], Floats]


class _Likelihood:
    """The log-likelihood of a law, in units of a typical life.

    Parameters are the logarithm of the scale, then the others.
    """

    def __init__(self, law: LifeLaw, lives: LifeIntervals):
        rows, count = np.unique(np.stack(lives), axis=1, return_counts=True)
        low, high, entered = rows
        ends = np.where(np.isfinite(high), high, low)
        self.unit = float(np.median(ends[ends > 0])) if (ends > 0).any() else 1.0
        self.law, self.count = law, count.astype(float)
        self.low, self.high, self.entered = low / self.unit, high / self.unit, entered / self.unit
        self.exact = self.low == self.high
        self.within = ~self.exact & np.isfinite(self.high)
        self.open = ~self.exact & ~self.within
        self.late = self.entered > 0
        # No life may end before the threshold.
        self.earliest = float(np.where(self.exact, self.low, self.high).min(initial=inf))
        self.exact_count = self.count[self.exact]

    def threshold(self, others: Floats) -> float:
        """Return the threshold of a shifted law, else 0."""
        return self.earliest * float(special.expit(others[0])) if self.law.has_threshold else 0.0

    def __call__(self, theta: Floats) -> float:
        """Return the log-likelihood per row, very small where it does not exist."""
        with np.errstate(all="ignore"):
            value = self._value(theta)
        return value if isfinite(value) else -_WORST

    def _value(self, theta: Floats) -> float:
        scale, others, law = (
            exp(np.clip(theta[0], -200, 200)),
            np.clip(theta[1:], -40, 40),
            self.law,
        )
        shift = self.threshold(others)

        def survival(time: Floats) -> Floats:
            w = np.maximum((time - shift) / scale, 0.0)
            return np.where(w > 0, law.log_survival(np.where(w > 0, w, 1.0), others), 0.0)

        total = 0.0
        if self.exact.any():
            density = law.log_density((self.low[self.exact] - shift) / scale, others)
            total += float(self.exact_count @ (density - log(scale)))
        if self.open.any():
            total += float(self.count[self.open] @ survival(self.low[self.open]))
        if self.within.any():
            above, below = survival(self.low[self.within]), survival(self.high[self.within])
            total += float(self.count[self.within] @ (above + np.log(-np.expm1(below - above))))
        if self.late.any():
            total -= float(self.count[self.late] @ survival(self.entered[self.late]))
        return total

    def maximise(
        self,
        start: Floats,
        build: Callable[[Floats], Floats],
        *,
        is_near: bool = False,
        inverse: Floats | None = None,
        gradient: float = 1e-4,
    ) -> tuple[Floats, float]:
        """Return the free parameters with the largest likelihood, and it.

        From a start that is near it, without a simplex, until the gradient is small; `inverse` is
        that of the information there.
        """
        from scipy import optimize  # here: its import takes long

        if not len(start):
            return start, self(build(start))

        def loss(free: Floats) -> float:
            return -self(build(free))

        if is_near:
            options: Any = {"gtol": gradient}
            if inverse is not None:
                options["hess_inv0"] = inverse
            result = optimize.minimize(loss, start, method="BFGS", options=options)
            if result.fun < _WORST:
                return np.asarray(result.x), -float(result.fun)
        simplex = optimize.minimize(
            loss,
            start,
            method="Nelder-Mead",
            options={"xatol": 1e-7, "fatol": 1e-9, "maxiter": 600 * len(start), "adaptive": True},
        )
        smooth = optimize.minimize(loss, simplex.x, method="BFGS", options={"gtol": 1e-7})
        best = smooth if smooth.fun <= simplex.fun else simplex
        return np.asarray(best.x), -float(best.fun)


def fit_law(name: str, lives: LifeIntervals, probabilities: Mapping[str, float]) -> LawFit:
    """Fit a law of lives by maximum likelihood.

    Parameters
    ----------
    name : str
        Of `LAWS`.
    lives : LifeIntervals
        Of independent rows.
    probabilities : dict of str to float
        Quantiles to report, by name.

    Returns
    -------
    LawFit

    Raises
    ------
    NoMaximumError
        The likelihood has no maximum, or one at the edge of what the law allows.

    Notes
    -----
    A row contributes the density of an exact life, the survival function of a censored one, and the
    probability of an interval, each divided by the survival function at its entry [1]_. The
    likelihood of the law with a threshold is unbounded where the threshold reaches the first life;
    the local maximum is taken [2]_, as for the two populations. Intervals compare twice the drop of
    the profile log-likelihood with chi-squared with one degree of freedom [1]_.

    References
    ----------
    .. [1] W. Q. Meeker, L. A. Escobar, "Statistical methods for reliability data", Wiley (1998),
       chapters 8 and 11.
    .. [2] R. L. Smith, "Maximum likelihood estimation in a class of nonregular cases", Biometrika
       72, 67-90 (1985).
    """
    law = LAWS[name]
    likelihood = _Likelihood(law, lives)
    ended = int((likelihood.count * ~likelihood.open).sum())
    if ended < len(law.names):
        raise NoMaximumError(
            f"the likelihood has no maximum: {ended} ended, {len(law.names)} are needed"
        )
    theta, best = _highest(likelihood)
    unit, earliest = likelihood.unit, likelihood.earliest * likelihood.unit
    at = dict(zip(law.names, law.reported(exp(theta[0]) * unit, theta[1:], earliest), strict=True))
    parameters = {
        key: _profile(likelihood, theta, best, value, _of_parameter(likelihood, key))
        for key, value in at.items()
    }
    quantiles = {}
    for key, p in probabilities.items():
        value = unit * (
            exp(theta[0]) * law.quantile(p, theta[1:]) + likelihood.threshold(theta[1:])
        )
        quantiles[key] = _profile(likelihood, theta, best, value, _of_quantile(likelihood, p))

    def ended_by(time: Floats) -> Floats:
        w = (np.asarray(time) / unit - likelihood.threshold(theta[1:])) / exp(theta[0])
        positive = w > 0
        with np.errstate(all="ignore"):
            share = -np.expm1(law.log_survival(np.where(positive, w, 1.0), theta[1:]))
        return np.where(positive, share, 0.0)

    of_exact = float(likelihood.exact_count.sum()) * log(unit)
    return LawFit(law, best - of_exact, parameters, quantiles, ended_by)


def _highest(likelihood: _Likelihood) -> tuple[Floats, float]:
    """Return the transformed parameters with the largest proper maximum, and it."""
    law, reasons, proper = likelihood.law, list[str](), list[tuple[float, Floats]]()
    for start in law.starts:
        for scale in (-0.7, 0.0) if len(law.starts) > 2 else (0.0,):
            near = len(law.starts) > 2
            theta, value = likelihood.maximise(
                np.array([scale, *start]), lambda free: free, is_near=near
            )
            if value <= -_WORST:
                continue
            if why := _improper(likelihood, theta):
                reasons.append(why)
            else:
                proper.append((value, theta))
    if not proper:
        raise NoMaximumError(reasons[0] if reasons else "the likelihood has no maximum")
    near = len(law.starts) > 2
    for _, coarse in sorted(proper, key=lambda pair: -pair[0]):
        theta, value = likelihood.maximise(coarse, lambda free: free, is_near=near, gradient=1e-7)
        if not (why := _improper(likelihood, theta)):
            break
    else:
        raise NoMaximumError(why)
    if law.names[0] == "share" and theta[4] < 0:  # the first population ends first
        theta = np.array([theta[0] + theta[4], -theta[1], theta[3], theta[2], -theta[4]])
    return theta, value


def _improper(likelihood: _Likelihood, theta: Floats) -> str:
    """Return why a point where the search ended is no proper maximum, or ""."""
    law, others = likelihood.law, theta[1:]
    if abs(theta[0]) > 15:
        return "the likelihood has no maximum: it increases as the scale grows"
    if law.has_threshold and others[0] < -8:
        return "the likelihood is largest with a threshold of 0: take the law without"
    if why := _degenerate(likelihood, others):
        return why
    curvature = _curvature(likelihood, theta)
    if not np.isfinite(curvature).all() or np.linalg.eigvalsh(curvature).max() > -1e-6:
        return "the likelihood has no unique maximum: it is flat along a combination of parameters"
    return ""


def _degenerate(likelihood: _Likelihood, others: Floats) -> str:
    """Return why the likelihood is unbounded near parameters, or ""."""
    law = likelihood.law
    if any(others[place] > _STEEPEST for place in law.steep) or (
        law.names == ("median", "sigma") and others[0] < -_STEEPEST
    ):
        return "the likelihood has no maximum: it increases as all lives become equal"
    if law.has_threshold:
        if others[0] > 8 or others[1] <= 0:
            return "the likelihood has no maximum: it increases as the threshold reaches a life"
    if law.names[0] == "share":
        few = min(special.expit(others[0]), special.expit(-others[0]))
        if few * likelihood.count.sum() < 2 or max(others[1], others[2]) > 4:
            return "the likelihood has no maximum: one population shrinks to a single life"
        if min(others[1], others[2]) < -2 or abs(others[3]) > 7:
            return "the likelihood has no maximum: one population spreads over all times"
    return ""


def _curvature(likelihood: Callable[[Floats], float], theta: Floats) -> Floats:
    """Return the matrix of second derivatives by central differences."""
    d, step = len(theta), 1e-3
    moves = np.eye(d) * step
    matrix = np.empty((d, d))
    for i in range(d):
        for j in range(i, d):
            values = [
                likelihood(theta + a * moves[i] + b * moves[j]) for a in (1, -1) for b in (1, -1)
            ]
            matrix[i, j] = matrix[j, i] = (values[0] - values[1] - values[2] + values[3]) / (
                4 * step**2
            )
    return matrix


def _inverse_information(curvature: Floats) -> Floats | None:
    """Return the inverse of the negative curvature; None where it is not positive definite."""
    if not len(curvature) or not np.isfinite(curvature).all():
        return None
    if np.linalg.eigvalsh(-curvature).min() <= 1e-8:
        return None
    inverse = np.linalg.inv(-curvature)
    return np.asarray((inverse + inverse.T) / 2)


_Constraint = Callable[[float, Floats], Floats]
"""``build(value, theta)`` -> theta with the number of interest at a value, others as given."""


def _of_quantile(likelihood: _Likelihood, p: float) -> tuple[int, _Constraint]:
    """Return the parameter that a value of a quantile determines, and how."""

    def build(value: float, theta: Floats) -> Floats:
        others = theta[1:]
        beyond = value / likelihood.unit - likelihood.threshold(others)
        try:
            standard = likelihood.law.quantile(p, others)
        except OverflowError:  # a search tries parameters far from all data
            standard = nan
        scale = log(beyond / standard) if beyond > 0 and standard > 0 else nan
        return np.concatenate([[scale], others])

    return 0, build


def _of_parameter(likelihood: _Likelihood, name: str) -> tuple[int, _Constraint]:
    """Return the transformed parameter that a value of a parameter determines, and how."""
    law = likelihood.law
    place = {
        "scale": 0, "median": 0, "mean": 0, "scale_1": 0, "scale_2": 0,
        "sigma": 1, "share": 1, "threshold": 1, "shape": 2 if law.has_threshold else 1,
        "shape_1": 2, "shape_2": 3,
    }[name]  # fmt: skip

    def build(value: float, theta: Floats) -> Floats:
        theta = theta.copy()
        size = likelihood.unit
        if name == "share":
            theta[1] = special.logit(value)
        elif name == "threshold":
            theta[1] = special.logit(value / (likelihood.earliest * size))
        elif name == "scale_2":
            theta[0] = log(value / size) - theta[4]
        else:
            theta[place] = log(value / size) if place == 0 else log(value)
        return theta

    return place, build


def _profile(
    likelihood: _Likelihood,
    theta: Floats,
    best: float,
    value: float,
    constraint: tuple[int, _Constraint],
    confidence: float = CONFIDENCE,
) -> Estimate:
    """Return a number with the interval that the likelihood ratio does not reject."""
    place, build = constraint
    critical = normal(upper_probability(confidence))
    is_share = likelihood.law.names[0] == "share" and place == 1
    link, back = (special.logit, special.expit) if is_share else (np.log, np.exp)
    centre = float(link(value))
    free_places = [i for i in range(len(theta)) if i != place]

    def whole(at: float, free: Floats) -> Floats:
        given = theta.copy()
        given[free_places] = free
        with np.errstate(all="ignore"):
            return build(float(back(at)), given)

    others = list[Floats]()
    if likelihood.law.has_threshold:  # several maxima: also from the largest, and a threshold of 0
        others = [theta[free_places]]
        others += [np.where(np.array(free_places) == 1, -8.0, others[0])] * (place != 1)
    inverse = _inverse_information(
        _curvature(lambda free: likelihood(whole(centre, free)), theta[free_places])
    )

    def end(sign: float) -> float:
        path = [(centre, theta[free_places])]

        def root(at: float) -> float:
            (before, start), (last, free) = path[-2:] if len(path) > 1 else path * 2
            if last != before:
                free = free + (at - last) / (last - before) * (free - start)
            maxima = [
                likelihood.maximise(
                    begin, lambda free: whole(at, free), is_near=True, inverse=inverse
                )
                for begin in (free, *others)
            ]
            bounded = [
                (reached, place)
                for place, (free, reached) in enumerate(maxima)
                if not _degenerate(likelihood, whole(at, free)[1:])
            ]
            if not bounded:
                return nan
            reached, place = max(bounded)
            path.append((at, maxima[place][0]))
            return sqrt(max(2 * (best - reached), 0.0))

        inner, outer, at_inner, at_outer = centre, nan, 0.0, nan
        step = 0.1
        while not outer == outer:
            at = inner + sign * step
            if abs(at - centre) > _FARTHEST:
                return nan
            height = root(at)
            if height < critical:
                # Never so short that a profile which levels off below the limit is not passed.
                ratio = (critical - height) / max(height - at_inner, 1e-6)
                step = max(min(max(1.1 * step * ratio, 0.3 * step), 4 * step), _SHORTEST)
                inner, at_inner = at, height
            else:
                outer, at_outer = at, height
        for _ in range(60):
            share = min(max((critical - at_inner) / (at_outer - at_inner), 0.02), 0.98)
            if isnan(at_outer):  # halve the way to where the likelihood is unbounded
                share = 0.5
                if abs(outer - inner) < 1e-3:
                    return nan
            at = inner + share * (outer - inner)
            height = root(at)
            if abs(height - critical) < 2e-4 or abs(outer - inner) < 1e-9:
                break
            if height < critical:
                inner, at_inner = at, height
            else:
                outer, at_outer = at, height
        return float(back(at))

    return Estimate(value, end(-1.0), end(1.0))
