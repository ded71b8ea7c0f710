"""Every law has the moments and quantiles that its name and arguments promise."""

from math import exp, gamma, log, sqrt

import numpy as np
import pytest
from pydantic import ValidationError
from scipy_counterparts import of_scipy

from uq.sampling.laws import LAWS, law_of

# name -> arguments, mean, standard deviation in closed form
MOMENTS = {
    "uniform": ({"lower": 2.0, "upper": 5.0}, 3.5, 3 / sqrt(12)),
    "loguniform": (
        {"lower": 2.0, "upper": 5.0},
        3 / log(2.5),
        sqrt((25 - 4) / (2 * log(2.5)) - (3 / log(2.5)) ** 2),
    ),
    "normal": ({"mean": 3.0, "sd": 0.5}, 3.0, 0.5),
    # The classical half normal: mean + sd sqrt(2/pi), variance sd^2 (1 - 2/pi).
    "truncated-normal": (
        {"mean": 3.0, "sd": 0.5, "lower": 3.0, "upper": 300.0},
        3 + 0.5 * sqrt(2 / np.pi),
        0.5 * sqrt(1 - 2 / np.pi),
    ),
    "lognormal": ({"mean": 13750.0, "cv": 0.15}, 13750.0, 0.15 * 13750.0),
    "triangular": (
        {"lower": 1.0, "mode": 2.0, "upper": 6.0},
        3.0,
        sqrt((1 + 4 + 36 - 2 - 6 - 12) / 18),
    ),
    "beta": (
        {"alpha": 2.0, "beta": 3.0, "lower": 1.0, "upper": 6.0},
        1 + 5 * 0.4,
        5 * sqrt(2 * 3 / (25 * 6)),
    ),
    "weibull": (
        {"shape": 2.0, "scale": 3.0},
        3 * gamma(1.5),
        3 * sqrt(gamma(2) - gamma(1.5) ** 2),
    ),
    "gamma": ({"shape": 2.5, "scale": 3.0}, 7.5, 3 * sqrt(2.5)),
    # Vose, "Risk analysis": mean (a + 4 b + c)/6, variance (mean - a)(c - mean)/7.
    "pert": ({"lower": 1.0, "mode": 2.0, "upper": 6.0}, 2.5, sqrt(1.5 * 3.5 / 7)),
    "gumbel": ({"mode": 3.0, "scale": 0.5}, 3 + 0.5 * np.euler_gamma, 0.5 * np.pi / sqrt(6)),
    "exponential": ({"mean": 3.0}, 3.0, 3.0),
    "discrete-choice": ({"values": [1.0, 4.0], "weights": [2.0, 1.0]}, 2.0, sqrt(2.0)),
    "integer-range": ({"lower": 1, "upper": 6}, 3.5, sqrt(35 / 12)),
    "empirical": ({"values": [1.0, 2.0, 2.0, 7.0]}, 3.0, sqrt((4 + 1 + 1 + 16) / 4)),
    "wear-coefficient": (
        {"pair": "inconel-690/steel-405", "sigma": 0.5, "share": 0.2},
        0.2 * 4.1e-16 * exp(0.125),
        0.2 * 4.1e-16 * exp(0.125) * sqrt(exp(0.25) - 1),
    ),
    # Two boxes: [0, 1] with a third, [1, 3] with two thirds of the probability.
    "histogram": (
        {"edges": [0.0, 1.0, 3.0], "counts": [1, 2]},
        1.5,
        sqrt(1 / 3 * 1 / 3 + 2 / 3 * (27 - 1) / 6 - 1.5**2),
    ),
}


def law(distribution, **arguments):
    return law_of({"distribution": distribution, **arguments})


def test_every_law_has_its_moments_stated():
    assert set(MOMENTS) == set(LAWS)


@pytest.mark.parametrize("name", MOMENTS)
def test_mean_and_standard_deviation(name):
    arguments, mean, sd = MOMENTS[name]
    frozen = of_scipy(law(name, **arguments))
    assert frozen.mean() == pytest.approx(mean, rel=1e-10)
    assert frozen.std() == pytest.approx(sd, rel=1e-10)


@pytest.mark.parametrize("cv", [1e-3, 0.15, 1.0, 10.0])
def test_a_lognormal_has_exactly_the_mean_and_cv_asked_for(cv):
    frozen = of_scipy(law("lognormal", mean=2e-14, cv=cv))
    assert frozen.mean() == pytest.approx(2e-14, rel=1e-12)
    assert frozen.std() / frozen.mean() == pytest.approx(cv, rel=1e-12)


def test_the_two_ways_to_write_a_lognormal_agree():
    frozen = of_scipy(law("lognormal", median=3.0, sigma=0.4))
    mean, cv = 3.0 * exp(0.08), sqrt(exp(0.16) - 1)
    other = of_scipy(law("lognormal", mean=mean, cv=cv))
    u = np.linspace(0.01, 0.99, 25)
    np.testing.assert_allclose(frozen.ppf(u), other.ppf(u), rtol=1e-12)
    assert frozen.median() == pytest.approx(3.0)


def test_the_survival_of_a_weibull_is_the_one_documented():
    frozen = of_scipy(law("weibull", shape=1.5, scale=3.0))
    assert frozen.sf(2.0) == pytest.approx(exp(-((2 / 3) ** 1.5)))


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("uniform", {"lower": 1.0, "upper": 1.0}),
        ("uniform", {"lower": 2.0, "upper": 1.0}),
        ("loguniform", {"lower": 0.0, "upper": 1.0}),
        ("loguniform", {"lower": 2.0, "upper": 1.0}),
        ("normal", {"mean": 1.0, "sd": 0.0}),
        ("normal", {"mean": float("nan"), "sd": 1.0}),
        ("truncated-normal", {"mean": 1.0, "sd": 1.0, "lower": 2.0, "upper": 1.0}),
        ("lognormal", {"mean": 1.0}),
        ("lognormal", {"mean": 1.0, "sigma": 1.0}),
        ("lognormal", {"mean": 1.0, "cv": 0.1, "median": 1.0, "sigma": 0.1}),
        ("lognormal", {"mean": -1.0, "cv": 0.1}),
        ("triangular", {"lower": 1.0, "mode": 3.0, "upper": 2.0}),
        ("triangular", {"lower": 1.0, "mode": 1.0, "upper": 1.0}),
        ("beta", {"alpha": 0.0, "beta": 1.0, "lower": 0.0, "upper": 1.0}),
        ("beta", {"alpha": 1.0, "beta": 1.0, "lower": 1.0, "upper": 0.0}),
        ("weibull", {"shape": -1.0, "scale": 1.0}),
        ("gamma", {"shape": 1.0, "scale": 0.0}),
        ("pert", {"lower": 1.0, "mode": 3.0, "upper": 2.0}),
        ("gumbel", {"mode": 1.0, "scale": 0.0}),
        ("exponential", {"mean": 0.0}),
        ("discrete-choice", {"values": [1.0]}),
        ("discrete-choice", {"values": [1.0, 2.0], "weights": [1.0]}),
        ("discrete-choice", {"values": [1.0, 2.0], "weights": [1.0, 0.0]}),
        ("integer-range", {"lower": 3, "upper": 3}),
        ("integer-range", {"lower": 1.5, "upper": 3.5}),
        ("empirical", {"values": [1.0, 1.0]}),
        ("empirical", {"file": "a.csv"}),
        ("empirical", {"file": "a.csv", "column": "k", "values": [1.0, 2.0]}),
        ("histogram", {"edges": [0.0, 1.0], "counts": [1, 2]}),
        ("histogram", {"edges": [0.0, 2.0, 1.0], "counts": [1, 2]}),
        ("histogram", {"edges": [0.0, 1.0, 2.0], "counts": [0, 0]}),
        ("normal", {"mean": 1.0, "sd": 1.0, "truncate": [2.0, 1.0]}),
    ],
)
def test_arguments_that_make_no_law_are_refused(name, arguments):
    with pytest.raises(ValidationError):
        law(name, **arguments)


def test_the_ends_of_a_triangle_may_carry_its_mode():
    assert of_scipy(law("triangular", lower=1.0, mode=1.0, upper=4.0)).mean() == pytest.approx(2.0)


ELEMENTARY = {
    "uniform": [{"lower": -2.0, "upper": 5.0}, {"lower": 1e-9, "upper": 3e-9}],
    "loguniform": [{"lower": 0.3, "upper": 7.7}, {"lower": 1e-17, "upper": 4e-12}],
    "normal": [{"mean": 3.1, "sd": 0.7}, {"mean": -1e-12, "sd": 3e-13}],
    "lognormal": [{"median": 2.5e-10, "sigma": 0.5}, {"mean": 13750.0, "cv": 0.15}],
}


@pytest.mark.parametrize(("name", "arguments"), [(n, a) for n in ELEMENTARY for a in ELEMENTARY[n]])
def test_the_common_laws_have_the_bits_of_scipy(name, arguments):
    entry = law(name, **arguments)
    functions, expected = entry.frozen(), of_scipy(entry)
    rng = np.random.default_rng(5)
    u = np.concatenate([[2.0**-54, 1 - 2.0**-53], rng.uniform(size=3000)])
    u = np.concatenate([u, np.exp2(-rng.uniform(1, 1000, 500))])
    values = expected.ppf(u)
    outside = [-np.inf, -1e9, -1.0, 0.0, 1e9, np.inf]
    x = np.concatenate([values, outside, np.nextafter(values[:2], np.inf)])
    with np.errstate(all="ignore"):
        for method, at in (("ppf", u), ("isf", u), ("cdf", x), ("sf", x), ("logpdf", x)):
            function, reference = getattr(functions, method), getattr(expected, method)
            assert np.array_equal(function(at), reference(at), equal_nan=True), method
            assert function(at[7]) == reference(at[7]), method
