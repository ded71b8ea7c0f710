"""Lives from the field: within intervals, late entry, causes, and laws by profile likelihood."""

from types import SimpleNamespace

import numpy as np
from scipy import integrate, optimize, stats

from benchmarks.coverage.tally import Tally
from uq.assess.observed_lives import ObservedLives
from uq.assess.statistics.causes import incidence, life_by_cause
from uq.contract import Output
from uq.result.element import Element
from uq.stats.interval_censoring import LifeIntervals
from uq.stats.life_likelihood import NoMaximumError, fit_law

LAW = stats.weibull_min(1.7)
TIMES = (0.4, 0.8, 1.2)
SHARES = {"B10": 0.1, "B50": 0.5}
VISITS = np.arange(0.2, 3.0, 0.2)
_OWN = (
    "the likelihood ratio has a smaller limit than chi-squared where each row has times of its own"
    " (Banerjee and Wellner 2001)"
)
_THRESHOLD = (
    "the likelihood is irregular in the threshold; a sample where it is largest at 0 has no fit"
)
REASONS = {
    "common": {"B": "between visits the data leave the quantile open: its interval ends at visits"},
    "own": {"P": _OWN, "B": _OWN},
    "weibull-3": dict.fromkeys(("shape", "threshold", "B"), _THRESHOLD),
}
KINDS = {
    "censored": "some censored",
    "late": "some censored, half entered late",
    "common": "within visits at common times",
    "own": "within visits at times of their own",
}


def observed(law, kind, rows, rng):
    """Return lives from a law as they are known under a kind of observation.

    Parameters
    ----------
    law : scipy distribution
        With a scale of about 1.
    kind : str
        Of `KINDS`.
    rows : int
    rng : numpy.random.Generator

    Returns
    -------
    LifeIntervals
    """
    life, entered = law.rvs(20 * rows, random_state=rng), np.zeros(20 * rows)
    if kind == "late":
        entered = np.maximum(rng.uniform(-0.8, 0.8, 20 * rows), 0.0)
    kept = np.flatnonzero(life > entered)[:rows]
    life, entered = life[kept], entered[kept]
    if kind in ("common", "own"):
        visits = np.tile(VISITS, (rows, 1))
        if kind == "own":
            visits = np.cumsum(rng.uniform(0, 0.6, (rows, 8)), axis=1)
        padded = np.column_stack([np.zeros(rows), visits, np.full(rows, np.inf)])
        before = (visits < life[:, None]).sum(axis=1)
        return LifeIntervals(padded[range(rows), before], padded[range(rows), before + 1], entered)
    end = entered + rng.uniform(0.2, 2.5, rows)
    return LifeIntervals(np.minimum(life, end), np.where(life <= end, life, np.inf), entered)


def element_of(lives, codes=None):
    """Return lives as an element of a lifetime, perhaps with causes."""
    exact, absent = lives.is_exact, np.zeros(len(lives), bool)
    declared = Output("s", "a life", "lifetime", causes=() if codes is None else ("wear", "crack"))
    entered = lives.entered if lives.entered.any() else None
    within = None if codes is not None else lives.high
    return Element(
        "life", "life", declared, {}, lives.low, ~exact, absent, high=within, entered=entered,
        causes=codes,
    )  # fmt: skip


def lives(kind, rows, repetitions):
    """Count the intervals of probabilities and quantiles by the likelihood ratio."""
    tally = Tally(f"Recorded life, {KINDS[kind]}, {rows} rows", REASONS.get(kind))
    for seed in range(repetitions):
        sample = ObservedLives(element_of(observed(LAW, kind, rows, np.random.default_rng(seed))))
        for time in TIMES:
            tally.estimate(f"P(T <= {time})", LAW.cdf(time), sample._at(time))
        for name, share in SHARES.items():
            tally.estimate(name, LAW.ppf(share), sample.life_quantile(share))
    return tally.lines()


CRACK = stats.expon(scale=2.5)


def caused(time):
    """Return the probability that wear has ended the life by a time, before a crack did."""
    return integrate.quad(lambda t: LAW.pdf(t) * CRACK.sf(t), 0, time)[0]


def causes(kind, rows, repetitions):
    """Count the intervals of cumulative incidences and lives by cause."""
    truths = {time: caused(time) for time in TIMES}
    b10 = optimize.brentq(lambda t: caused(t) - 0.1, 0.01, 3)
    tally = Tally(f"Recorded life, two causes, {KINDS[kind]}, {rows} rows", REASONS.get("causes"))
    for seed in range(repetitions):
        rng = np.random.default_rng(seed)
        wear, crack = (law.rvs(20 * rows, random_state=rng) for law in (LAW, CRACK))
        life = np.minimum(wear, crack)
        entered = np.zeros(20 * rows)
        if kind == "late":
            entered = np.maximum(rng.uniform(-0.8, 0.8, 20 * rows), 0.0)
        kept = np.flatnonzero(life > entered)[:rows]
        life, entered, by_crack = life[kept], entered[kept], (crack < wear)[kept]
        end = entered + rng.uniform(0.2, 2.5, rows)
        ended = life <= end
        seen = LifeIntervals(np.minimum(life, end), np.where(ended, life, np.inf), entered)
        codes = np.where(ended, by_crack, -1).astype(np.int8)
        element = element_of(seen, codes)
        context = SimpleNamespace(sample=ObservedLives)
        for time, truth in truths.items():
            tally.estimate(f"wear by {time}", truth, incidence(element, context, 0, time))
        tally.estimate("B10 by wear", b10, life_by_cause(element, context, 0, 0.1))
    return tally.lines()


class _Populations:
    """Lives of two Weibull populations."""

    def __init__(self, share, first, second):
        self.share, self.first, self.second = share, first, second

    def rvs(self, size, random_state):
        soon = random_state.random(size) < self.share
        parts = (law.rvs(size, random_state=random_state) for law in (self.first, self.second))
        return np.where(soon, *parts)

    def cdf(self, time):
        return self.share * self.first.cdf(time) + (1 - self.share) * self.second.cdf(time)

    def ppf(self, p):
        return optimize.brentq(lambda time: self.cdf(time) - p, 1e-6, 20)


LAWS = {
    "weibull": (stats.weibull_min(2.0), {"shape": 2.0, "scale": 1.0}),
    "lognormal": (stats.lognorm(0.5), {"median": 1.0, "sigma": 0.5}),
    "gamma": (stats.gamma(3.0, scale=0.3), {"shape": 3.0, "scale": 0.3}),
    "exponential": (stats.expon(), {"mean": 1.0}),
    "weibull-3": (
        stats.weibull_min(2.0, loc=0.5),
        {"shape": 2.0, "scale": 1.0, "threshold": 0.5},
    ),
    "weibull-mixture": (
        _Populations(0.3, stats.weibull_min(1.2, scale=0.2), stats.weibull_min(4.0, scale=1.5)),
        {"share": 0.3, "shape_1": 1.2, "scale_1": 0.2, "shape_2": 4.0, "scale_2": 1.5},
    ),
}


EVERY = ("censored", "late", "common")
FITS = (
    *((law, 60, 300, EVERY) for law in ("weibull", "lognormal", "gamma", "exponential")),
    ("weibull-3", 60, 300, ("censored", "common")),
    ("weibull-mixture", 200, 200, ("censored",)),
)
"""Laws with their rows, repetitions and kinds of observation."""


def fits(name, kind, rows, repetitions):
    """Count the profile-likelihood intervals of a law, where its likelihood has a maximum."""
    law, parameters = LAWS[name]
    tally = Tally(f"Recorded {name} life, {KINDS[kind]}, {rows} rows", REASONS.get(name))
    for seed in range(repetitions):
        seen = observed(law, kind, rows, np.random.default_rng(seed))
        try:
            fit = fit_law(name, seen, SHARES)
            estimates = {**fit.parameters, **fit.quantiles}
        except NoMaximumError:
            estimates = {}
        truths = parameters | {label: law.ppf(share) for label, share in SHARES.items()}
        for label, truth in truths.items():
            estimate = estimates.get(label)
            if estimate is None:
                tally.entry(label, truth, None)
                continue
            # An end that the likelihood ratio never rejects is at the limit of what is possible.
            low = 0.0 if np.isnan(estimate.low) else estimate.low
            high = np.inf if np.isnan(estimate.high) else estimate.high
            tally.add(label, truth, low, high)
    return tally.lines()
