"""Heavy tails are recognised, light ones left alone."""

import numpy as np
import pytest
from scipy import stats

from uq.stats.tails import generalised_pareto, heavier_tail, lacks_variance

LIGHT = {
    "normal": stats.norm(),
    "uniform": stats.uniform(),
    "exponential": stats.expon(),
    "Weibull, shape 0.8": stats.weibull_min(0.8),
    "lognormal, sigma 1": stats.lognorm(1.0),
}
HEAVY = {
    "Pareto, index 1.5": stats.pareto(1.5),
    "Pareto, index 0.8": stats.pareto(0.8),
    "Cauchy": stats.cauchy(),
    "Cauchy, far from zero": stats.cauchy(1e3),
}


def share(law, rows, repetitions, verdict="no_variance"):
    """Return how often a tail is found to be heavy."""
    rng = np.random.default_rng(0)
    tails = [heavier_tail(law.rvs(rows, random_state=rng)) for _ in range(repetitions)]
    return np.mean([tail is not None and getattr(tail, verdict) for tail in tails])


@pytest.mark.parametrize("rows", [64, 1000])
@pytest.mark.parametrize("law", LIGHT)
def test_light_tails_are_not_called_heavy(law, rows):
    assert share(LIGHT[law], rows, 100) <= 0.03


@pytest.mark.parametrize("law", HEAVY)
def test_tails_without_variance_are_found(law):
    assert share(HEAVY[law], 1000, 50) >= 0.9


def test_a_mean_that_does_not_exist_is_distinguished_from_one_that_does():
    assert share(stats.pareto(0.8), 1000, 50, "no_mean") >= 0.9
    assert share(stats.pareto(1.5), 1000, 50, "no_mean") <= 0.05


def test_k_is_that_of_the_law_within_its_interval():
    tail = heavier_tail(stats.pareto(1.5).ppf((np.arange(4000) + 0.5) / 4000))
    assert tail.side == "upper" and tail.values == 1000
    assert tail.k == pytest.approx(1 / 1.5, abs=0.02)
    assert tail.low < 1 / 1.5 < tail.high


def test_the_lower_tail_counts_as_much():
    y = stats.pareto(1.5).rvs(1000, random_state=0)
    above, below = heavier_tail(y), heavier_tail(-y)
    assert above.side == "upper" and below.side == "lower"
    assert above[:4] == below[:4]


def test_scale_and_place_do_not_matter():
    y = stats.pareto(1.5).rvs(500, random_state=1)
    assert heavier_tail(1e-9 * y + 1e-7).k == pytest.approx(heavier_tail(y).k, abs=1e-6)


@pytest.mark.parametrize(
    "values",
    [
        np.zeros(1000),
        np.arange(1000) % 7.0,
        np.where(np.arange(200) % 20 == 0, stats.norm().rvs(200, random_state=0), 0.0),
        stats.pareto(0.8).rvs(49, random_state=0),
        np.array([]),
    ],
    ids=["constant", "few values", "lump", "few rows", "none"],
)
def test_no_diagnosis_without_a_tail_of_distinct_values(values):
    assert heavier_tail(values) is None


@pytest.mark.parametrize("rows", [200, 1000])
def test_heavy_tails_of_counts_and_of_what_is_mostly_zero_are_seen(rows):
    rng = np.random.default_rng(1)
    counts = [np.floor(stats.pareto(0.8).rvs(rows, random_state=rng)) for _ in range(20)]
    assert sum(heavier_tail(y).no_variance for y in counts) >= 15
    zeros = np.where(rng.random(10 * rows) < 0.9, 0.0, rng.pareto(0.9, 10 * rows))
    assert heavier_tail(zeros).no_variance


@pytest.mark.parametrize(
    "law",
    [stats.geom(0.05), stats.geom(0.3), stats.poisson(3), stats.poisson(30), stats.randint(0, 50)],
    ids=["geometric", "steep", "few counts", "many counts", "integers"],
)
@pytest.mark.parametrize("rows", [64, 1000])
def test_light_tails_of_counts_are_not_called_heavy(law, rows):
    rng = np.random.default_rng(2)
    for _ in range(40):
        assert not lacks_variance(law.rvs(rows, random_state=rng).astype(float))


def test_a_regime_far_away_is_no_tail():
    rng = np.random.default_rng(0)
    y = rng.standard_normal(2000) + 100 * (rng.random(2000) < 0.05)
    assert not heavier_tail(y).no_variance


def test_the_estimator_agrees_with_maximum_likelihood():
    excess = np.sort(stats.genpareto(0.4, scale=3.0).rvs(2000, random_state=2))
    shape, _, scale = stats.genpareto.fit(excess, floc=0)
    assert generalised_pareto(excess) == (
        pytest.approx(shape, abs=0.01),
        pytest.approx(scale, rel=0.01),
    )
