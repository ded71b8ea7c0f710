"""Mean, standard deviation and tail, and the share of the variance between regimes."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite, isnan

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.assess.sample import MEAN, SD
from uq.assess.statistic import FACT, Context, Reader, Statistic, StatisticKind, placed
from uq.assess.targets import number_of
from uq.contract import Floats
from uq.result.element import Element
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.intervals import CONFIDENCE, UNKNOWN, scatter_interval, upper_probability
from uq.stats.moments import Moments
from uq.stats.quantile_functions import normal
from uq.stats.tails import heavier_tail, lacks_variance

MOMENT = StatisticKind(form="moment")
SPREAD = replace(MOMENT, readers=~Reader.RUNNING)


@placed(json=0, columns=0)
def moments_of(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield mean, standard deviation and tail; unknown where rows never end or are censored.

    The shape k of the heavier tail (``tail_k``): there is no variance from 0.5 on, no mean from 1.
    """
    sample = context.sample(element)
    estimates, unit, by = sample.moments(), element.units, sample.by
    more, mean, sd = estimates.caution or "", estimates.mean, estimates.sd
    yield Statistic(("mean",), "mean", mean, unit, MOMENT, more=more, estimator=MEAN, by=by["mean"])
    yield Statistic(("sd",), "sd", sd, unit, SPREAD, estimator=SD, by=by["sd"])
    reasons = _reasons(estimates)
    tail = estimates.tail
    yield Statistic(
        ("tail",),
        "tail",
        NOTHING if tail is None else Estimate(tail.k, tail.low, tail.high),
        kind=FACT,
        column="tail_k",
        notes=(*dict.fromkeys(reasons.values()), *filter(None, [estimates.caution])),
        facts={"tail": tail and tail._asdict(), "reasons": reasons, "caution": estimates.caution},
        by=(heavier_tail,),
    )


def _reasons(estimates: Moments) -> dict[str, str]:
    both = {"sd": estimates.sd, "mean": estimates.mean}
    reasons = {f"{name}_interval": estimate.reason for name, estimate in both.items()}
    reasons |= {name: estimate.reason for name, estimate in both.items() if isnan(estimate.value)}
    return {name: reason for name, reason in reasons.items() if reason}


MIN_IN_REGIME = 2
"""A regime with fewer rows has no variance of its own, and is skipped."""


_KIND = StatisticKind(
    is_share=True,
    without="none seen",  # corrected for chance, it may be negative
    readers=Reader.JSON | Reader.TERMINAL | Reader.REPORT,
)


def between_regimes(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the share of the variance between regimes, of a life by its logarithm or rank."""
    target = number_of(element)
    if "regime" not in context.rows.output_names or target.refused or element.weights is not None:
        return
    codes = context.rows.dataset["regime"].values
    split = between_share(target.values, codes, context.rows.dependence)
    if isfinite(split.value):
        label = "variance between regimes"
        yield Statistic(
            ("between_regimes",), label, split, kind=_KIND, of=target.name, by=(between_share,)
        )


def between_share(
    values: Floats, codes: NDArray[np.integer], dependence: Dependence = INDEPENDENT
) -> Estimate:
    """Estimate the share of the variance that the regime's mean explains.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where there is none.
    codes : ndarray of int, shape (n,)
        Regime of each row, negative for none.
    dependence : Dependence, optional

    Returns
    -------
    Estimate
        The correlation ratio; for independent rows corrected for chance (epsilon squared [1]_). NaN
        where fewer than two regimes have enough rows, all values are equal, or their tail is too
        heavy for a variance. Its interval is, for independent rows, by the normal law of the
        estimate's influence function, and unknown where an F-test finds no difference between the
        regimes: there the estimate has no normal law. For replicates it is from their scatter;
        where samples have several rows there is none.

    References
    ----------
    .. [1] T. L. Kelley, "An unbiased correlation ratio measure", Proc. Natl. Acad. Sci. 21,
       554-559 (1935).
    """
    kept = np.isfinite(values) & (codes >= 0)
    counts = np.bincount(codes[kept], minlength=1)
    kept[kept] = counts[codes[kept]] >= MIN_IN_REGIME
    _, regime = np.unique(codes[kept], return_inverse=True)
    y = values[kept]
    value, deviation, residual = _split(y, regime)
    if not np.isfinite(value) or lacks_variance(y):
        return NOTHING
    if dependence.labels is None:
        value, low, high = _independent(value, deviation, residual, regime.max() + 1)
    elif dependence.samples is not None:  # the estimates of few rows scatter
        low, high = UNKNOWN
    else:
        replicate = dependence.labels[kept]
        rows = (replicate == number for number in np.unique(replicate))
        shares = np.array([_split(y[inside], regime[inside])[0] for inside in rows])
        low, high = scatter_interval(value, shares) if np.isfinite(shares).all() else UNKNOWN
    return Estimate(value, max(float(low), 0.0), min(float(high), 1.0))


def _independent(
    ratio: float, deviation: Floats, residual: Floats, regimes: int
) -> tuple[float, float, float]:
    n = len(deviation)
    value = 1 - (1 - ratio) * (n - 1) / (n - regimes) if n > regimes else np.nan
    total = deviation + residual
    influence = deviation**2 + 2 * deviation * residual - ratio * total**2
    half = normal(upper_probability()) * influence.std() / total.var() / np.sqrt(n)
    freedom = regimes - 1, n - regimes
    with np.errstate(divide="ignore", invalid="ignore"):
        statistic = ratio / freedom[0] / ((1 - ratio) / freedom[1])
    same = special.fdtrc(*freedom, statistic) > 1 - CONFIDENCE
    if not half > 0 or not 0 < value < 1 or same:
        return value, np.nan, np.nan
    # Fisher's transformation of the root, in which the estimate is nearly normal.
    root = np.sqrt(value)
    wide = half / (2 * root * (1 - value))
    low, high = (np.tanh(np.arctanh(root) + side * wide) for side in (-1, 1))
    return value, float(np.copysign(low**2, low)), float(high**2)


def _split(y: Floats, regime: NDArray[np.integer]) -> tuple[float, Floats, Floats]:
    """Return the correlation ratio, and each row as regime mean plus residual, less the mean."""
    if len(y) == 0 or np.ptp(y) == 0 or len(np.unique(regime)) < 2:
        return np.nan, y, y
    counts = np.bincount(regime)
    with np.errstate(invalid="ignore"):
        means = np.bincount(regime, weights=y) / counts
    deviation = means[regime] - y.mean()
    return float(np.mean(deviation**2) / y.var()), deviation, y - means[regime]
