import numpy as np
import pytest
from scipy import stats

from uq.stats import intervals
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.intervals import mean_interval, share_interval, sized
from uq.stats.moments import corrected_mean_interval, hall_interval
from uq.stats.order_statistics import quantile, quantile_interval, rows_for_bound, tolerance_bounds

RNG = np.random.default_rng(3)
VALUES = RNG.lognormal(size=200)
REPLICATE = np.arange(200) % 8
REPLICATES = Dependence(REPLICATE)


@pytest.mark.parametrize(
    ("values", "size"),
    [([3.0, -1.0], 4.0), ([-3.0, 1.0], 4.0), ([np.nan, np.inf, -np.inf, 3.0], 4.0), ([], 1.0)],
)
def test_the_largest_finite_magnitude_is_the_size(values, size):
    scaled, power = sized(np.array(values))
    assert power == size
    assert np.array_equal(scaled * power, values, equal_nan=True)


def test_mean_of_independent_rows_is_students_interval_beyond_two_more_outliers():
    scale = VALUES.std(ddof=1) / np.sqrt(200)
    low, high = stats.t.interval(0.95, 199, loc=VALUES.mean(), scale=scale)
    more = 2 * (VALUES.max() + VALUES.min() - 2 * VALUES.mean()) / 200
    assert more > 0
    assert mean_interval(VALUES) == pytest.approx((low, high + more))
    assert mean_interval(-VALUES) == pytest.approx((-high - more, -low))


@pytest.mark.parametrize("law", [stats.lognorm(1.0), stats.norm(), stats.gamma(0.2), stats.t(5)])
def test_the_mean_of_a_skewed_law_is_covered(law):
    """Student's interval of 100 lognormal rows covers 91 %, of 100 rows of gamma(0.2) 92 %."""
    rng = np.random.default_rng(5)
    ends = np.array([mean_interval(law.rvs(100, random_state=rng)) for _ in range(600)])
    held = ((ends[:, 0] <= law.mean()) & (law.mean() <= ends[:, 1])).mean()
    assert 0.94 < held < 0.985


def test_mean_of_replicates_is_students_interval_of_their_means():
    means = [VALUES[REPLICATE == r].mean() for r in range(8)]
    expected = stats.t.interval(0.95, 7, loc=VALUES.mean(), scale=stats.sem(means))
    assert mean_interval(VALUES, REPLICATES) == pytest.approx(expected)


@pytest.mark.parametrize("values", [VALUES, -1e9 * VALUES, VALUES[:3] + 7])
def test_a_corrected_mean_leaves_no_skewness_of_first_order(values):
    n, error = len(values), stats.sem(values)
    s = stats.skew(values) / np.sqrt(n)
    for sign, end in zip((-1, 1), hall_interval(values), strict=True):
        t = (values.mean() - end) / error  # transformed, it is the end of Student's interval
        transformed = t + s * t**2 / 3 + s**2 * t**3 / 27 + s / 6
        assert transformed == pytest.approx(-sign * stats.t.isf(0.025, n - 1))
    opposite = hall_interval(-values)
    assert opposite == pytest.approx([-end for end in reversed(hall_interval(values))])


def test_a_corrected_mean_without_skewness_is_students_interval():
    even = np.r_[VALUES, -VALUES]
    assert hall_interval(even) == pytest.approx(mean_interval(even))


def test_a_corrected_mean_of_replicates_allows_for_one_more_row_as_far_out():
    means = np.array([VALUES[REPLICATE == r].mean() for r in range(8)])
    low, high = hall_interval(means)
    more = (VALUES.max() - VALUES.mean()) / 200
    assert corrected_mean_interval(VALUES, REPLICATES) == pytest.approx((low, high + more))
    assert corrected_mean_interval(-VALUES, REPLICATES) == pytest.approx((-high - more, -low))


@pytest.mark.parametrize(
    ("hits", "method"),
    [(0, "exact"), (1, "exact"), (19, "exact"), (20, "wilson"), (80, "wilson"), (81, "exact")],
)
def test_share_of_independent_rows_is_exact_where_few_and_wilsons_elsewhere(hits, method):
    ours = share_interval(np.arange(100) < hits)
    scipys = stats.binomtest(hits, 100).proportion_ci(0.95, method=method)
    assert ours == pytest.approx((scipys.low, scipys.high), rel=1e-12)
    assert (ours[0] == 0) == (hits == 0) and ours[1] < 1
    assert share_interval(np.ones(40, dtype=bool))[1] == 1


def test_share_of_replicates_comes_from_their_scatter():
    # The same rows, dealt out so that replicates agree or differ.
    hits = np.arange(200) < 80
    agreeing = share_interval(hits, Dependence((np.arange(200) * 8 - (np.arange(200) == 0)) % 7))
    differing = share_interval(hits, Dependence(np.arange(200) // 25))
    assert np.diff(agreeing) < 0.05
    assert np.diff(differing) > 0.5
    assert agreeing[0] < 0.4 < agreeing[1]


def test_share_of_replicates_stays_within_zero_and_one():
    hits = np.zeros(800, dtype=bool)
    hits[0] = True
    low, high = share_interval(hits, Dependence(np.arange(800) % 8))
    assert 0 < low < 1 / 800 < high < 1


@pytest.mark.parametrize("probability", [0.05, 0.3, 0.5, 0.95])
def test_quantile_of_independent_rows_is_an_order_statistic(probability):
    ours = quantile_interval(VALUES, probability)
    scipys = stats.quantile_test(VALUES, p=probability).confidence_interval(0.95)
    assert ours == (scipys.low, scipys.high)


@pytest.mark.parametrize("rows", [20, 199, 1000, 12345])
def test_statistics_of_sorted_values_are_those_of_the_values_to_the_bit(rows):
    values = np.random.default_rng(rows).lognormal(size=rows)
    for ascending in (np.sort(values), np.sort(np.where(values > 2, np.inf, values))):
        shuffled = np.random.default_rng(0).permutation(ascending)
        for p in (0.05, 0.1, 1 / 3, 0.5, 0.9, 0.95):
            assert quantile(ascending, p, is_sorted=True) == quantile(shuffled, p)
            expected = quantile_interval(shuffled, p)
            assert quantile_interval(shuffled, p, ascending=ascending) == expected
        bounds = tolerance_bounds(ascending, 1, 0.9, 0.8, is_sorted=True)
        np.testing.assert_array_equal(bounds, tolerance_bounds(shuffled, 1, 0.9, 0.8))


def test_quantile_has_no_bound_where_rows_are_too_few():
    low, high = quantile_interval(VALUES[:20], 0.01)
    assert np.isnan(low) and high in VALUES
    low, high = quantile_interval(VALUES[:20], 0.99)
    assert low in VALUES and np.isnan(high)
    assert np.isnan(quantile_interval(VALUES, 0.001, REPLICATES)[0])
    assert np.isnan(quantile_interval(VALUES, 0.999, REPLICATES)[1])


def test_quantile_is_numpys_median_unbiased_one_and_knows_infinity():
    expected = np.quantile(VALUES, 0.37, method="median_unbiased")
    assert quantile(VALUES, 0.37) == expected
    assert quantile(np.array([1.0, 2.0, 3.0, np.inf, np.inf]), 0.5) == 3.0
    assert quantile(np.array([1.0, 2.0, np.inf, np.inf]), 0.5) == np.inf
    assert quantile(np.full(9, np.inf), 0.1) == np.inf
    assert np.isnan(quantile(np.array([]), 0.5))


def test_interval_of_a_quantile_may_end_in_never():
    values = np.where(np.arange(200) < 104, VALUES, np.inf)
    for dependence in (INDEPENDENT, Dependence(RNG.permutation(REPLICATE))):
        low, high = quantile_interval(values, 0.5, dependence)
        assert np.isfinite(low) and high == np.inf
        low, high = quantile_interval(values, 0.9, dependence)
        assert low == np.inf and (high == np.inf or np.isnan(high))


def test_no_interval_without_evidence():
    unknown = pytest.approx((np.nan, np.nan), nan_ok=True)
    same = Dependence(np.zeros(200, dtype=int))
    hits = VALUES > 1
    assert mean_interval(VALUES, same) == unknown
    assert share_interval(hits, same) == unknown
    assert quantile_interval(VALUES, 0.5, same) == unknown
    assert mean_interval(np.full(200, 0.1)) == unknown
    assert mean_interval(np.full(200, 0.1), REPLICATES) == unknown
    assert mean_interval(VALUES[:1]) == unknown
    assert mean_interval(VALUES[:0]) == unknown
    assert share_interval(hits[:0]) == unknown
    assert quantile_interval(VALUES[:0], 0.5) == unknown
    # Replicates that agree to the last bit say nothing about the error.
    assert share_interval(np.arange(200) < 80, REPLICATES) == unknown
    assert mean_interval(np.repeat(VALUES[:25], 8), REPLICATES) == unknown
    assert share_interval(np.arange(200) < 0, same) == unknown


def test_a_replicate_without_rows_does_not_count():
    gone = REPLICATE != 3
    shifted = np.where(REPLICATE > 3, REPLICATE - 1, REPLICATE)
    assert mean_interval(VALUES[gone], REPLICATES[gone]) == mean_interval(
        VALUES[gone], Dependence(shifted[gone])
    )


@pytest.mark.parametrize(
    ("coverage", "confidence", "failed", "rows"),
    [(0.95, 0.95, 0, 59), (0.95, 0.95, 1, 93), (0.95, 0.95, 2, 124), (0.99, 0.95, 0, 299),
     (0.95, 0.99, 0, 90), (0.9, 0.95, 0, 29)],
)  # fmt: skip
def test_tolerance_needs_the_numbers_of_rows_that_textbooks_list(
    coverage, confidence, failed, rows
):
    assert rows_for_bound(coverage, confidence, failed) == rows
    values = np.arange(float(rows - failed))
    enough = tolerance_bounds(values, failed, coverage, confidence)
    assert enough == (0.0, values[-1])
    short = tolerance_bounds(values[1:], failed, coverage, confidence)
    assert short == pytest.approx((np.nan, np.nan), nan_ok=True)


def test_tolerance_takes_the_innermost_order_statistic_that_will_do():
    n = 400
    low, high = tolerance_bounds(np.arange(1.0, n + 1), 0, 0.95, 0.95)
    for rank in (low, n + 1 - high):
        assert stats.beta.cdf(0.05, rank, n + 1 - rank) >= 0.95
        assert stats.beta.cdf(0.05, rank + 1, n - rank) < 0.95


def test_failed_rows_count_as_the_worst_on_each_side():
    values = RNG.permutation(np.arange(300.0))
    low, high = tolerance_bounds(values, 4, 0.95, 0.95)
    assert low == tolerance_bounds(np.r_[values, np.full(4, -1.0)], 0, 0.95, 0.95)[0]
    assert high == tolerance_bounds(np.r_[values, np.full(4, 999.0)], 0, 0.95, 0.95)[1]


def test_constant_means_constant_up_to_rounding():
    third = np.array([0.1 + 0.2, 0.3])
    assert intervals.is_constant(third)
    assert not intervals.is_constant(np.array([0.3, 0.3 + 1e-12]))
    assert not intervals.is_constant(np.array([0.0, 1e-300]))
