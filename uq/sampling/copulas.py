"""Copulas of two inputs: conditional laws, densities, rank correlations and tail dependence.

Every copula here is exchangeable, C(u, v) = C(v, u), and is given by one number that follows from
Spearman's rank correlation; Student's also has degrees of freedom. Points are in the open unit
interval, in contiguous arrays, and each is mapped by itself.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from math import exp, log, log1p, sqrt
from typing import Any, ClassVar

import numpy as np

from uq.contract import Floats
from uq.sampling.input_faults import InputFault
from uq.sampling.unit_cube import inside

LEAST, MOST = 0.001, 0.999
"""Range of the magnitude of rank correlations of copulas other than the normal."""

LEAST_FREEDOM, MOST_FREEDOM = 1.0, 1000.0
"""Range of the degrees of freedom of Student's copula; beyond it, it is the normal copula."""

_FREEDOM = f"a number from {LEAST_FREEDOM:g} to {MOST_FREEDOM:g}"


class PairCopula(ABC):
    """Copula of two inputs."""

    reflects: ClassVar[bool] = False
    """Whether its survival copula is another copula."""

    @abstractmethod
    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return the distribution function C(u, v) = P(U <= u, V <= v), shape (n,)."""

    @abstractmethod
    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return the conditional distribution function P(V <= v | U = u), shape (n,)."""

    @abstractmethod
    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w, shape (n,)."""

    @abstractmethod
    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density of (U, V), shape (n,)."""

    @property
    @abstractmethod
    def rank_correlation(self) -> float:
        """Spearman's rank correlation."""

    @property
    @abstractmethod
    def tails(self) -> tuple[float, float]:
        """Coefficients of lower and upper tail dependence.

        The limits of P(V <= q | U <= q) for q to 0, and of P(V > q | U > q) for q to 1.
        """


@dataclass(frozen=True)
class NormalPair(PairCopula):
    """Normal (Gaussian) copula with the correlation of its normal scores."""

    correlation: float

    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return C(u, v) by quadrature of the conditional distribution function."""
        return _integrated(self, u, v)

    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return P(V <= v | U = u)."""
        from scipy.special import ndtr, ndtri

        excess = ndtri(v) - self.correlation * ndtri(u)
        return np.asarray(ndtr(excess / sqrt(1 - self.correlation**2)))

    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w."""
        from scipy.special import ndtr, ndtri

        scatter = sqrt(1 - self.correlation**2) * ndtri(w)
        return np.asarray(ndtr(self.correlation * ndtri(u) + scatter))

    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density."""
        from scipy.special import ndtri

        x, y, r = ndtri(u), ndtri(v), self.correlation
        square = (r * (x**2 + y**2) - 2 * x * y) * r / (1 - r**2)
        return np.asarray(-0.5 * (square + log1p(-(r**2))))

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation, 6 arcsin(r / 2) / pi (Pearson 1907)."""
        return float(6 / np.pi * np.arcsin(self.correlation / 2))

    @property
    def tails(self) -> tuple[float, float]:
        """No tail dependence."""
        return 0.0, 0.0


@dataclass(frozen=True)
class StudentPair(PairCopula):
    """Student's copula: normal scores over a common chi; both tails dependent, alike.

    References
    ----------
    S. Demarta, A. J. McNeil, "The t copula and related copulas", Int. Stat. Rev. 73, 111-129
    (2005).
    """

    correlation: float
    freedom: float

    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return C(u, v) by quadrature of the conditional distribution function."""
        return _integrated(self, u, v)

    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return P(V <= v | U = u): Student's law with a degree of freedom more."""
        from scipy.special import stdtr, stdtrit

        x, y = stdtrit(self.freedom, u), stdtrit(self.freedom, v)
        excess = (y - self.correlation * x) / self._scale(x)
        return np.asarray(stdtr(self.freedom + 1, excess))

    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w."""
        from scipy.special import stdtr, stdtrit

        x = stdtrit(self.freedom, u)
        y = self.correlation * x + self._scale(x) * stdtrit(self.freedom + 1, w)
        return np.asarray(stdtr(self.freedom, y))

    def _scale(self, x: Any) -> Any:
        return np.sqrt((self.freedom + x**2) * (1 - self.correlation**2) / (self.freedom + 1))

    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density."""
        from scipy.special import stdtrit

        x, y = stdtrit(self.freedom, u), stdtrit(self.freedom, v)
        return _student_log_density(x, y, self.correlation, self.freedom)

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation, E[6 arcsin(r sqrt(A B)) / pi].

        A and B are G2 / (G1 + G2) and G3 / (G1 + G3) of three gamma variables of shape nu / 2: of
        three independent pairs, given their chi, two differences are normal with correlation
        r sqrt(A B). The expectation over log(G2 / G1) and log(G3 / G1), by the trapezoidal rule.

        References
        ----------
        A. Heinen, A. Valdesogo, "Spearman rank correlation of the bivariate Student t and scale
        mixtures of normal distributions", J. Multivar. Anal. 179, 104650 (2020).
        """
        root, weight = _ratios(self.freedom)
        return float(6 / np.pi * (weight * np.arcsin(self.correlation * root)).sum())

    @property
    def tails(self) -> tuple[float, float]:
        """Tail dependence, 2 T(-sqrt((nu + 1)(1 - r) / (1 + r))) with nu + 1 degrees of freedom."""
        from scipy.special import stdtr

        nu, r = self.freedom, self.correlation
        tail = 2 * float(stdtr(nu + 1, -sqrt((nu + 1) * (1 - r) / (1 + r))))
        return tail, tail


@dataclass(frozen=True)
class ClaytonPair(PairCopula):
    """Clayton's copula, (u^-theta + v^-theta - 1)^(-1/theta), theta > 0: dependent lower tails.

    References
    ----------
    R. B. Nelsen, "An Introduction to Copulas", 2nd ed., Springer (2006), table 4.1, 4.2.1.
    """

    reflects: ClassVar[bool] = True
    theta: float

    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return C(u, v)."""
        a, b = -self.theta * np.log(u), -self.theta * np.log(v)
        return np.exp(-(a + self._more(a, b)) / self.theta)

    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return P(V <= v | U = u)."""
        a, b = -self.theta * np.log(u), -self.theta * np.log(v)
        return np.exp(-(1 + 1 / self.theta) * self._more(a, b))

    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w."""
        t = -np.log(w) * self.theta / (1 + self.theta)
        growth = t + _log_complement(t)  # the logarithm of exp(t) - 1
        return np.exp(-np.logaddexp(0.0, growth - self.theta * np.log(u)) / self.theta)

    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density."""
        a, b = -self.theta * np.log(u), -self.theta * np.log(v)
        power = 1 / self.theta
        return log1p(self.theta) + (1 + power) * b - a - (2 + power) * self._more(a, b)

    @staticmethod
    def _more(a: Floats, b: Floats) -> Floats:
        """Return log(exp(a) + exp(b) - 1) - a for positive a and b."""
        return np.logaddexp(0.0, b - a + _log_complement(b))

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation, 4 E[(1 + R (1 - Y))^(-1/theta)] - 3.

        R and Y are powers theta / 2 and theta / 3 of exp(-E), E exponential. This is 12 times the
        integral of C(u, v), less 3, in x = u^-theta / (u^-theta + ...) and their ratio.
        """
        t, weight = exponential_rule()
        power = 1 / self.theta
        less = -np.expm1(-t / (3 * power))[:, None] * np.exp(-t / (2 * power))
        return float(4 * (weight @ np.exp(-power * np.log1p(less)) @ weight) - 3)

    @property
    def tails(self) -> tuple[float, float]:
        """Lower tail dependence, 2^(-1/theta)."""
        return 2 ** (-1 / self.theta), 0.0


@dataclass(frozen=True)
class GumbelPair(PairCopula):
    """Gumbel's copula, exp(-s), s^theta = (-ln u)^theta + (-ln v)^theta: dependent upper tails.

    theta > 1. With x = -ln u and d = ln(s / x), P(V <= v | U = u) is
    exp(-x (exp(d) - 1) - (theta - 1) d).

    References
    ----------
    R. B. Nelsen, "An Introduction to Copulas", 2nd ed., Springer (2006), table 4.1, 4.2.4.
    """

    reflects: ClassVar[bool] = True
    theta: float

    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return C(u, v)."""
        x = -np.log(u)
        return np.exp(-x * np.exp(self._step(x, v)))

    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return P(V <= v | U = u)."""
        x = -np.log(u)
        step = self._step(x, v)
        return np.exp(-x * np.expm1(step) - (self.theta - 1) * step)

    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w: s by Wright's omega function, refined by Newton."""
        from scipy.special import wrightomega

        x, more = -np.log(u), self.theta - 1
        log_x, log_w = np.log(x), np.log(w)
        omega = wrightomega((x + more * log_x - log_w) / more - log(more))
        step = np.log(omega * more) - log_x
        for _ in range(3):  # a step near 0 has lost its digits
            value = x * np.expm1(step) + more * step + log_w
            step = np.abs(step - value / (x * np.exp(step) + more))
        log_y = log_x + step + _log_complement(self.theta * step) / self.theta
        return np.exp(-np.exp(log_y))

    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density."""
        x, y = -np.log(u), -np.log(v)
        log_s = np.log(x) + self._step(x, v)
        s, more = np.exp(log_s), self.theta - 1
        powers = more * (np.log(x) + np.log(y)) + (1 - 2 * self.theta) * log_s
        return x + y - s + powers + np.log(s + more)

    def _step(self, x: Floats, v: Floats) -> Floats:
        """Return ln(s / x)."""
        ratio = np.log(-np.log(v)) - np.log(x)
        return np.logaddexp(0.0, self.theta * ratio) / self.theta

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation of an extreme-value copula, 12 int (1 + A(t))^-2 dt - 3.

        A is Pickands' function, symmetric about 1/2: twice the integral over t = 1 / (1 + exp(q)).
        """
        q, weight = exponential_rule()
        pickands = np.exp(np.log1p(np.exp(-self.theta * q)) / self.theta) / (1 + np.exp(-q))
        return float(24 * weight @ ((1 + pickands) * (1 + np.exp(-q))) ** -2 - 3)

    @property
    def tails(self) -> tuple[float, float]:
        """Upper tail dependence, 2 - 2^(1/theta)."""
        return 0.0, 2 - 2 ** (1 / self.theta)


@dataclass(frozen=True)
class FrankPair(PairCopula):
    """Frank's copula, no tail dependence; theta of either sign, not 0.

    P(V <= v | U = u) has the log odds theta (v - u) + ln(1 - exp(-theta v))
    - ln(1 - exp(-theta (1 - v))). For theta < 0, V is 1 less that of -theta.

    References
    ----------
    R. B. Nelsen, "An Introduction to Copulas", 2nd ed., Springer (2006), table 4.1, 4.2.5.
    """

    theta: float

    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return C(u, v)."""
        if self.theta < 0:
            return u - FrankPair(-self.theta).joint(u, _mirrored(v))
        whole = -np.expm1(-self.theta)
        if self.theta < 1:
            part = np.expm1(-self.theta * u) * np.expm1(-self.theta * v) / whole
            return -np.log1p(-part) / self.theta
        return (log(whole) - np.logaddexp(*self._parts(u, v))) / self.theta

    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return P(V <= v | U = u)."""
        from scipy.special import expit

        if self.theta < 0:
            return 1 - FrankPair(-self.theta).conditional(_mirrored(v), u)
        above, below = self._parts(u, v)
        return np.asarray(expit(above - below))

    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w."""
        if self.theta < 0:
            return 1 - FrankPair(-self.theta).conditional_quantile(_mirrored(w), u)
        log_w, log_rest, other = np.log(w), np.log1p(-w), -self.theta * u
        if self.theta < 1:  # both logarithms below would be nearly the same
            shift = w * np.expm1(-self.theta) / (w + (1 - w) * np.exp(other))
            return -np.log1p(shift) / self.theta
        upper = np.logaddexp(log_w, log_rest + other)
        return (upper - np.logaddexp(log_rest + other, log_w - self.theta)) / self.theta

    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density."""
        if self.theta < 0:
            return FrankPair(-self.theta).log_density(u, _mirrored(v))
        constant = log(self.theta) + log(-np.expm1(-self.theta))
        return constant - self.theta * (u + v) - 2 * np.logaddexp(*self._parts(u, v))

    def _parts(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return the logarithms of two parts of exp(-theta) - 1 times the inner term of C."""
        above = _log_complement(self.theta * v) - self.theta * u
        return above, _log_complement(self.theta * (1 - v)) - self.theta * v

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation, 12 / theta int_0^1 (2 s - 1) e(theta s) ds.

        From Debye's functions, as in Nelsen, exercise 5.5, with e(x) = (x / 2) coth(x / 2) - 1.
        """
        s, weight = _legendre()
        x = self.theta * (s + 1) / 2
        square = x**2
        series = square / 12 * (1 - square / 60 * (1 - square / 42 * (1 - square / 40)))
        near, half = np.abs(x) < 0.05, np.where(x == 0, 1.0, x / 2)
        even = np.where(near, series, half / np.tanh(half) - 1)
        return float(6 / self.theta * (weight * s) @ even)

    @property
    def tails(self) -> tuple[float, float]:
        """No tail dependence."""
        return 0.0, 0.0


@dataclass(frozen=True)
class SurvivalPair(PairCopula):
    """Copula of 1 - U and 1 - V: lower and upper tails exchanged."""

    of: PairCopula

    def joint(self, u: Floats, v: Floats) -> Floats:
        """Return C(u, v)."""
        return u + v - 1 + self.of.joint(_mirrored(u), _mirrored(v))

    def conditional(self, v: Floats, u: Floats) -> Floats:
        """Return P(V <= v | U = u)."""
        return 1 - self.of.conditional(_mirrored(v), _mirrored(u))

    def conditional_quantile(self, w: Floats, u: Floats) -> Floats:
        """Return v with P(V <= v | U = u) = w."""
        return 1 - self.of.conditional_quantile(_mirrored(w), _mirrored(u))

    def log_density(self, u: Floats, v: Floats) -> Floats:
        """Return the logarithm of the density."""
        return self.of.log_density(_mirrored(u), _mirrored(v))

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation, unchanged."""
        return self.of.rank_correlation

    @property
    def tails(self) -> tuple[float, float]:
        """Coefficients of lower and upper tail dependence."""
        lower, upper = self.of.tails
        return upper, lower


NORMAL, STUDENT = "normal", "student"

COPULAS: dict[str, str] = {
    NORMAL: "no tail dependence",
    STUDENT: "both tails dependent; needs degrees_of_freedom",
    "clayton": "lower tails dependent",
    "gumbel": "upper tails dependent",
    "frank": "no tail dependence",
}
"""Copula -> its tail dependence."""

_Family = Callable[[float], PairCopula]

_POSITIVE: dict[str, tuple[_Family, float, float]] = {
    "clayton": (lambda x: ClaytonPair(exp(x)), -9.0, 9.0),
    "gumbel": (lambda x: GumbelPair(1 + exp(x)), -9.0, 9.0),
    "frank": (lambda x: FrankPair(exp(x)), -7.0, 9.0),
}
"""Copula -> the copula of the logarithm of its parameter, and the ends of the search for it."""


def copula_problem(
    names: tuple[str, ...],
    rank: float,
    name: str,
    freedom: float | None = None,
    survival: bool = False,
) -> InputFault | None:
    """Return the fault of a copula other than the normal; None if it is valid.

    Parameters
    ----------
    names : tuple of str
        The parameters.
    rank : float
        Rank correlation of the first two.
    name : str
        As in `COPULAS`.
    freedom : float or None
        Degrees of freedom, for Student's copula only.
    survival : bool

    Returns
    -------
    InputFault or None
    """
    if name != STUDENT and freedom is not None:
        return InputFault(("degrees_of_freedom",), 'is only for copula = "student"', freedom)
    if survival and not has_survival(name):
        able = ", ".join(f'"{other}"' for other in COPULAS if has_survival(other))
        problem = f'is only for copula = {able}: "{name}" has the same tails above and below'
        return InputFault(("survival",), problem, survival)
    if name == NORMAL:
        return None
    if len(names) != 2:
        problem = f'is for two parameters, and there are {len(names)}; use "normal"'
        return InputFault(("copula",), problem, name)
    if name == STUDENT and freedom is None:
        return InputFault(("degrees_of_freedom",), f'is missing for "student": {_FREEDOM}')
    if freedom is not None and not LEAST_FREEDOM <= freedom <= MOST_FREEDOM:
        return InputFault(("degrees_of_freedom",), f"must be {_FREEDOM}", freedom)
    least = {STUDENT: -MOST, "frank": -MOST}.get(name, LEAST)
    if not least <= rank <= MOST:
        more = '; for a negative one use "student", "frank" or "normal"' if rank < 0 else ""
        problem = f'must be between {least:g} and {MOST:g} for copula = "{name}"{more}'
        return InputFault(("rank_correlation",), problem, rank)
    if name == "frank" and abs(rank) < LEAST:
        problem = f'must be {LEAST:g} or more from 0 for copula = "frank"; without it, leave it out'
        return InputFault(("rank_correlation",), problem, rank)
    return None


def has_survival(name: str) -> bool:
    """Return whether the survival copula of a copula is another copula."""
    return name in _POSITIVE and _POSITIVE[name][0](0.0).reflects


@lru_cache(maxsize=64)
def copula_of_rank(
    name: str, rank: float, freedom: float | None = None, survival: bool = False
) -> PairCopula:
    """Return the copula with a rank correlation.

    Parameters
    ----------
    name : str
        As in `COPULAS`.
    rank : float
        Spearman's rank correlation, valid by `copula_problem`.
    freedom : float or None
        Degrees of freedom of Student's copula.
    survival : bool
        Whether its lower and upper tails are exchanged.

    Returns
    -------
    PairCopula
        Its rank correlation is the given one to 1e-12.
    """
    if name == NORMAL:
        return NormalPair(float(2 * np.sin(np.pi / 6 * rank)))
    # Imported late; the laws of inputs import scipy.stats, which imports it, too.
    from scipy.optimize import brentq

    def at(x: float) -> PairCopula:
        if name == STUDENT:
            assert freedom is not None
            return StudentPair(float(np.tanh(x)), freedom)
        return _POSITIVE[name][0](x)

    ends = (0.0, 9.0) if name == STUDENT else _POSITIVE[name][1:]
    x = brentq(lambda x: at(x).rank_correlation - abs(rank), *ends, xtol=1e-14, rtol=1e-14)
    copula = at(float(x))
    if rank < 0:
        copula = (
            StudentPair(-copula.correlation, copula.freedom)
            if isinstance(copula, StudentPair)
            else FrankPair(-copula.theta)  # type: ignore[attr-defined]
        )
    return SurvivalPair(copula) if survival else copula


def fitted_copula(name: str, u: Floats, v: Floats, survival: bool = False) -> PairCopula:
    """Return the copula with the largest likelihood of pairs of points.

    Parameters
    ----------
    name : str
        As in `COPULAS`.
    u, v : ndarray, shape (n,)
        Ranks over n + 1.
    survival : bool
        Whether lower and upper tails are exchanged.

    Returns
    -------
    PairCopula
        Clayton's and Gumbel's copula have no negative dependence: where the points have, it is that
        of the weakest dependence.

    References
    ----------
    C. Genest, K. Ghoudi, L.-P. Rivest, "A semiparametric estimation procedure of dependence
    parameters in multivariate families of distributions", Biometrika 82, 543-552 (1995).
    """
    if survival:
        return SurvivalPair(fitted_copula(name, _mirrored(u), _mirrored(v)))
    if name == STUDENT:
        return _fitted_student(u, v)
    if name == "frank" and np.corrcoef(u, v)[0, 1] < 0:
        mirrored = fitted_copula(name, u, _mirrored(v))
        return FrankPair(-mirrored.theta)  # type: ignore[attr-defined]

    def at(x: float) -> PairCopula:
        return NormalPair(float(np.tanh(x))) if name == NORMAL else _POSITIVE[name][0](x)

    ends = (-9.0, 9.0) if name == NORMAL else _POSITIVE[name][1:]
    return at(_lowest(lambda x: -float(at(x).log_density(u, v).sum()), ends, 1e-7))


def _fitted_student(u: Floats, v: Floats) -> StudentPair:
    """Return Student's copula of the largest likelihood: of each freedom, then of all."""
    from scipy.special import stdtrit

    def of_freedom(log_freedom: float) -> tuple[float, StudentPair]:
        freedom = exp(log_freedom)
        x, y = stdtrit(freedom, u), stdtrit(freedom, v)

        def loss(z: float) -> float:
            return -float(_student_log_density(x, y, float(np.tanh(z)), freedom).sum())

        z = _lowest(loss, (-9.0, 9.0), 1e-7)
        return loss(z), StudentPair(float(np.tanh(z)), freedom)

    ends = log(LEAST_FREEDOM), log(MOST_FREEDOM)
    return of_freedom(_lowest(lambda x: of_freedom(x)[0], ends, 1e-3))[1]


def _lowest(loss: Callable[[float], float], ends: tuple[float, float], tolerance: float) -> float:
    """Return the place of the minimum of a function between two ends."""
    from scipy.optimize import minimize_scalar

    return float(minimize_scalar(loss, bounds=ends, options={"xatol": tolerance}).x)


def _student_log_density(x: Any, y: Any, r: float, nu: float) -> Floats:
    """Return the logarithm of the density of Student's copula at scores x and y."""
    from scipy.special import gammaln

    constant = gammaln(nu / 2 + 1) + gammaln(nu / 2) - 2 * gammaln((nu + 1) / 2)
    square = (x**2 - 2 * r * x * y + y**2) / (1 - r**2)
    alone = (nu + 1) / 2 * (np.log1p(x**2 / nu) + np.log1p(y**2 / nu))
    together = (nu / 2 + 1) * np.log1p(square / nu) + 0.5 * log1p(-(r**2))
    return np.asarray(constant + alone - together)


def _mirrored(u: Floats) -> Floats:
    """Return 1 - u, within (0, 1)."""
    return inside(1 - u)


def _log_complement(x: Floats) -> Floats:
    """Return log(1 - exp(-x)) for positive x."""
    return np.log(-np.expm1(-x))


def _integrated(copula: PairCopula, u: Floats, v: Floats) -> Floats:
    """Return C(u, v), the integral of P(V <= v | U = s) over s up to u, for s = u exp(-t)."""
    t, weight = exponential_rule()
    total = np.zeros(np.shape(u))
    for at, worth in zip(t, weight, strict=True):
        total += worth * copula.conditional(v, u * np.exp(-at))
    return u * total


@cache
def exponential_rule() -> tuple[Floats, Floats]:
    """Return nodes and weights of means over the exponential law, on any scale of the argument.

    References
    ----------
    H. Takahasi, M. Mori, "Double exponential formulas for numerical integration", Publ. RIMS 9,
    721-741 (1974): t = exp(q - exp(-q)), the trapezoidal rule over q.
    """
    q = np.arange(-4.0, 3.75, 1 / 24)
    t = np.exp(q - np.exp(-q))
    return t, np.exp(-t) * t * (1 + np.exp(-q)) / 24


@cache
def _legendre() -> tuple[Floats, Floats]:
    return np.polynomial.legendre.leggauss(100)


@lru_cache(maxsize=8)
def _ratios(freedom: float) -> tuple[Floats, Floats]:
    """Return sqrt(A B) of `StudentPair.rank_correlation` at the nodes, and their weights."""
    k = freedom / 2
    width = sqrt(2 / k)
    step = min(0.35, width / 4)
    g = np.arange(-40 / k - 9 * width, 40 / k + 9 * width, step)
    ratio = np.exp(g)
    log_weight = k * (g[:, None] + g) - 3 * k * np.log1p(ratio[:, None] + ratio)
    weight = np.exp(log_weight - log_weight.max())
    root = np.sqrt(ratio / (1 + ratio))
    return np.outer(root, root), weight / weight.sum()
