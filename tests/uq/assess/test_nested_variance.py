"""Components of the variance of nested effects, and what rows cannot tell apart."""

import numpy as np
import pytest
from nested_studies import CHANCE, LEVELS, OWN, SHARED, VARIANCES
from scipy import stats

from uq.assess.nested_table import shares_of
from uq.stats.variance_components import nested_shares


def effects(variances, shape, seed=0):
    """Return random effects with these variances."""
    rng = np.random.default_rng(seed)
    shapes = (shape[0], 1, 1), (*shape[:2], 1), shape
    return sum(v**0.5 * rng.standard_normal(s) for v, s in zip(variances, shapes, strict=True))


def test_interplay_with_what_is_shared_is_own():
    x1, x2 = (np.random.default_rng(i).choice([-1.0, 1.0], (400, 10 * i, 1)) for i in (0, 1))
    x1 = np.random.default_rng(2).choice([-1.0, 1.0], (400, 1, 1))
    shares = nested_shares(x1 * x2)
    assert shares.middle.value == pytest.approx(1.0, abs=0.02)
    assert shares.outer.low == 0.0


def test_components_are_those_of_the_analysis_of_variance():
    table = effects((0.3, 0.5, 0.2), (6, 4, 3))
    samples, units, repeats = table.shape
    means = table.mean(axis=2)
    within = table.var(axis=2, ddof=1).mean()
    between = repeats * means.var(axis=1, ddof=1).mean()
    outer = units * repeats * means.mean(axis=1).var(ddof=1)
    parts = (
        (outer - between) / (units * repeats),
        (between - within) / repeats,
        within,
    )
    shares = nested_shares(table)
    assert shares.variance == pytest.approx(sum(parts))
    assert [share.value * shares.variance for share in shares[:3]] == pytest.approx(parts)
    assert all("8 samples are required" in share.reason for share in shares[:3])


def test_the_interval_is_a_jackknife_over_samples():
    table = effects((0.7, 0.2, 0.1), (12, 4, 3))
    noise = table.mean(axis=2).var(axis=1, ddof=1).mean() / 4 / nested_shares(table).variance

    def logit(share):
        return np.log((share + noise) / (1 - share))

    outer = nested_shares(table).outer
    pseudo = np.array(
        [
            12 * outer.value - 11 * nested_shares(np.delete(table, i, axis=0)).outer.value
            for i in range(12)
        ]
    )
    squares = (pseudo - pseudo.mean()) ** 2
    slope = 1 / (outer.value + noise) + 1 / (1 - outer.value)
    widened = 1 + 2 * (squares.max() / squares.sum()) ** 2
    half = stats.t.ppf(0.975, 11) * slope * np.sqrt(widened * squares.sum() / 11 / 12)
    assert logit(outer.high) - logit(outer.value) == pytest.approx(half)
    assert logit(outer.value) - logit(outer.low) == pytest.approx(half)


def test_missing_values_leave_the_shares_unbiased():
    table = effects((0.3, 0.3, 0.4), (4000, 4, 3))
    whole = nested_shares(table)
    table[np.random.default_rng(1).random(table.shape) < 0.3] = np.nan
    shares = nested_shares(table)
    for share, other in zip(shares[:3], whole[:3], strict=True):
        assert share.value == pytest.approx(other.value, abs=0.03)
    table[:10] = np.nan
    assert nested_shares(table).left_out == shares.left_out + 10


def test_shifts_and_units_change_no_share():
    table = effects((0.3, 0.3, 0.4), (50, 4, 3))
    plain, other = nested_shares(table), nested_shares(1e6 + 1e-3 * table)
    for before, after in zip(plain[:3], other[:3], strict=True):
        assert after.numbers == pytest.approx(before.numbers, rel=1e-6)


NONE, ALL, UNKNOWN = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (np.nan, np.nan, np.nan)


@pytest.mark.parametrize(
    ("varying", "shape", "expected"),
    [
        ({SHARED}, (20, 2, 2), (ALL, NONE, NONE)),
        ({OWN}, (20, 2, 2), (NONE, ALL, NONE)),
        ({CHANCE}, (20, 2, 2), (NONE, NONE, ALL)),
        ({SHARED, OWN}, (20, 1, 2), (UNKNOWN, UNKNOWN, NONE)),
        ({SHARED, CHANCE}, (20, 1, 1), (UNKNOWN, NONE, UNKNOWN)),
        ({OWN, CHANCE}, (20, 2, 1), (NONE, ALL, UNKNOWN)),
        ({SHARED, OWN, CHANCE}, (20, 1, 1), (UNKNOWN, UNKNOWN, UNKNOWN)),
    ],
)
def test_what_is_known_without_an_estimate(varying, shape, expected):
    variances = [float(level in varying) for level in LEVELS.values()]
    shares = shares_of(effects(variances, shape), varying).shares
    for level, numbers in zip(LEVELS.values(), expected, strict=True):
        assert shares[level].numbers == pytest.approx(numbers, nan_ok=True)
        assert bool(shares[level].reason) == (numbers is UNKNOWN)


@pytest.mark.parametrize(
    ("varying", "shape"),
    [
        ({SHARED, OWN}, (3000, 3, 1)),
        ({SHARED, CHANCE}, (3000, 3, 1)),
        ({SHARED, CHANCE}, (3000, 1, 3)),
        ({OWN, CHANCE}, (1500, 2, 3)),
        ({SHARED, OWN, CHANCE}, (3000, 3, 2)),
    ],
)
def test_two_levels_are_told_apart_by_what_the_rows_have(varying, shape):
    variances = [
        {SHARED: 0.2, OWN: 0.3, CHANCE: 0.5}[name] * (name in varying) for name in VARIANCES
    ]
    shares = shares_of(effects(variances, shape), varying)
    for level, variance in zip(VARIANCES, variances, strict=True):
        assert shares.shares[level].value == pytest.approx(variance / sum(variances), abs=0.05)


def test_one_repeat_counts_chance_as_own():
    shares = shares_of(effects((0.2, 0.3, 0.5), (3000, 4, 1)), set(VARIANCES)).shares
    assert shares[OWN].value == pytest.approx(0.8, abs=0.05)
    assert shares[OWN].assumes == "that differences between units include chance"
    assert np.isnan(shares[CHANCE].value)
    assert shares[CHANCE].reason == (
        "one repeat per unit cannot separate chance from differences between units; set repeats = 2"
    )


def test_one_unit_tells_chance_alone():
    shares = shares_of(effects((0.2, 0.3, 0.5), (3000, 1, 4)), set(VARIANCES)).shares
    assert shares[CHANCE].value == pytest.approx(0.5, abs=0.05)
    assert "set units = 2" in shares[SHARED].reason and np.isnan(shares[OWN].value)


def test_replicates_of_an_even_design_are_what_is_independent():
    table = effects((0.3, 0.3, 0.4), (64, 4, 3))
    eight = nested_shares(table, replicate=np.repeat(np.arange(8), 8)).outer
    alone = nested_shares(table).outer
    assert eight.value == pytest.approx(alone.value)
    assert eight.numbers[1:] != pytest.approx(alone.numbers[1:])
    share = nested_shares(table, replicate=np.zeros(64, int)).outer
    assert share.reason == "a single replicate does not show its scatter" and np.isnan(share.low)


def test_values_that_agree_have_no_shares():
    assert nested_shares(np.ones((20, 2, 2))).outer.reason == "all values are the same"
    same = nested_shares(np.tile(np.random.default_rng(0).random((20, 1, 1)), (1, 3, 1)))
    assert same.middle.value == 0.0 and not same.middle.has_interval
    assert same.middle.reason == "no two samples show different shares"


def test_where_nothing_is_shared_a_sample_without_some_of_its_rows_is_not_left_out():
    table = effects((0.0, 1.0, 0.0), (20, 3, 1))
    table[4, 1] = table[7] = np.nan
    shares = shares_of(table, {OWN})
    assert shares.left_out == 1 and shares.shares[OWN].numbers == ALL
