"""Laws fitted to lifetimes by maximum likelihood, and refused where they do not fit."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from math import nan
from typing import Any

import numpy as np
import pandas as pd

from uq.assess.observed_lives import ObservedLives
from uq.assess.statistics.quantiles import B_LIVES
from uq.contract import Floats, Mask
from uq.errors import InputError, choices, nearest
from uq.result.element import Element
from uq.result.result import AnyResult, Result
from uq.stats.estimate import Estimate
from uq.stats.interval_censoring import LifeIntervals
from uq.stats.intervals import CONFIDENCE, upper_probability
from uq.stats.life_likelihood import LAWS, NoMaximumError, fit_law
from uq.stats.location_scale import FAMILIES, Family, anderson_darling, fit
from uq.stats.order_statistics import is_within
from uq.text.numbers import counted

MIN_ENDED = 20
"""With fewer ended lives than this every law fits."""

MAX_ROWS = 2000
"""More rows would reject every law for negligible differences."""

REFITS = 4999
"""Samples drawn from the fitted law and refitted; for large samples fewer, down to a fifth.

The coverage of an interval of 95 % is then known to 0.3 %; with a fifth of them, to 0.7 %.
"""

MOST_DRAWN = 400 * REFITS
"""Lives drawn for all of them together, at most."""

LEVEL = 0.05

INDEPENDENT_ONLY = (
    "the test of fit requires independent rows; use method = 'monte-carlo' with one row a sample,"
    " or, of imported rows that are independent, independent = true"
)

ASSUMES = (
    "that lives follow this law: passing a test with {rows} rows is no proof, in particular beyond"
    " the range of the rows"
)
"""Assumption behind every number of an accepted law."""


@dataclass(frozen=True)
class Fit:
    """A law fitted to a lifetime, or the reason why it does not apply.

    Attributes
    ----------
    rows : int
        Number of rows used.
    p_value : float
        Of the Anderson-Darling test, its law from refits; NaN where there is no fit.
    refused : str
        Why the law does not apply, or ""; then there is nothing below.
    parameters : dict of str to Estimate
        Shape and scale [s], or median [s] and sigma, named as in study files.
    b_lives : dict of str to Estimate
        ``B1``, ``B10``, ``B50`` [s].
    extrapolated : frozenset of str
        B-lives earlier than the rows reach, 1/(n + 1).
    assumes : str
        Assumption behind all of these.
    log_likelihood : float
        At its maximum; NaN of a law whose fit was tested instead.
    """

    rows: int
    p_value: float = nan
    refused: str = ""
    parameters: Mapping[str, Estimate] = field(default_factory=dict)
    b_lives: Mapping[str, Estimate] = field(default_factory=dict)
    extrapolated: frozenset[str] = frozenset()
    assumes: str = ""
    log_likelihood: float = nan

    @property
    def aic(self) -> float:
        """Akaike's information criterion: the smaller, the better."""
        return 2 * len(self.parameters) - 2 * self.log_likelihood


def fits_of(
    element: Element,
    independent: bool,
    of_record: bool = False,
    laws: Collection[str] = tuple(LAWS),
) -> dict[str, Fit]:
    """Fit every law to one element of a lifetime; name of the law -> `Fit`.

    Weibull and lognormal laws of plain rows are tested. All laws of lives from the field (however
    few), of lives known within intervals and of rows that entered late, and the other laws in any
    case, are by maximum likelihood (`uq.stats.life_likelihood.fit_law`), without a test.

    References
    ----------
    J. F. Lawless, "Statistical models and methods for lifetime data", 2nd ed., Wiley (2003), 5.
    """
    by_likelihood = of_record or element.has_intervals_or_entries
    tested = () if by_likelihood else [law for law in FAMILIES if law in laws]
    fits = {law: _fit(law, element, independent) for law in tested}
    least = 0 if by_likelihood else MIN_ENDED
    others = {
        law: _fit_by_likelihood(law, element, independent, least) for law in laws if law not in fits
    }
    return fits | others


LIKELIHOOD_ASSUMES = (
    "that lives follow this law, which is not tested: compare aic, and the law with the rows on"
    " probability paper"
)


def _fit_by_likelihood(law: str, element: Element, independent: bool, least: int) -> Fit:
    sample = ObservedLives(element)
    lives = LifeIntervals(*(column[:MAX_ROWS] for column in sample.lives))
    rows, life = len(lives), element.at_least[:MAX_ROWS]
    ended = (~element.censored | element.within_interval)[element.present][:MAX_ROWS]
    zeros = 0 if law == "exponential" else _zeros(element)
    if problem := _problem(life, ended, independent, zeros, least):
        return Fit(rows, refused=problem)
    try:
        fitted = fit_law(law, lives, B_LIVES)
    except NoMaximumError as refusal:
        return Fit(rows, refused=str(refusal))
    return Fit(
        rows,
        parameters=fitted.parameters,
        b_lives=fitted.quantiles,
        extrapolated=frozenset(name for name, p in B_LIVES.items() if not is_within(p, rows)),
        assumes=LIKELIHOOD_ASSUMES,
        log_likelihood=fitted.log_likelihood,
    )


_Lives = tuple[Floats, Mask]
"""Logarithms of lives, ascending, and which of them ended; shapes (k, n)."""


def _fit(law: str, element: Element, independent: bool) -> Fit:
    life = element.at_least[:MAX_ROWS]
    ended, n = ~element.censored[element.present][:MAX_ROWS], len(life)
    if problem := _problem(life, ended, independent, _zeros(element)):
        return Fit(n, refused=problem)
    family = FAMILIES[law]
    seen = _sorted(np.log(life)[None], ended[None])
    location, scale = (value[0] for value in fit(family, *seen))
    locations, scales, distances = _refits(law, location, scale, seen)
    kept = np.isfinite(locations)
    if not np.isfinite(scale) or kept.mean() < CONFIDENCE:
        return Fit(n, refused="the likelihood has no maximum")
    distances = distances[kept]
    distance = _distance(family, location[None], scale[None], seen)
    p_value = float((1 + (distances >= distance).sum()) / (1 + len(distances)))
    if p_value < LEVEL:
        return Fit(n, p_value, f"rejected, p = {p_value:.2g}")
    locations, scales = locations[kept], scales[kept]

    def at(w: float) -> Estimate:
        pivot = (locations + w * scales - location - w * scale) / scales
        value = location + w * scale
        return _exponential(value, value - scale * pivot)

    spread = _exponential(np.log(scale), np.log(scale) - np.log(scales / scale))
    if law == "weibull":
        shape = Estimate(1 / spread.value, 1 / spread.high, 1 / spread.low)
        parameters = {"shape": shape, "scale": at(0.0)}
    else:
        parameters = {"median": at(0.0), "sigma": spread}
    return Fit(
        n,
        p_value,
        parameters=parameters,
        b_lives={name: at(family.standard.ppf(p)) for name, p in B_LIVES.items()},
        extrapolated=frozenset(name for name, p in B_LIVES.items() if not is_within(p, n)),
        assumes=ASSUMES.format(rows=n),
    )


def _zeros(element: Element) -> int:
    """Return the number of rows, of those used, that are known to have ended at once."""
    return int(((element.values <= 0) & ~element.censored)[element.present][:MAX_ROWS].sum())


def _problem(
    life: Floats,
    ended: Mask,
    independent: bool,
    zeros: int,
    least: int = MIN_ENDED,
) -> str:
    """Return why no law can be fitted, or ""; `zeros` is the number of lives that it excludes."""
    if not independent:
        return INDEPENDENT_ONLY
    never = int((np.isposinf(life) & ended).sum())
    if never:
        endless = counted(never, "never ends", "never end")
        return f"of {len(life)} rows {endless}, which this law excludes"
    if zeros:
        return f"{counted(zeros, 'row has', 'rows have')} no positive life, which this law excludes"
    if ended.sum() < least:
        return f"only {counted(int(ended.sum()), 'row')} ended; {MIN_ENDED} are needed"
    if len(np.unique(life[ended])) < least:
        return f"the rows that ended share fewer than {MIN_ENDED} values"
    return ""


def _sorted(x: Floats, ended: Mask) -> _Lives:
    order = np.lexsort((~ended, x), axis=1)  # at equal times, ended rows before censored ones
    return np.take_along_axis(x, order, axis=1), np.take_along_axis(ended, order, axis=1)


def _refits(law: str, location: float, scale: float, seen: _Lives) -> tuple[Floats, Floats, Floats]:
    """Return location, scale and distance of samples drawn from the fitted law."""
    seen_lives, ended = seen
    n = seen_lives.shape[1]
    if ended.all():
        locations, scales, distances = _complete_refits(law, n)
        return location + scale * locations, scale * scales, distances
    rng = np.random.default_rng(0)
    family = FAMILIES[law]
    x = location + scale * family.standard.ppf(rng.random((_refits_of(n), n)))
    # The estimate of Kaplan and Meier with censoring for the end, and the end for censoring.
    share = 1 - np.cumprod(1 - ~ended[0] / np.arange(n, 0, -1))
    place = np.searchsorted(share, rng.random(x.shape))
    limit = np.append(seen_lives[0], np.inf)[place]
    drawn = _sorted(np.minimum(x, limit), x <= limit)
    fitted = fit(family, *drawn)
    return *fitted, _distance(family, *fitted, drawn)


@lru_cache(maxsize=4)
def _complete_refits(law: str, n: int) -> tuple[Floats, Floats, Floats]:
    """Return location, scale and distance of complete samples of n rows from the standard law.

    For any other location and scale these are shifted and scaled; the distances are the same.
    """
    family = FAMILIES[law]
    u = np.random.default_rng(0).random((_refits_of(n), n))
    x = np.sort(family.standard.ppf(u), axis=1)
    drawn = x, np.ones_like(x, dtype=bool)
    fitted = fit(family, *drawn)
    return *fitted, _distance(family, *fitted, drawn)


def _refits_of(rows: int) -> int:
    return min(REFITS, MOST_DRAWN // rows)


def _distance(family: Family, location: Floats, scale: Floats, lives: _Lives) -> Floats:
    x, ended = lives
    w = (x - location[:, None]) / scale[:, None]
    return anderson_darling(family.standard.cdf(w), ended)


def _exponential(value: float, draws: Floats) -> Estimate:
    """Return the exponentials of a value and of the ends of its interval."""
    low, high = np.quantile(draws, [1 - upper_probability(), upper_probability()])
    value, low, high = (float(np.exp(logarithm)) for logarithm in (value, low, high))
    return Estimate(value, low, high)


_PARAMETERS = tuple(dict.fromkeys(name for law in LAWS.values() for name in law.names))
_FACTS = ("rows", "p_value", "log_likelihood", "refused", "assumes")
_ENDS = ("", "_low", "_high")
_COLUMNS = [
    *_FACTS,
    *(f"{name}{end}" for name in (*_PARAMETERS, *B_LIVES) for end in _ENDS),
    *(f"{name}_extrapolated" for name in B_LIVES),
]


def life_fits(result: AnyResult, output: str, laws: Collection[str] = tuple(LAWS)) -> pd.DataFrame:
    """Fit laws to a lifetime by maximum likelihood.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of design ``monte-carlo``.
    output : str
        A lifetime, or one element of it.
    laws : collection of str, optional
        Names of the laws, by default all.

    Returns
    -------
    pandas.DataFrame
        Index: ``output`` (its element) and ``law`` (``weibull``, ``lognormal``, ``gamma``,
        ``exponential``, ``weibull-3`` with a threshold, ``weibull-mixture`` of two populations).
        Columns: ``rows`` used; ``p_value`` of the Anderson-Darling test, its distribution from
        refits, or the ``log_likelihood`` of a law that is not tested; ``refused``, why the law does
        not apply, or ""; ``assumes``, what its numbers rest on. Where it is not refused: its
        parameters, named as in study files (``shape`` and ``scale`` [s]; ``median`` [s] and
        ``sigma``), and ``B1``, ``B10``, ``B50`` [s], each with ``_low`` and ``_high`` for
        the 95 % interval; ``B1_extrapolated`` and so on: whether that life is earlier than the rows
        reach, 1/(n + 1). NaN where there is no number.

    Raises
    ------
    InputError
        When there is no such output or law, or the output is not a lifetime.

    Notes
    -----
    Intervals of laws that are not tested are by profile likelihood. Those of the others are exact
    for complete samples, whose pivots do not depend on the parameters [1]_, and those of the
    parametric bootstrap for censored ones, with censoring times drawn from their
    own Kaplan-Meier estimate, which assumes that censoring is non-informative.

    References
    ----------
    .. [1] J. F. Lawless, "Statistical models and methods for lifetime data", 2nd ed., Wiley
       (2003), sections 5.1.2 and 10.3.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> laws = uq.life_fits(ds, "life", ["weibull", "lognormal"]).loc["life"]
    >>> laws.loc["lognormal", "sigma"].round(1).item()
    0.5
    >>> laws.loc["weibull", "refused"].startswith("rejected")
    True
    """
    result = Result.of(result)
    result.refuse_if_weighted("laws fitted to lives")
    for law in laws:
        if law not in LAWS:
            raise InputError(f"no such law '{law}'{nearest(law, LAWS)} (allowed: {choices(LAWS)})")
    rows = result.independent
    independent = rows.dependence.is_none
    lines = {
        (element.name, law): _line(fit)
        for element in rows.lifetimes(output)
        for law, fit in fits_of(element, independent, result.is_field_record, laws).items()
    }
    index = pd.MultiIndex.from_tuples(list(lines), names=["output", "law"])
    return pd.DataFrame(list(lines.values()), index=index, columns=_COLUMNS)


def _line(fit: Fit) -> dict[str, Any]:
    numbers = {
        f"{name}{end}": number
        for name, estimate in {**fit.parameters, **fit.b_lives}.items()
        for end, number in zip(_ENDS, estimate.numbers, strict=True)
    }
    extrapolated = {f"{name}_extrapolated": name in fit.extrapolated for name in fit.b_lives}
    return {name: getattr(fit, name) for name in _FACTS} | numbers | extrapolated
