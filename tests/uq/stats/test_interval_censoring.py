"""Lives known within intervals: published estimates, the Fenchel conditions, and late entry."""

import numpy as np
import pytest
from lifelines import KaplanMeierFitter
from lifelines.datasets import load_multicenter_aids_cohort_study, load_psychiatric_patients

from uq.stats.interval_censoring import LifeIntervals, LikelihoodIntervals, turnbull

RADIATION = (
    "45- 25-37 37- 6-10 46- 0-5 0-7 26-40 18- 46- 46- 24- 46- 27-34 36- 7-16 36-44 5-11 17- 46-"
    " 19-35 7-14 36-48 17-25 37-44 37- 24- 0-8 40- 32- 4-11 17-25 33- 15- 46- 19-26 11-15 11-18 37-"
    " 22- 38- 34- 46- 5-12 36- 46-"
)
"""Months to deterioration after radiotherapy (Finkelstein 1986, Biometrics 42, 845).

Neither lifelines nor SurPyval has them; the published estimate confirms them to every digit.
"""


def intervals(text):
    ends = [entry.split("-") for entry in text.split()]
    low = np.array([float(first) for first, _ in ends])
    high = np.array([float(second) if second else np.inf for _, second in ends])
    return LifeIntervals(low, high, np.zeros(len(low)))


def drawn(rng, kind, n=80):
    """Return lives from a Weibull law as they are known under a kind of observation."""
    life = rng.weibull(1.7, 8 * n)
    entered = np.zeros(8 * n)
    if kind == "late entry":
        entered = np.maximum(rng.uniform(-0.5, 0.8, 8 * n), 0.0)
    kept = np.flatnonzero(life > entered)[:n]
    life, entered = life[kept], entered[kept]
    if kind == "inspected":
        times = np.cumsum(rng.uniform(0, 0.6, (n, 8)), axis=1)
        padded = np.column_stack([np.zeros(n), times, np.full(n, np.inf)])
        before = (times < life[:, None]).sum(axis=1)
        return LifeIntervals(padded[range(n), before], padded[range(n), before + 1], entered)
    end = entered + rng.uniform(0.2, 2.0, n)
    return LifeIntervals(np.minimum(life, end), np.where(life <= end, life, np.inf), entered)


def test_the_estimate_is_the_published_one_of_lives_after_radiotherapy():
    estimate = turnbull(intervals(RADIATION))
    kept = estimate.mass > 1e-4
    points = list(zip(estimate.low[kept], estimate.high[kept], estimate.mass[kept], strict=True))
    published = [  # M. P. Fay, P. A. Shaw, J. Stat. Softw. 36(2) (2010), section 3
        (4, 5, 0.0463),
        (6, 7, 0.0334),
        (7, 8, 0.0887),
        (11, 12, 0.0708),
        (24, 25, 0.0926),
        (33, 34, 0.0818),
        (38, 40, 0.1209),
        (46, 48, 0.4656),
    ]
    assert [entry[:2] for entry in points] == [entry[:2] for entry in published]
    assert [round(float(mass), 4) for *_, mass in points] == [mass for *_, mass in published]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["inspected", "censored"])
def test_the_fenchel_conditions_hold_at_the_estimate(kind, seed):
    lives = drawn(np.random.default_rng(seed), kind)
    estimate = turnbull(lives)
    assert estimate.converged
    # By hand: no single interval gains likelihood, and those with mass neither lose it.
    covered = (lives.low[:, None] <= estimate.low) & (estimate.high <= lives.high[:, None])
    exact = lives.is_exact[:, None]
    covered = np.where(exact, lives.low[:, None] == estimate.high, covered)
    covered &= exact | (estimate.high > lives.low[:, None])
    share = covered @ estimate.mass
    gain = (covered / share[:, None]).sum(axis=0) / len(lives)
    assert gain.max() < 1 + 1e-4
    assert gain[estimate.mass > 1e-3] == pytest.approx(1, abs=1e-3)


def test_without_intervals_it_is_the_product_limit_estimate():
    lives = drawn(np.random.default_rng(1), "censored")
    fitter = KaplanMeierFitter().fit(lives.low, np.isfinite(lives.high))
    for time in (0.3, 0.8, 1.4):
        least, most = turnbull(lives).ended_by(np.array([time]))
        assert least == most == pytest.approx(1 - fitter.predict(time), abs=1e-9)


def test_rows_that_entered_late_are_at_risk_from_their_entry_on():
    table = load_multicenter_aids_cohort_study()
    ended = table["D"].to_numpy() == 1
    life, entered = table["T"].to_numpy(float), table["W"].to_numpy(float)
    kept = life > entered
    life, entered, ended = life[kept], entered[kept], ended[kept]
    lives = LifeIntervals(life, np.where(ended, life, np.inf), entered)
    fitter = KaplanMeierFitter().fit(life, ended, entry=entered)
    for time in (2.0, 4.0, 6.0, 8.0):
        least, _ = turnbull(lives).ended_by(np.array([time]))
        assert float(least[0]) == pytest.approx(1 - fitter.predict(time), abs=1e-9)


def test_psychiatric_patients_who_entered_at_their_age():
    table = load_psychiatric_patients()
    entered = table["Age"].to_numpy(float)
    life = entered + table["T"].to_numpy(float)
    ended = table["C"].to_numpy() == 1
    lives = LifeIntervals(life, np.where(ended, life, np.inf), entered)
    fitter = KaplanMeierFitter().fit(life, ended, entry=entered)
    for age in (40.0, 55.0, 65.0):
        least, _ = turnbull(lives).ended_by(np.array([age]))
        assert float(least[0]) == pytest.approx(1 - fitter.predict(age), abs=1e-9)


def test_the_interval_of_a_share_without_censoring_is_that_of_the_likelihood_ratio():
    lives = LifeIntervals(*(np.arange(1.0, 101.0),) * 2, np.zeros(100))
    estimate, (least, most) = LikelihoodIntervals(lives).ended_by(30.0)
    assert least == most == pytest.approx(0.3)

    def drop(p):  # of the binomial log-likelihood, twice
        return 2 * (30 * np.log(0.3 / p) + 70 * np.log(0.7 / (1 - p)))

    assert drop(estimate.low) == pytest.approx(3.8415, abs=0.02)
    assert drop(estimate.high) == pytest.approx(3.8415, abs=0.02)


def test_between_inspections_the_data_leave_the_share_open():
    lives = LifeIntervals(
        np.repeat([0.0, 1.0, 2.0], 20), np.repeat([1.0, 2.0, np.inf], 20), np.zeros(60)
    )
    estimate, (least, most) = LikelihoodIntervals(lives).ended_by(1.5)
    assert (least, most) == (pytest.approx(1 / 3), pytest.approx(2 / 3))
    assert estimate.low < least < most < estimate.high


def test_no_ended_row_gives_the_exact_binomial_bound():
    lives = LifeIntervals(np.full(20, 5.0), np.full(20, np.inf), np.zeros(20))
    estimate, _ = LikelihoodIntervals(lives).ended_by(2.0)
    assert (estimate.value, estimate.low) == (0.0, 0.0)
    assert estimate.high == pytest.approx(1 - 0.025 ** (1 / 20), abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["censored", "late entry", "inspected"])
def test_the_likelihood_ratio_interval_covers(kind):
    times = np.array([0.4, 0.8, 1.2])
    truth = 1 - np.exp(-(times**1.7))
    hits = np.zeros((300, 3))
    for seed in range(300):
        shares = LikelihoodIntervals(drawn(np.random.default_rng(seed), kind, 100))
        for i, time in enumerate(times):
            estimate = shares.ended_by(time)[0]
            hits[seed, i] = estimate.low <= truth[i] <= estimate.high
    coverage = hits.mean(axis=0)
    print(kind, coverage)
    most = 1.0 if kind == "inspected" else 0.98  # conservative at continuous inspection times
    assert ((coverage >= 0.92) & (coverage <= most)).all()
