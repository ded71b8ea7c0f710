"""Dependent inputs drawn given some of them, and the Shapley effects of such paths."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import computed, study_of, with_output, with_status
from hypothesis import given, settings
from hypothesis import strategies as st
from input_studies import BELL, UNIFORM, inputs_of, refusal, tables
from scipy import stats

import uq
from benchmarks.coverage import dependent, dependent_effects, problems
from benchmarks.coverage.neighbours import by_neighbours
from benchmarks.coverage.tally import LOW, OURS
from uq import plots
from uq.analysis.findings import Findings
from uq.cli.sensitivity import show
from uq.conclusions.rankings import ranking_of
from uq.designs.registry import DESIGNS
from uq.errors import InputError
from uq.indices import sensitivities as module
from uq.indices.samples import sample_of
from uq.inputs.conditional import conditional_paths
from uq.methods import polynomials
from uq.methods.indices import SHAPLEY
from uq.methods.registry import METHODS
from uq.report.indices import sensitivity_of
from uq.rows.sampling import row_block, rows

NONE = (None, None, None)
RANKS = dependent.ranks([[1.0, 0.8, -0.3], [0.8, 1.0, 0.1], [-0.3, 0.1, 1.0]])
PAIR = {"parameters": ["x3", "x1"], "rank_correlation": [[1.0, -0.7], [-0.7, 1.0]]}


def paths(count, d=3, seed=1):
    sizes = dict(seed=seed, replicates=1, d=d, samples=count, second_order=False)
    return DESIGNS["shapley"].unit_rows(**sizes, start=0, stop=count)[:, 0]


def weighted(r, samples=2048):
    laws = dict.fromkeys(dependent.NAMES, dependent.NORMAL)
    return problems.computed(dependent.study("weighted", laws, dependent.matrix(r), samples))


def entry_of(ds):
    (entry,) = sensitivities(ds)["outputs"].values()
    return entry


def assert_near(found, truth):
    """Compare with half an interval more, as one of several 95 % intervals may miss."""
    for name, value in truth.items():
        low, high = found[name]["low"], found[name]["high"]
        assert abs(found[name]["value"] - value) < 0.75 * (high - low) < 0.1, name


def test_every_row_of_a_path_follows_the_copula():
    found = conditional_paths(paths(10_000), RANKS, NONE)
    for row in range(4):
        np.testing.assert_allclose(stats.spearmanr(found[:, row]).statistic, RANKS, atol=0.03)


def test_what_has_changed_depends_on_its_first_value_through_the_others_alone():
    u = paths(30_000)
    matrix = 2 * np.sin(np.pi / 6 * np.array(RANKS))
    scores = stats.norm.ppf(conditional_paths(u, RANKS, NONE))
    for row, known in ((1, (0, 2)), (2, (1,)), (3, ())):
        kept = (u[:, row] == u[:, 0])[:, list(known)].all(axis=1)
        known, drawn = list(known), [i for i in range(3) if i not in known]
        first, later = scores[kept, 0], scores[kept, row]
        np.testing.assert_array_equal(first[:, known], later[:, known])
        slopes = matrix[np.ix_(drawn, known)]
        shared = slopes @ np.linalg.solve(matrix[np.ix_(known, known)], slopes.T)
        between = first[:, drawn].T @ later[:, drawn] / kept.sum()
        np.testing.assert_allclose(between, shared, atol=0.05)


def test_paths_of_inputs_without_correlation_stay_as_they_are():
    u = paths(200)
    np.testing.assert_allclose(conditional_paths(u, np.eye(3).tolist(), NONE), u, rtol=1e-12)


def signs(u):
    return np.where(u < 0.5, 0.0, 0.5), np.where(u < 0.5, 0.5, 1.0)


def test_discrete_inputs_are_known_by_their_values_not_by_what_is_behind_them():
    # A number drawn given the signs of two others: its mean is that of rows with these signs.
    matrix = np.array([[1.0, 0.9, 0.8], [0.9, 1.0, 0.5], [0.8, 0.5, 1.0]])
    u = paths(40_000)
    found = conditional_paths(u, dependent.ranks(matrix), (signs, signs, None))
    alone = (u[:, 1, :2] == u[:, 0, :2]).all(axis=1)
    z = np.random.default_rng(1).standard_normal((400_000, 3)) @ np.linalg.cholesky(matrix).T
    for first in (False, True):
        for second in (False, True):
            drawn = alone & ((found[:, 0, :2] > 0.5) == [first, second]).all(axis=1)
            scores = stats.norm.ppf(found[drawn, 1, 2])
            truth = z[((z[:, :2] > 0) == [first, second]).all(axis=1), 2].mean()
            assert abs(scores.mean() - truth) < 4 * scores.std() / np.sqrt(drawn.sum())


MIXED = {
    "x1": {"distribution": "integer-range", "lower": 0, "upper": 1},
    "x2": UNIFORM | {"times": "x3"},
    "x3": BELL | {"truncate": [0.4, 0.55]},
    "x4": {"equals": "x3"},
}


@settings(max_examples=10)
@given(cuts=st.lists(st.integers(0, 16 * 4), max_size=4))
def test_paths_of_dependent_inputs_are_the_same_however_they_are_cut(cuts):
    study = study_of(tables(MIXED, "shapley", 16, dependence=PAIR))
    edges = [0, *sorted(cuts), 64]
    parts = [row_block(study, i, j).x for i, j in zip(edges, edges[1:], strict=False)]
    assert np.concatenate(parts).tobytes() == row_block(study, 0, 64).x.tobytes()


def test_rows_of_paths_follow_the_laws_and_their_correlation():
    study = study_of(tables(MIXED, "shapley", 2048, dependence=PAIR))
    found = inputs_of(study)
    assert rows(study) == len(found["x1"]) == 4 * 2048
    assert set(found["x1"]) == {0.0, 1.0} and abs(found["x1"].mean() - 0.5) < 0.03
    assert 0.4 <= found["x3"].min() and found["x3"].max() <= 0.55
    np.testing.assert_array_equal(found["x3"], found["x4"])
    low, high = (found["x3"][found["x1"] == value].mean() for value in (1.0, 0.0))
    assert low < high - 0.02  # their correlation is negative


def test_shapley_effects_of_dependent_inputs_are_the_known_ones():
    for r in (0.3, 0.9):
        entry = entry_of(weighted(r))
        assert_near(entry["shapley"], dependent.of_normal(r))
        assert sum(one["value"] for one in entry["shapley"].values()) == pytest.approx(1.0)


def test_shapley_effects_of_discrete_inputs_are_the_known_ones():
    study = dependent.study("sum", dependent.SIGNED, dependent.AMONG_SIGNS, 4096)
    assert_near(entry_of(problems.computed(study))["shapley"], dependent.of_signs())


def test_shapley_effects_of_a_factor_and_a_truncated_law_are_the_known_ones():
    # y = a + a f + c with a truncated, c uniform and correlated with a, and f independent of both.
    r, mean, sd = 0.7, 2.0, 0.5
    a_law = {"distribution": "normal", "mean": 2.0, "sd": 1.0, "truncate": [1.0, 5.0]}
    factor = {"distribution": "normal", "mean": mean, "sd": sd, "times": "a"}
    c_law = {"distribution": "uniform", "lower": 0.0, "upper": 9.0}
    both = {"parameters": ["a", "c"], "rank_correlation": dependent.ranks([[1.0, r], [r, 1.0]])}
    given = tables({"a": a_law, "b": factor, "c": c_law}, "shapley", 4096, dependence=both)
    found = entry_of(computed(study_of(given, "sample_models:ADDED")))["shapley"]

    z = np.linspace(-7.0, 7.0, 701)
    density = stats.multivariate_normal(cov=[[1.0, r], [r, 1.0]])
    weight = density.pdf(np.stack(np.meshgrid(z, z, indexing="ij"), axis=-1))
    weight /= weight.sum()
    u = stats.norm.cdf(z)
    a = stats.truncnorm(-1.0, 3.0, loc=2.0).ppf(u)[:, None]
    c = 9.0 * u[None, :]
    given_a = (weight * c).sum(axis=1) / weight.sum(axis=1)
    given_c = (weight * a).sum(axis=0) / weight.sum(axis=0)

    def variance(of_a, rest):
        """Return that of of_a (1 + f) + rest, over a, c and f."""
        mid = (weight * (of_a * (1 + mean) + rest) ** 2).sum()
        mid -= (weight * (of_a * (1 + mean) + rest)).sum() ** 2
        return mid, sd**2 * (weight * (of_a + 0 * c) ** 2).sum()

    one = {
        (): (0.0, sd**2 * float((weight * a).sum()) ** 2),
        (0,): variance(a, given_a[:, None]),
        (2,): variance(given_c[None, :], c),
        (0, 2): variance(a, c),
    }

    def explained(some):
        without, of_factor = one[tuple(sorted(i for i in some if i != 1))]
        return without + of_factor * (1 in some)

    truth = dict(zip(("a", "b", "c"), dependent_effects.shares(explained, 3), strict=True))
    assert_near(found, truth)


def test_linear_models_of_correlated_normal_inputs_have_the_published_effects():
    # B. Iooss, C. Prieur, "Shapley effects for sensitivity analysis with correlated inputs", Int.
    # J. Uncertain. Quantif. 9, 493-514 (2019), linear model with normal inputs: a correlated pair
    # with standard deviations 1 and 2, and an input beside one that the model does not use.
    for r in (-0.5, 0.0, 0.4, 0.9):
        whole = 1 + 1 + 4 + 4 * r
        block = [1 * (1 - r**2 / 2) + 2 * r + 4 * r**2 / 2, 4 * (1 - r**2 / 2) + 2 * r + r**2 / 2]
        alone = [1 - r**2 / 2, r**2 / 2]
        expected = np.array([alone[0], *block, alone[1]]) / whole
        assert list(dependent.of_normal(r).values()) == pytest.approx(expected)


def test_failed_rows_leave_with_their_paths():
    ds = weighted(0.6, 256)
    y = ds["weighted"].values.copy()
    y[7] = np.nan
    found = sensitivities(with_status(with_output(ds, "weighted", y), [7], 2), output="weighted")
    assert (found["groups_dropped"], found["rows_used"]) == (1, 255 * 5)
    total = sum(one["value"] for one in found["outputs"]["weighted"]["shapley"].values())
    assert total == pytest.approx(1.0)


def test_rows_of_another_dependence_are_refused():
    ds = weighted(0.6, 64)
    x = ds["x2"].values.copy()
    x[5] += 1e-3
    with pytest.raises(InputError, match="the rows differ from those of a 'shapley' design"):
        sensitivities(ds.assign(x2=("sample", x, ds["x2"].attrs)))


# What a share by correlation is called ------------------------------------------------------------


def test_an_input_without_an_effect_of_its_own_is_named():
    entry = entry_of(weighted(0.9))
    assert entry["by_correlation"] == ["x4"]
    assert entry["notes"][0].startswith("x4 does not change the output by itself in any of ")
    assert entry["notes"][0].endswith("its share is due to its correlation with x1")
    assert "by_correlation" not in entry_of(weighted(0.0))


def test_an_input_that_changes_the_output_now_and_then_is_not_called_without_effect():
    ds = weighted(0.9)
    x2, x4 = ds["x2"].values, ds["x4"].values
    y = ds["weighted"].values + 0.1 * (x4 > 1.5) * x2
    assert "by_correlation" not in entry_of(with_output(ds, "weighted", y))


def test_few_paths_do_not_show_that_an_input_has_no_effect():
    assert "by_correlation" not in entry_of(weighted(0.9, 32))


# Polynomials as control variate -------------------------------------------------------------------


def of_case(words, samples, seed=1):
    case = dependent.CASES[words]
    of = dependent.study(case.output, case.laws, case.correlations, samples)
    return problems.computed(problems.with_seed(of, seed)), case


def widths(found):
    return np.array([one.high - one.low for one in found.values()])


def controlled_and_alone(ds, output):
    sample = replace(sample_of(ds), values=ds[output].values)
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
    found = METHODS["shapley"].indices(replace(sample_of(ds), values=both))
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


def test_designs_for_dependent_inputs_are_named_with_what_they_feed():
    said = refusal(tables({"x1": UNIFORM, "x3": UNIFORM}, "saltelli", 128, dependence=PAIR))
    assert "use monte-carlo or latin-hypercube or sobol or halton or rbd-fast for delta and" in said
    assert said.endswith(", or shapley for shapley")


def test_paths_have_no_effects_within_a_regime():
    inside = {"distribution": "uniform", "lower": 0.01, "upper": 0.99}
    given = tables({"x1": inside, "x2": inside}, "shapley", 64)
    ds = computed(study_of(given, "sample_models:KINDS"))
    with pytest.raises(InputError, match="'shapley' assumes inputs that depend as their design"):
        sensitivities(ds, regime="fast")


def test_the_remark_stands_beside_the_bar_in_table_figure_and_report(capsys):
    ds = weighted(0.9)
    show(ds, module.sensitivities(ds))
    shown = capsys.readouterr().out.splitlines()
    line = next(one for one in shown if one.startswith("  x4 "))
    assert line.endswith("by correlation alone")
    labels = [
        label.get_text() for label in plots.index_bars(ds, "weighted").axes[0].get_yticklabels()
    ]
    assert ["by correlation alone" in label for label in labels] == [
        "x_{4}" in one for one in labels
    ]
    (method,) = sensitivity_of(Findings(ds))
    beside = {row[0].text: row[0].more for row in method.subjects[0].tables[0].rows}
    assert beside == {"x1": "", "x2": "", "x3": "", "x4": "by correlation alone"}
    assert uq.sensitivity(ds)["by_correlation"].values.tolist() == [[False, False, False, True]]


def test_the_answer_does_not_count_a_share_by_correlation_as_a_contribution():
    # x4 is correlated with the only input that the model uses.
    ds = weighted(0.9)
    y = ds["x1"].values + 0.01 * ds["x2"].values
    ranking = ranking_of(Findings(with_output(ds, "weighted", y)), "weighted", "shapley", ("", ""))
    assert [one.inputs for one in ranking.contributions] == [("x1",)]


# Coverage -----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_intervals_of_dependent_effects_hold_the_truth_in_93_to_97_of_100_cases():
    cases = ["exponential, correlation 0.6", "mild lognormal", "two signs and a number"]
    lines = dependent.shapley(1000, cases)
    assert len(lines) == 2 * (4 + 4 + 3)
    assert all(line.given == 1000 for line in lines)
    assert not [line for line in lines if line.by == OURS and line.coverage[0] < LOW]
    assert not [line for line in lines if line.unexplained]
