"""Lifetimes that never end or are censored: survival, B-lives, shares, fitted laws."""

import warnings
from functools import cache

import numpy as np
import openturns as ot
from scipy import stats

from benchmarks.coverage.problems import ENDS, LIFE, MIXED, computed, never_cdf, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.assess.life_fit import fits_of
from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.assess.survival import survival
from uq.result.elements import elements_of
from uq.result.result import Result

TIMES = (0.3, 0.8)


def lives(design, repetitions):
    """Count bands, B-lives and shares of lives that never end, or are censored.

    Parameters
    ----------
    design : {"monte-carlo", "latin-hypercube"}
    repetitions : int

    Returns
    -------
    list of Line
    """
    samples, replicates = (500, 1) if design == "monte-carlo" else (64, 8)
    rows = (
        f"{samples} independent rows"
        if replicates == 1
        else f"{design}, {replicates} replicates of {samples} rows"
    )
    analysis = {
        "outputs": ["never", "cut", "left"],
        "quantiles": [0.5],
        "thresholds": {"left": 0.5, "never": 2.0},
    }
    study = study_of(design, samples, replicates, analysis=analysis)
    tallies = {
        name: Tally(f"{title}, {rows}", REASONS.get((design, name)))
        for name, title in (
            ("never", "life that may never end"),
            ("cut", "life censored at a horizon"),
            ("left", "life censored at random times"),
        )
    }
    for ds in repeated(study, repetitions):
        outputs = summary_facts(summarise(Result(ds))).json["outputs"]
        for name, tally in tallies.items():
            cdf = never_cdf if name == "never" else LIFE.cdf  # alike below the plateau
            for label, p in B_LIVES.items():
                tally.entry(label, LIFE.ppf(p), outputs[name]["b_lives"][label])
            curve = survival(ds, name)
            for time in TIMES:
                at = curve.sel(time=time, method="ffill")
                tally.add(f"survival at {time}", 1 - cdf(time), float(at["low"]), float(at["high"]))
        entry = outputs["never"]["thresholds"]["2.0"]["below"]
        tallies["never"].entry("P(< 2.0)", never_cdf(2.0), entry)
        entry = outputs["left"]["thresholds"]["0.5"]["kaplan_meier"]["below"]
        tallies["left"].entry("P(< 0.5)", LIFE.cdf(0.5), entry)
        if replicates == 1:
            _rivals(tallies["left"], ds)
    return [line for tally in tallies.values() for line in tally.lines()]


LIMITS = (0.5, 1.0, 1.5)
LEAVING = {"distribution": "exponential", "mean": 1.0}


def mixed(design, samples, repetitions):
    """Count the statistics of lives most of which never end and the others may be censored.

    Parameters
    ----------
    design : {"monte-carlo", "latin-hypercube"}
    samples : int
        In each of one replicate, or of eight.
    repetitions : int

    Returns
    -------
    list of Line
    """
    replicates = 1 if design == "monte-carlo" else 8
    uniform = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    analysis = {"outputs": ["mixed"], "quantiles": [0.5], "thresholds": {"mixed": list(LIMITS)}}
    laws = {"x1": uniform, "x2": uniform, "leaving": LEAVING}
    study = study_of(design, samples, replicates, laws=laws, analysis=analysis)
    rows = f"{design}, {replicates} replicates of " * (replicates > 1) + f"{samples} rows"
    tally = Tally(f"60 % never end, known at once, the others may be censored; {rows}")
    for ds in repeated(study, repetitions):
        entry = summary_facts(summarise(Result(ds))).json["outputs"]["mixed"]
        tally.entry("B10", MIXED.ppf(0.1 / ENDS), entry["b_lives"]["B10"])
        for time in LIMITS:
            below = entry["thresholds"][repr(time)]["kaplan_meier"]["below"]
            tally.entry(f"P(< {time})", ENDS * MIXED.cdf(time), below)
    return tally.lines()


def _rivals(tally, ds):
    ended = ds["left_censored"].values == 0
    values = ds["left"].values
    curve = stats.ecdf(stats.CensoredData(uncensored=values[ended], right=values[~ended])).sf
    for method in ("linear", "log-log"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # undefined before the first end
            band = curve.confidence_interval(method=method)
        for time in TIMES:
            ends = (float(end.evaluate(time)) for end in band)
            tally.add(f"survival at {time}", LIFE.sf(time), *ends, by=f"scipy ecdf, {method}")


FIT_ROWS = 60
SHAPE, SCALE = 1.5, 1.0
MEDIAN, SIGMA = 1.0, 0.8
FITTED = {
    "weibull": (
        stats.weibull_min(SHAPE, scale=SCALE),
        {"shape": SHAPE, "scale": SCALE},
        {"rate": {"distribution": "uniform", "lower": 1.0, "upper": 1.0 + 1e-9}},
    ),
    "lognormal": (
        stats.lognorm(SIGMA, scale=MEDIAN),
        {"median": MEDIAN, "sigma": SIGMA},
        {},
    ),
}


def fits(law, censored, repetitions):
    """Count the intervals of a fitted law, of the samples for which it is not refused.

    Parameters
    ----------
    law : {"weibull", "lognormal"}
    censored : bool
        At the time by which 70 % have ended.
    repetitions : int

    Returns
    -------
    list of Line
    """
    truth, parameters, _ = FITTED[law]
    laws = {
        "rate": {"distribution": "uniform", "lower": 1.0, "upper": 1.0 + 1e-9},
        "depth": {"distribution": "weibull", "shape": SHAPE, "scale": SCALE}
        if law == "weibull"
        else {"distribution": "lognormal", "median": MEDIAN, "sigma": SIGMA},
    }
    study = study_of("monte-carlo", FIT_ROWS, model="exponential-wear", laws=laws)
    how = "30 % censored at a horizon" if censored else "complete"
    tally = Tally(
        f"{law} life, {FIT_ROWS} independent rows, {how}",
        {"not refused": "the test refuses 5 % of samples of the true law"},
    )
    for ds in repeated(study, repetitions):
        ds = _cut(ds, truth.ppf(0.7)) if censored else ds
        fit = fits_of(*elements_of(ds, ["life"]), independent=True, laws=[law])[law]
        tally.add("not refused, where the law is true", 1.0, 1.0, 2.0 - bool(fit.refused) * 2)
        if fit.refused:
            continue
        for name, estimate in fit.parameters.items():
            tally.estimate(name, parameters[name], estimate)
        for name, p in B_LIVES.items():
            tally.estimate(name, truth.ppf(p), fit.b_lives[name])
        if not censored:
            _asymptotic(tally, law, ds["life"].values, parameters)
    return tally.lines()


@cache
def _blank(rows, replicates):
    method = "monte-carlo" if replicates == 1 else "latin-hypercube"
    return computed(study_of(method, rows, replicates, analysis={"outputs": ["life"]}))


def with_life(values, censored=None, replicates=1, kind="lifetime"):
    """Return a result whose output `life` has other values, in the order of its rows."""
    ds = _blank(len(values) // replicates, replicates)
    ds = ds.assign(life=("row", values, ds["life"].attrs | {"kind": kind}))
    if censored is None or not censored.any():
        return ds
    flag = {"role": "censored", "long_name": "whether life is only a lower bound"}
    return ds.assign(life_censored=("row", censored.astype(np.int8), flag))


def _cut(ds, horizon):
    life = ds["life"].values
    flag = {"role": "censored", "long_name": "whether life is only a lower bound"}
    ds = ds.assign(life=("row", np.minimum(life, horizon), ds["life"].attrs))
    return ds.assign(life_censored=("row", (life > horizon).astype(np.int8), flag))


def _asymptotic(tally, law, life, parameters):
    """Count what OpenTURNS gives: the normal law of maximum likelihood."""
    sample = ot.Sample(np.log(life)[:, None])
    if law == "weibull":
        return
    distribution = ot.NormalFactory().buildEstimator(sample).getParameterDistribution()
    low, high = (
        [distribution.getMarginal(i).computeQuantile(q)[0] for i in (0, 1)] for q in (0.025, 0.975)
    )
    by = "OpenTURNS NormalFactory of the logarithms"
    tally.add("median", parameters["median"], np.exp(low[0]), np.exp(high[0]), by=by)
    tally.add("sigma", parameters["sigma"], low[1], high[1], by=by)


RARE = "conservative by design: seven rows of 512 are hits, and the interval of so few is exact"
STEPS = (
    "conservative: the 1st and 11th of 500 lives cover B1 in 98.0 %; moving either end to the next"
    " life would miss in more than 2.5 % on that side"
)
REASONS = {
    ("latin-hypercube", "never"): {"P(< 2.0)": RARE},
    ("monte-carlo", "never"): {"B1": STEPS},
    ("monte-carlo", "cut"): {"B1": STEPS},
}
"""Design and problem -> quantity -> why its coverage is not 95 %."""
