"""Dependent inputs drawn given some of them."""

import numpy as np
import pytest
from computed import study_of
from dependent_studies import PAIR
from hypothesis import given, settings
from hypothesis import strategies as st
from input_studies import BELL, UNIFORM, inputs_of, tables
from scipy import stats

from benchmarks.coverage import dependent
from uq.sampling.copulas import (
    ClaytonPair,
    FrankPair,
    GumbelPair,
    StudentPair,
    SurvivalPair,
)
from uq.sampling.dependence import conditional_paths
from uq.sampling.designs import DESIGNS
from uq.study.row_sampling import row_block, rows

NONE = (None, None, None)

RANKS = dependent.ranks([[1.0, 0.8, -0.3], [0.8, 1.0, 0.1], [-0.3, 0.1, 1.0]])


def paths(count, d=3, seed=1):
    sizes = dict(seed=seed, replicates=1, d=d, samples=count, second_order=False)
    return DESIGNS["shapley"].unit_rows(**sizes, start=0, stop=count)[:, 0]


def test_every_row_of_a_path_follows_the_copula():
    drawn_paths = conditional_paths(paths(10_000), RANKS, NONE)
    for row in range(4):
        np.testing.assert_allclose(stats.spearmanr(drawn_paths[:, row]).statistic, RANKS, atol=0.03)


def test_what_has_changed_depends_on_its_first_value_through_the_others_alone():
    u = paths(30_000)
    matrix = 2 * np.sin(np.pi / 6 * np.array(RANKS))
    scores = stats.norm.ppf(conditional_paths(u, RANKS, NONE))
    for row, fixed in ((1, (0, 2)), (2, (1,)), (3, ())):
        kept = (u[:, row] == u[:, 0])[:, list(fixed)].all(axis=1)
        fixed, drawn = list(fixed), [i for i in range(3) if i not in fixed]
        first, later = scores[kept, 0], scores[kept, row]
        np.testing.assert_array_equal(first[:, fixed], later[:, fixed])
        slopes = matrix[np.ix_(drawn, fixed)]
        shared = slopes @ np.linalg.solve(matrix[np.ix_(fixed, fixed)], slopes.T)
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
    drawn_paths = conditional_paths(u, dependent.ranks(matrix), (signs, signs, None))
    alone = (u[:, 1, :2] == u[:, 0, :2]).all(axis=1)
    z = np.random.default_rng(1).standard_normal((400_000, 3)) @ np.linalg.cholesky(matrix).T
    for first in (False, True):
        for second in (False, True):
            drawn = alone & ((drawn_paths[:, 0, :2] > 0.5) == [first, second]).all(axis=1)
            scores = stats.norm.ppf(drawn_paths[drawn, 1, 2])
            truth = z[((z[:, :2] > 0) == [first, second]).all(axis=1), 2].mean()
            assert abs(scores.mean() - truth) < 4 * scores.std() / np.sqrt(drawn.sum())


@pytest.mark.parametrize(
    "copula",
    [ClaytonPair(2.0), GumbelPair(2.0), FrankPair(-5.0), StudentPair(0.6, 3.0)]
    + [SurvivalPair(ClaytonPair(2.0))],
    ids=str,
)
def test_paths_of_a_pair_follow_its_copula_given_what_has_not_changed(copula):
    u = paths(40_000)  # with a third input, so that the pair also stays as it is
    drawn_paths = conditional_paths(u[..., :2], copula, (None, None))
    for row in range(4):
        first, second = (column.copy() for column in drawn_paths[:, row].T)
        for a, b in ((0.1, 0.1), (0.5, 0.3), (0.9, 0.9)):
            truth = copula.joint(np.array([a]), np.array([b]))[0]
            share = ((first <= a) & (second <= b)).mean()
            assert abs(share - truth) < 4.5 * np.sqrt(truth / len(u))
    for kept, drawn in ((0, 1), (1, 0)):
        alone = (u[:, 1:, kept] == u[:, :1, kept]) & (u[:, 1:, drawn] != u[:, :1, drawn])
        for row in (1, 2):
            here = alone[:, row - 1]
            others = drawn_paths[here, row, kept]
            np.testing.assert_array_equal(others, drawn_paths[here, 0, kept])
            # Given the unchanged one, the probability of the drawn one is uniform, and new.
            share = copula.conditional(drawn_paths[here, row, drawn].copy(), others.copy())
            before = copula.conditional(drawn_paths[here, 0, drawn].copy(), others.copy())
            assert stats.kstest(share, "uniform").pvalue > 1e-4
            for other in (others, before):
                assert abs(stats.spearmanr(share, other).statistic) < 4 / np.sqrt(here.sum())
    both = (u[:, 3] != u[:, 0])[:, :2].all(axis=1)
    assert both.all()
    assert abs(stats.spearmanr(drawn_paths[:, 3, 0], drawn_paths[:, 0, 0]).statistic) < 0.02


def test_a_discrete_input_of_a_pair_is_known_by_its_value():
    """Given the sign of one, the other has the mean of rows with this sign."""
    copula, u = ClaytonPair(2.0), paths(40_000, d=2)
    drawn_paths = conditional_paths(u, copula, (signs, None))
    alone = u[:, 1, 0] == u[:, 0, 0]
    p, w = np.random.default_rng(1).random((2, 400_000))
    v = copula.conditional_quantile(w, p)
    for above in (False, True):
        rows_above = alone & ((drawn_paths[:, 0, 0] > 0.5) == above)
        drawn, before = drawn_paths[rows_above, 1, 1], drawn_paths[rows_above, 0, 1]
        assert abs(stats.spearmanr(drawn, before).statistic) < 4 / np.sqrt(len(drawn))
        truth = v[(p > 0.5) == above]
        assert stats.ks_2samp(drawn, truth).pvalue > 1e-4
        assert abs(drawn.mean() - truth.mean()) < 4 * drawn.std() / np.sqrt(len(drawn))


MIXED = {
    "x1": {"distribution": "integer-range", "lower": 0, "upper": 1},
    "x2": UNIFORM | {"times": "x3"},
    "x3": BELL | {"truncate": [0.4, 0.55]},
    "x4": {"equals": "x3"},
}


@settings(max_examples=20)
@given(
    cuts=st.lists(st.integers(0, 16 * 4), max_size=4),
    copula=st.sampled_from(
        [{}, {"copula": "frank"}, {"copula": "student", "degrees_of_freedom": 4.0}]
    ),
)
def test_paths_of_dependent_inputs_are_the_same_however_they_are_cut(cuts, copula):
    study = study_of(tables(MIXED, "shapley", 16, dependence=PAIR | copula))
    edges = [0, *sorted(cuts), 64]
    parts = [row_block(study, i, j).x for i, j in zip(edges, edges[1:], strict=False)]
    assert np.concatenate(parts).tobytes() == row_block(study, 0, 64).x.tobytes()


def test_rows_of_paths_follow_the_laws_and_their_correlation():
    study = study_of(tables(MIXED, "shapley", 2048, dependence=PAIR))
    inputs = inputs_of(study)
    assert rows(study) == len(inputs["x1"]) == 4 * 2048
    assert set(inputs["x1"]) == {0.0, 1.0} and abs(inputs["x1"].mean() - 0.5) < 0.03
    assert 0.4 <= inputs["x3"].min() and inputs["x3"].max() <= 0.55
    np.testing.assert_array_equal(inputs["x3"], inputs["x4"])
    low, high = (inputs["x3"][inputs["x1"] == value].mean() for value in (1.0, 0.0))
    assert low < high - 0.02  # their correlation is negative
