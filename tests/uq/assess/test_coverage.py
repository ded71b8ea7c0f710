"""Every 95 % interval that is printed holds the truth in 90 to 99 % of 200 repetitions.

``pytest -m slow -s tests/uq/assess/test_coverage.py`` prints the table.
"""

from itertools import product

import numpy as np
import pytest
from computed import UNIFORM, asking, summarised, with_output
from coverage_tally import (
    DEPTH,
    LIFE,
    RATE,
    REPETITIONS,
    SIGMA,
    SPREAD,
    WEAR,
    Tally,
    repeat,
    title,
)
from scipy import stats
from scipy.optimize import brentq

from uq.assess.life_fit import fits_of
from uq.assess.statistics.moments import between_share
from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.survival import survival
from uq.result.elements import elements_of
from uq.stats.dependent_rows import Dependence

pytestmark = pytest.mark.slow


def tally_summary(tally, entry, cdf, ppf, mean=None):
    """Count mean, quantiles, thresholds and tolerance bounds of one output."""
    if mean is not None:
        tally.add("mean", mean, **entry["mean_interval"])
    for probability, estimate in entry["quantiles"].items():
        tally.add(
            f"quantile {probability}", ppf(float(probability)), estimate["low"], estimate["high"]
        )
    for threshold, entry_of_threshold in entry["thresholds"].items():
        above = entry_of_threshold["above"]
        tally.add(f"P(> {threshold})", 1 - cdf(float(threshold)), above["low"], above["high"])
    if bounds := entry["tolerance"]:
        tally.add("tolerance lower", ppf(0.05), bounds["lower"], np.inf)
        tally.add("tolerance upper", ppf(0.95), -np.inf, bounds["upper"])


def tally_survival(tally, curve, cdf, times):
    """Count the band of a survival curve at some times."""
    for time in times:
        smooth = "integrated" in curve.attrs
        at = curve.interp(time=time) if smooth else curve.sel(time=time, method="ffill")
        ends = [float(at[end]) for end in ("low", "high")]
        low, high = ends if np.isfinite(ends).all() else (None, None)
        tally.add(f"survival {time:g}", 1 - cdf(time), low, high)


DESIGNS = [
    ("monte-carlo", 1000, 1),
    ("monte-carlo", 125, 8),
    ("latin-hypercube", 125, 8),
    ("sobol", 128, 8),
    ("halton", 125, 8),
    ("saltelli", 128, 8),
]


def linear_cdf(y):
    """Return P(x1 + 2 x2 + 3 x3 + 4 x4 < y): inclusion and exclusion over the corners."""
    total = 0.0
    for corner in product((0, 1), repeat=4):
        shift = float(np.dot(corner, (1, 2, 3, 4)))
        total += (-1) ** sum(corner) * max(y - shift, 0.0) ** 4
    return total / (24 * 24)


@pytest.mark.parametrize("design", DESIGNS)
def test_moments_and_quantiles(design):
    def ppf(p):
        return brentq(lambda y: linear_cdf(y) - p, 0, 10, xtol=1e-12)

    analysis = {"quantiles": [0.01, 0.05, 0.5, 0.95], "thresholds": {"y": [1.0, 2.0, 6.0]}}
    tally = Tally(title("linear", design))
    inputs = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)
    for ds in repeat("linear", design, inputs, analysis=analysis):
        tally_summary(tally, summarised(ds)["outputs"]["y"], linear_cdf, ppf, mean=5.0)
    # A scrambled Sobol' sequence integrates a linear function exactly but for rare scrambles:
    # with so heavy a tail Student's interval nearly always holds. P(y > 1) = 1 - 1/576 is shown
    # by fewer than two rows in a thousand, where every interval is coarse.
    tally.check(conservative=("mean", "P(> 1.0)"))


# Lifetimes: a long tail, rows that never end, censored rows --------------------------------------


@pytest.mark.parametrize("design", DESIGNS)
def test_lifetimes(design):
    analysis = {"thresholds": {"life": [5e5, 2e6]}}
    if design[0] == "monte-carlo":
        analysis["tolerance"] = {"coverage": 0.95, "confidence": 0.95}
    tally = Tally(title("wear", design))
    for ds in repeat("exponential-wear", design, WEAR, analysis=analysis):
        tally_summary(tally, summarised(ds)["outputs"]["life"], LIFE.cdf, LIFE.ppf, LIFE.mean())
        tally_survival(tally, survival(ds, "life"), LIFE.cdf, (5e5, 1e6, 2e6))
    # With the depth integrated the rate alone is left, and scrambled points average a smooth
    # function of one input almost exactly but for rare scrambles: a heavy tail, as above.
    tally.check(conservative=("quantile 0.5",) if design[0] == "sobol" else ())


@pytest.mark.parametrize("design", DESIGNS)
def test_lifetimes_that_never_end_or_are_censored(design):
    # About 30 % of the rows wear too slowly to wear at all. On top of that, for the survival
    # curve, rows leave early for a reason of their own.
    slowest = RATE * np.exp(-0.5 * SIGMA)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    depths = stats.lognorm(s=SPREAD, scale=DEPTH).ppf((nodes + 1) / 2)
    rate = stats.lognorm(s=SIGMA, scale=RATE)

    def cdf(time):
        return float(weights / 2 @ rate.sf(np.maximum(depths / time, slowest)))

    def ppf(p):
        return brentq(lambda time: cdf(time) - p, 1e4, 1e7, rtol=1e-10)

    analysis = {"quantiles": [0.05, 0.3, 0.6], "thresholds": {"life": [5e5, 1e6]}}
    tally = Tally("never, censored: " + title("wear", design))
    fixed = {"threshold": slowest}
    for seed, ds in enumerate(
        repeat("exponential-wear", design, WEAR, repetitions=400, fixed=fixed, analysis=analysis)
    ):
        tally_summary(tally, summarised(ds)["outputs"]["life"], cdf, ppf)
        life = ds["life"].values
        leaving = np.random.default_rng(seed).exponential(4e6, len(life))
        seen = with_output(ds, "seen", np.minimum(life, leaving), "lifetime", leaving < life)
        tally_survival(tally, survival(seen, "seen"), cdf, (5e5, 1e6))
    averaged = ("quantile 0.6", "P(> 1000000.0)")  # almost exactly, as above
    tally.check(conservative=averaged if design[0] == "sobol" else ())


@pytest.mark.parametrize("design", [("monte-carlo", 500, 1), ("latin-hypercube", 125, 8)])
def test_b_lives_and_shares_with_censored_rows(design):
    tally = Tally("censored: " + title("wear", design))
    for seed, ds in enumerate(repeat("exponential-wear", design, WEAR)):
        life = ds["life"].values
        leaving = np.random.default_rng(seed).exponential(4e6, len(life))
        ds = with_output(ds, "seen", np.minimum(life, leaving), "lifetime", leaving < life)
        entry = summarised(asking(ds, thresholds={"seen": [1e6]}))["outputs"]["seen"]
        for name, p in {"B10": 0.1, "B50": 0.5}.items():
            estimate = entry["b_lives"][name]
            tally.add(name, LIFE.ppf(p), estimate["low"], estimate["high"])
        below = entry["thresholds"]["1000000.0"]["kaplan_meier"]["below"]
        tally.add("P(< 1e6)", LIFE.cdf(1e6), below["low"], below["high"])
    tally.check()


@pytest.mark.parametrize("horizon", [np.inf, 1.2e6])
def test_fitted_laws(horizon):
    # Of the repetitions in which the test does not refuse the true law: 19 in 20.
    tally = Tally(f"lognormal fit, horizon {horizon:g}")
    refused = 0
    for ds in repeat("exponential-wear", ("monte-carlo", 60, 1), WEAR):
        life = ds["life"].values
        ds = with_output(ds, "seen", np.minimum(life, horizon), "lifetime", life > horizon)
        fit = fits_of(*elements_of(ds, ["seen"]), independent=True)["lognormal"]
        refused += bool(fit.refused)
        if fit.refused:
            continue
        truth = {"median": LIFE.median(), "sigma": np.hypot(SIGMA, SPREAD)}
        for name, estimate in fit.parameters.items():
            tally.add(name, truth[name], estimate.low, estimate.high)
        for name, p in B_LIVES.items():
            tally.add(name, LIFE.ppf(p), fit.b_lives[name].low, fit.b_lives[name].high)
    assert stats.binomtest(refused, REPETITIONS, 0.05).pvalue > 1e-3
    tally.check(conservative=("median", "sigma", "B1", "B10", "B50"))


@pytest.mark.parametrize("design", [("monte-carlo", 300, 1), ("latin-hypercube", 64, 8)])
def test_variance_between_two_regimes(design):
    # A step of 2.0 at x4 = 0.7 on top of x1, uniform: p (1 - p) 4 of variance between.
    tally = Tally("two regimes, " + title("linear", design))
    between = 0.21 * 4.0
    inputs = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)
    for ds in repeat("linear", design, inputs):
        codes = (ds["x4"].values > 0.7).astype(int)
        labels = None if design[0] == "monte-carlo" else ds["replicate"].values
        share = between_share(ds["x1"].values + 2.0 * codes, codes, Dependence(labels))
        tally.add("between", between / (between + 1 / 12), share.low, share.high)
    tally.check()
