"""Polynomials as control variate of Shapley effects."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from computed import with_output
from dependent_studies import assert_near, entry_of, weighted

from benchmarks.coverage import dependent, dependent_effects, problems
from benchmarks.coverage.neighbours import by_neighbours
from uq.result.result import Result
from uq.assess.design_sample import sample_of
from uq.indices import polynomials
from uq.indices.index import SHAPLEY
from uq.indices.methods import METHODS


def of_case(words, samples, seed=1):
    case = dependent.CASES[words]
    of = dependent.study(case.output, case.laws, case.correlations, samples)
    return problems.computed(problems.with_seed(of, seed)), case


def widths(found):
    return np.array([one.high - one.low for one in found.values()])


def controlled_and_alone(ds, output):
    sample = replace(sample_of(Result(ds)), values=ds[output].values)
    ours = METHODS["shapley"].indices(sample).values[SHAPLEY]
    return ours, dependent.of_paths_alone(ds, output)


@pytest.mark.parametrize("words", ["correlation 0", "correlation 0.9", "interaction"])
def test_effects_of_polynomials_in_normal_inputs_are_exact(words):
    ds, case = of_case(words, 128)
    found = entry_of(ds)["shapley"]
    for name, value in case.truth.items():
        assert found[name]["value"] == pytest.approx(value, abs=1e-10)
        if value:
            assert found[name]["low"] < value < found[name]["high"] < found[name]["low"] + 1e-8


def test_effects_of_polynomials_of_higher_degree_are_exact():
    # Given one of two scores with correlation r, the mean of the other's Hermite polynomial of
    # degree n has r^2n of its variance: here 2 of the square of x1, 1.5 of the cube of x4.
    r, square, cube, own = 0.6, 2.0, 1.5, 1.0
    ds = weighted(r, 256)
    x1, x3, x4 = (ds[name].values for name in ("x1", "x3", "x4"))
    y = x1**2 + (x4**3 - 3 * x4) / 2 + x3
    found = entry_of(with_output(ds, "weighted", y))["shapley"]
    alone = square + cube * r**6, cube + square * r**4
    both, whole = square + cube, square + cube + own
    truth = {
        "x1": (alone[0] + both - alone[1]) / 2 / whole,
        "x4": (alone[1] + both - alone[0]) / 2 / whole,
        "x2": own * r**2 / 2 / whole,
        "x3": own * (1 - r**2 / 2) / whole,
    }
    for name, value in truth.items():
        assert found[name]["value"] == pytest.approx(value, abs=1e-9)


def test_values_of_polynomials_are_those_of_many_rows():
    r, k = 0.7, 50_000
    c = np.array([[1.0, r, 0.0], [r, 1.0, 0.0], [0.0, 0.0, 1.0]])
    terms = polynomials.terms_of(range(3), c, 100)
    rng = np.random.default_rng(1)
    weights = rng.standard_normal((len(terms), 1))
    found = polynomials.shapley_values(weights, terms, c)

    def y(z):
        return (polynomials.products(z, terms, c) @ weights)[:, 0]

    z, e = rng.standard_normal((2, k, 3))
    half = np.sqrt(1 - r**2)

    def again(some):  # the scores outside of some, drawn again given these
        x = np.where(np.isin(range(3), some), z, e)
        if 0 in some and 1 not in some:
            x[:, 1] = r * z[:, 0] + half * e[:, 1]
        elif 1 in some and 0 not in some:
            x[:, 0] = r * z[:, 1] + half * e[:, 0]
        elif not {0, 1} & set(some):
            x[:, 1] = r * e[:, 0] + half * e[:, 1]
        return x

    z[:, 1] = r * z[:, 0] + half * z[:, 1]
    whole = y(z)
    explained = {
        some: np.cov(whole, y(again(some)))[0, 1]
        for size in range(4)
        for some in combinations(range(3), size)
    }
    many = dependent_effects.shares(lambda some: explained[tuple(sorted(some))], 3)
    assert found / found.sum() == pytest.approx(many, abs=0.03)


def test_the_degree_is_what_the_rows_allow():
    none = np.eye(4)
    counts = [len(polynomials.terms_of(range(4), none, most)) for most in (3, 4, 13, 14, 34, 99)]
    assert counts == [0, 4, 4, 14, 34, 34]


def test_products_of_too_many_correlated_inputs_are_left_to_the_paths():
    matrix = np.full((13, 13), 0.1) + 0.9 * np.eye(13)
    assert not polynomials.terms_of(range(13), matrix, 1000)
    matrix[:6, 6:] = matrix[6:, :6] = 0.0
    terms = polynomials.terms_of(range(13), matrix, 1000)
    assert (0, 1) in terms and (6, 12) in terms and (5, 6) not in terms


def test_what_resembles_a_polynomial_has_narrower_intervals():
    for words, factor in (("exponential, correlation 0.6", 0.1), ("mild lognormal", 0.3)):
        ds, case = of_case(words, 256)
        ours, alone = controlled_and_alone(ds, case.output)
        assert (widths(ours) < factor * widths(alone)).all()
        for name, value in case.truth.items():
            assert abs(ours[name].value - value) < 0.75 * (ours[name].high - ours[name].low)
        assert sum(one.value for one in ours.values()) == pytest.approx(1.0)


def test_what_does_not_resemble_one_has_intervals_as_without():
    ds = weighted(0.6, 512)
    x1, x3 = ds["x1"].values, ds["x3"].values
    for y in (np.sin(6 * x1 + 4 * x3), (x1 + x3 > 3.5) * 1.0):
        ours, alone = controlled_and_alone(with_output(ds, "weighted", y), "weighted")
        assert (widths(ours) < 1.2 * widths(alone))[[0, 2]].all()


def test_elements_of_an_output_add_up():
    # Of x1 + x2 + 2 x3, and of x3 alone, whose correlated inputs are x2 and x3.
    r = 0.6
    ds = weighted(r, 256)
    both = np.stack([ds["weighted"].values, ds["x3"].values], axis=1)
    found = METHODS["shapley"].indices(replace(sample_of(Result(ds)), values=both))
    sizes = 6.0 + 4.0 * r, 1.0
    alone = {"x2": r**2 / 2, "x3": 1 - r**2 / 2}
    for name, value in dependent.of_normal(r).items():
        truth = (sizes[0] * value + sizes[1] * alone.get(name, 0.0)) / sum(sizes)
        assert found.values[SHAPLEY][name].value == pytest.approx(truth, abs=1e-9)


def test_discrete_inputs_stay_with_the_paths():
    # A sign, independent of the numbers, with a third of the variance.
    laws = {"x1": dependent.SIGN, "x2": dependent.NORMAL, "x3": dependent.NORMAL}
    of = dependent.study("sum", laws, np.eye(3), 512)
    found = entry_of(problems.computed(of))["shapley"]
    assert_near(found, dict.fromkeys(laws, 1 / 3))


@pytest.mark.parametrize("words", ["correlation 0.9", "exponential, correlation 0.6"])
def test_intervals_are_narrower_than_those_of_nearest_neighbours(words):
    # Of as many rows: 256 paths of 5, or 8 parts of 160 independent rows.
    ds, case = of_case(words, 256)
    ours = controlled_and_alone(ds, case.output)[0]
    rows = dependent.study(case.output, case.laws, case.correlations, 256 * 5, "monte-carlo")
    rows = problems.computed(rows)
    x = rows[list(case.laws)].to_dataarray().values.T
    y = rows[case.output].values
    found = np.array([by_neighbours(x[i::8], y[i::8]) for i in range(8)])
    theirs = 2 * 2.365 * found.std(axis=0, ddof=1) / np.sqrt(8)
    assert (widths(ours) < 0.5 * theirs).all()
