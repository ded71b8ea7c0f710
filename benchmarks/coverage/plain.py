"""Means, quantiles, probabilities, tolerance bounds, shares of regimes: of rows of every design."""

import numpy as np
import openturns as ot
import openturns.experimental as otx
from scipy import stats

from benchmarks.coverage.problems import (
    ISHIGAMI_MEAN,
    LIFE,
    ishigami_cdf,
    ishigami_ppf,
    jump,
    jump_ppf,
    repeated,
    study_of,
)
from benchmarks.coverage.tally import Tally
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.result.result import Result

QUANTILES = (0.05, 0.5, 0.95)
THRESHOLDS = {"ishigami": [9.0], "jump": [2.5], "life": [1.0]}
DESIGNS = {
    "monte-carlo": ("monte-carlo", 1000, 1),
    "latin-hypercube": ("latin-hypercube", 125, 8),
    "sobol": ("sobol", 128, 8),
    "halton": ("halton", 125, 8),
    "saltelli": ("saltelli", 64, 8),
}
EVERY = 5
"""Others are asked for the intervals of every fifth repetition."""

TAIL = (
    "without further assumptions no interval is valid for the mean of so heavy a tail (infinite"
    " skewness; Bahadur and Savage 1956): those of quantiles, B-lives and P(T < t) are"
)
FEW = (
    "a replicate has about six rows below, never more than ten: such counts are too skewed for"
    " Student's law; with 128 groups instead of 64 the interval covers 95 %"
)
TRUTH = {
    "ishigami": (lambda: ISHIGAMI_MEAN, lambda p: ishigami_ppf(p), lambda t: ishigami_cdf(t)),
    "jump": (lambda: jump()["mean"], lambda p: jump_ppf(p), lambda t: 1 - jump()["share"]),
    "life": (LIFE.mean, LIFE.ppf, LIFE.cdf),
}
NAMES = {"ishigami": "Ishigami", "jump": "two regimes", "life": "heavy-tailed life"}


def rows_of(design):
    """Say what rows a design gives for plain statistics."""
    method, samples, replicates = DESIGNS[design]
    if method == "monte-carlo":
        return f"{samples} independent rows"
    return f"{method}, {replicates} replicates of {samples * (1 + (method == 'saltelli'))} rows"


def plain(design, repetitions):
    """Count everything that the summary prints.

    Parameters
    ----------
    design : str
        One of `DESIGNS`.
    repetitions : int

    Returns
    -------
    list of Line
    """
    method, samples, replicates = DESIGNS[design]
    analysis = {
        "outputs": list(TRUTH),
        "thresholds": THRESHOLDS,
        "quantiles": list(QUANTILES),
    }
    independent = design == "monte-carlo"
    if independent:
        analysis["tolerance"] = {"coverage": 0.95, "confidence": 0.95}
    study = study_of(method, samples, replicates, analysis=analysis)
    tallies = {
        name: Tally(f"{NAMES[name]}, {rows_of(design)}", REASONS.get((design, name)))
        for name in TRUTH
    }
    for number, ds in enumerate(repeated(study, repetitions)):
        summary = summary_facts(summarise(Result(ds))).json
        for name, tally in tallies.items():
            _summary(tally, summary["outputs"][name], *TRUTH[name])
        shares = tallies["jump"]
        shares.entry("share of a regime", jump()["share"], summary["regime"]["upper"])
        between = summary["outputs"]["jump"]["between_regimes"]
        shares.entry("variance between regimes", jump()["between"], between)
        if independent:
            within = summary_facts(summarise(Result(ds), regime="upper")).json["outputs"]["jump"]
            shares.entry("mean in a regime", jump()["within"]["upper"], within["mean_interval"])
            median = within["quantiles"]["0.5"]
            shares.entry("median in a regime", jump_ppf(0.5, "upper"), median)
            if number % EVERY == 0:
                _rivals(tallies, ds)
        elif design == "sobol":
            _taken_for_independent(tallies["ishigami"], ds["ishigami"].values)
    return [line for tally in tallies.values() for line in tally.lines()]


def _summary(tally, entry, mean, ppf, cdf):
    tally.entry("mean", mean(), entry["mean_interval"])
    for p, interval in entry["quantiles"].items():
        tally.entry(f"quantile {p}", ppf(float(p)), interval)
    for t, interval in entry["thresholds"].items():
        tally.entry(f"P(> {t})", 1 - cdf(float(t)), interval["above"])
    if bounds := entry["tolerance"]:
        tally.add("tolerance 95/95, lower", ppf(0.05), bounds["lower"], np.inf)
        tally.add("tolerance 95/95, upper", ppf(0.95), -np.inf, bounds["upper"])


def _rivals(tallies, ds):
    """Count the intervals that others give from the same rows."""
    for name, tally in tallies.items():
        y = ds[name].values
        mean, ppf, cdf = TRUTH[name]
        t = THRESHOLDS[name][0]
        interval = stats.ttest_1samp(y, 0.0).confidence_interval()
        tally.add("mean", mean(), *interval, by="scipy ttest_1samp")
        for p in QUANTILES:
            interval = stats.quantile_test(y, p=p).confidence_interval()
            tally.add(f"quantile {p}", ppf(p), *interval, by="scipy quantile_test")
        hits = stats.binomtest(int((y > t).sum()), len(y))
        for method in ("exact", "wilson"):
            interval = hits.proportion_ci(method=method)
            tally.add(f"P(> {t})", 1 - cdf(t), *interval, by=f"scipy binomtest, {method}")
        half = 1.96 * np.sqrt(hits.statistic * (1 - hits.statistic) / len(y))
        ends = hits.statistic - half, hits.statistic + half
        tally.add(f"P(> {t})", 1 - cdf(t), *ends, by="OpenTURNS, normal law")
        sample = ot.Sample(y[:, None])
        for p in QUANTILES:
            algorithm = otx.QuantileConfidence(p, 0.95)
            interval, sure = algorithm.computeBilateralConfidenceIntervalWithCoverage(sample)
            # Of the quantile 0.95 it gives the largest row twice, and says itself: coverage 0.
            ends = _ends(interval) if sure else (None, None)
            tally.add(f"quantile {p}", ppf(p), *ends, by="OpenTURNS QuantileConfidence")
        for side, p, lower in (("lower", 0.05, True), ("upper", 0.95, False)):
            algorithm = otx.QuantileConfidence(p, 0.95)
            low, high = _ends(algorithm.computeUnilateralConfidenceInterval(sample, lower))
            ends = (low, np.inf) if lower else (-np.inf, high)
            tally.add(f"tolerance 95/95, {side}", ppf(p), *ends, by="OpenTURNS QuantileConfidence")


def _ends(interval):
    return interval.getLowerBound()[0], interval.getUpperBound()[0]


def _taken_for_independent(tally, y):
    """Count the intervals of formulas for independent rows, applied to rows that are not."""
    by = "scipy, rows assumed independent"
    tally.add("mean", ISHIGAMI_MEAN, *stats.ttest_1samp(y, 0.0).confidence_interval(), by=by)
    interval = stats.quantile_test(y, p=0.5).confidence_interval()
    tally.add("quantile 0.5", ishigami_ppf(0.5), *interval, by=by)


AS_JUMPS = "conservative: a steep slope between neighbouring rows counts as a jump"
REASONS = {(design, "life"): {"mean": TAIL} for design in DESIGNS} | {
    ("saltelli", "jump"): {"quantile 0.05": FEW},
    ("sobol", "ishigami"): {"mean": AS_JUMPS},
}
"""Design and problem -> quantity -> why its coverage is not 95 %."""
