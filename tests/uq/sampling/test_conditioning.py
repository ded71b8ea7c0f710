"""A law never leaves its parameter's bounds, keeps both tails, and is refused when it cannot."""

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from scipy_counterparts import of_scipy

from uq.contract import Parameter
from uq.sampling.laws import law_of
from uq.sampling.truncation import cdf_within, law_problem, ppf_within

LAWS = {
    "uniform": {"lower": 2.0, "upper": 5.0},
    "loguniform": {"lower": 2.0, "upper": 5.0},
    "normal": {"mean": 3.0, "sd": 0.5},
    "truncated-normal": {"mean": 3.0, "sd": 0.5, "lower": 2.5, "upper": 4.0},
    "lognormal": {"mean": 3.0, "cv": 0.3},
    "triangular": {"lower": 2.0, "mode": 2.5, "upper": 5.0},
    "beta": {"alpha": 2.0, "beta": 3.0, "lower": 2.0, "upper": 5.0},
    "weibull": {"shape": 2.0, "scale": 3.0},
    "gamma": {"shape": 2.5, "scale": 3.0},
}


def law(distribution, **arguments):
    return law_of({"distribution": distribution, **arguments})


def parameter(low, high):
    return Parameter("k", "N m-1", "stiffness", (low, high), "assumed")


def problem(bounds, distribution, **arguments):
    return law_problem(law(distribution, **arguments), parameter(*bounds))


@pytest.mark.parametrize("name", LAWS)
def test_quantiles_invert_the_conditional_distribution(name):
    frozen = of_scipy(law(name, **LAWS[name]))
    low, high = frozen.ppf(0.1), frozen.ppf(0.8)
    u = np.linspace(0.001, 0.999, 501)
    x = ppf_within(law(name, **LAWS[name]), u, (low, high))
    conditional = (frozen.cdf(x) - frozen.cdf(low)) / (frozen.cdf(high) - frozen.cdf(low))
    np.testing.assert_allclose(conditional, u, atol=1e-12)


@given(
    name=st.sampled_from(sorted(LAWS)),
    ends=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    u=st.lists(st.floats(0, 1), min_size=1, max_size=5),
)
def test_no_value_lies_outside_the_bounds(name, ends, u):
    frozen = of_scipy(law(name, **LAWS[name]))
    low, high = sorted(float(frozen.ppf(0.001 + 0.998 * end)) for end in ends)
    x = ppf_within(law(name, **LAWS[name]), np.array(u), (low, high))
    assert np.all((low <= x) & (x <= high))


@pytest.mark.parametrize("name", LAWS)
def test_rounding_does_not_cross_the_bounds(name):
    frozen = of_scipy(law(name, **LAWS[name]))
    u = np.array([0.0, 2.0**-54, 1.0 - 2.0**-53, 1.0])
    for p in np.random.default_rng(1).uniform(0.01, 0.49, 50):
        low, high = float(frozen.mean() - p), float(frozen.mean() + p)
        x = ppf_within(law(name, **LAWS[name]), u, (low, high))
        assert x.min() >= low
        assert x.max() <= high


@pytest.mark.parametrize("bounds", [(-inf, inf), (-7.0, 7.0), (-5.0, 6.5)])
def test_both_tails_of_a_normal_keep_their_accuracy(bounds):
    u = np.exp2(-np.arange(2.0, 53.0))
    normal = law("normal", mean=0.0, sd=1.0)
    exact, mirrored = stats.truncnorm(*bounds), stats.truncnorm(-bounds[1], -bounds[0])
    np.testing.assert_allclose(ppf_within(normal, u, bounds), exact.ppf(u), rtol=1e-11)
    np.testing.assert_allclose(ppf_within(normal, 1.0 - u, bounds), -mirrored.ppf(u), rtol=1e-11)


@pytest.mark.parametrize("bounds", [(2.9, 3.0), (-3.0, -2.9), (-0.3, 0.6)])
def test_probabilities_invert_quantiles_in_both_tails(bounds):
    u = np.linspace(0.001, 0.999, 7)
    normal = law("normal", mean=0.0, sd=0.3)
    probabilities = cdf_within(normal, ppf_within(normal, u, bounds), bounds)
    np.testing.assert_allclose(probabilities, u, rtol=1e-10)


def test_a_truncated_normal_is_a_normal_within_bounds():
    u = np.linspace(0.001, 0.999, 101)
    truncated = law("truncated-normal", mean=3.0, sd=0.5, lower=2.9, upper=40.0)
    normal = law("normal", mean=3.0, sd=0.5)
    np.testing.assert_array_equal(
        ppf_within(truncated, u, (0.0, 4.0)), ppf_within(normal, u, (2.9, 4.0))
    )
    far = law("truncated-normal", mean=0.0, sd=1.0, lower=30.0, upper=40.0)
    np.testing.assert_allclose(
        ppf_within(far, u, (0.0, 40.0)), stats.truncnorm(30, 40).ppf(u), rtol=1e-9
    )


@pytest.mark.parametrize("name", ["lognormal", "weibull", "gamma"])
def test_the_upper_probability_of_a_skew_law_keeps_its_accuracy(name):
    u = np.exp2(-np.arange(2.0, 50.0))
    x = ppf_within(law(name, **LAWS[name]), 1.0 - u, (0.0, inf))
    np.testing.assert_allclose(of_scipy(law(name, **LAWS[name])).sf(x), u, rtol=1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_a_law_within_wide_bounds_suits(name):
    assert law_problem(law(name, **LAWS[name]), parameter(0.0, 1e6)) is None


def test_a_mean_outside_the_bounds_names_the_mean():
    fault = problem((100.0, 1e7), "normal", mean=-5.0, sd=1.0)
    assert fault.path == ("mean",)
    assert fault.value == -5.0
    assert "100.0 to 10000000.0 [N m-1]" in fault.problem


def test_for_a_wide_normal_the_truncated_one_is_proposed():
    fault = problem((100.0, 1e7), "normal", mean=500.0, sd=100.0)
    assert fault.problem.startswith("has 3.2e-05 of its probability outside the parameter's bounds")
    assert "truncated-normal" in fault.problem


def test_for_a_law_with_ends_moving_them_is_proposed():
    fault = problem((100.0, 1e7), "uniform", lower=50.0, upper=200.0)
    assert "has 0.33 of its probability outside" in fault.problem
    assert "lower = 50.0 and upper = 200.0 must be within them" in fault.problem


def test_the_line_is_drawn_at_one_in_a_million():
    sd = 1.0 / -stats.norm.ppf(1e-6)
    assert problem((0.0, 1e3), "normal", mean=1.0, sd=sd * 0.999) is None
    assert problem((0.0, 1e3), "normal", mean=1.0, sd=sd * 1.001) is not None


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("lognormal", {"mean": 1e6, "cv": 0.3}),
        ("lognormal", {"median": 1e6, "sigma": 2.0}),
        ("normal", {"mean": 1e6, "sd": 1e5}),
        ("weibull", {"shape": 3.0, "scale": 1e6}),
        ("gamma", {"shape": 9.0, "scale": 1e5}),
    ],
)
def test_without_an_upper_bound_the_lower_tail_alone_counts(name, arguments):
    frozen = of_scipy(law(name, **arguments))
    suits, leaves, cuts = (float(frozen.ppf(p)) for p in (0.99e-6, 1.01e-6, 0.25))
    assert problem((suits, inf), name, **arguments) is None
    assert problem((leaves, inf), name, **arguments).problem.startswith(
        "has 1e-06 of its probability outside the parameter's bounds, "
        f"{leaves!r} to inf [N m-1] (allowed: 1e-06)"
    )
    u = np.array([2.0**-53, 0.2, 0.6, 1.0 - 2.0**-53])
    x = ppf_within(law(name, **arguments), u, (cuts, inf))
    np.testing.assert_allclose(frozen.sf(x), 0.75 * (1.0 - u), rtol=1e-9)


def test_a_truncated_normal_may_have_its_peak_outside():
    assert problem((1.0, 9.0), "truncated-normal", mean=0.0, sd=1.0, lower=1.0, upper=3.0) is None


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("lognormal", {"mean": 1.0, "cv": 1e200}),
        ("truncated-normal", {"mean": 0.0, "sd": 1e-3, "lower": 1.0, "upper": 2.0}),
    ],
)
def test_numbers_beyond_arithmetic_are_refused(name, arguments):
    assert problem((0.0, 10.0), name, **arguments).problem.startswith(
        "these numbers are too extreme"
    )
