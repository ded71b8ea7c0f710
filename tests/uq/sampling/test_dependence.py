"""Rank correlations: rows that have them, and matrices that are none."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import computed, study_of
from hypothesis import given, settings
from hypothesis import strategies as st
from input_studies import BELL, UNIFORM, inputs_of, refusal, tables
from scipy import stats

from uq.assess.sampled_laws import sampled_inputs, sampled_ranks
from uq.errors import InputError
from uq.sampling.dependence import correlated, matrix_problem
from uq.study.row_sampling import row_block

CORRELATED = {
    "parameters": ["x3", "x1"],
    "rank_correlation": [[1.0, -0.7], [-0.7, 1.0]],
}


def test_rows_have_the_rank_correlations_and_laws_that_were_stated():
    entries = {
        "x1": UNIFORM,
        "x2": UNIFORM,
        "x3": {"distribution": "beta"} | dict(alpha=2.0, beta=5.0, lower=0.0, upper=1.0),
    }
    study = study_of(tables(entries, "sobol", 8192, dependence=CORRELATED))
    inputs = inputs_of(study)
    assert stats.spearmanr(inputs["x1"], inputs["x3"]).statistic == pytest.approx(-0.7, abs=2e-3)
    assert abs(stats.spearmanr(inputs["x1"], inputs["x2"]).statistic) < 2e-3
    for comparison in sampled_inputs(study).values():
        assert comparison.distance < 2e-3
    assert sampled_ranks(study)[0, 1] == pytest.approx(-0.7, abs=2e-3)


def test_three_inputs_have_all_three_correlations():
    ranks = ((1.0, 0.8, -0.3), (0.8, 1.0, 0.1), (-0.3, 0.1, 1.0))
    u = np.random.default_rng(1).random((100_000, 3))
    correlations = stats.spearmanr(correlated(u, ranks)).statistic
    np.testing.assert_allclose(correlations, ranks, atol=0.01)


@settings(max_examples=20)
@given(cuts=st.lists(st.integers(0, 64), max_size=4))
def test_dependent_rows_are_the_same_however_they_are_cut(cuts):
    factor = UNIFORM | {"times": "x1"}
    entries = {"x1": UNIFORM, "x2": factor, "x3": BELL, "x4": {"equals": "x3"}}
    study = study_of(tables(entries, samples=64, dependence=CORRELATED))
    edges = [0, *sorted(cuts), 64]
    parts = [row_block(study, i, j).x for i, j in zip(edges, edges[1:], strict=False)]
    assert np.concatenate(parts).tobytes() == row_block(study, 0, 64).x.tobytes()


@pytest.mark.parametrize(
    ("ranks", "message"),
    [
        (((1.0, 0.5),), "must have 2 rows of 2 numbers"),
        (((1.0, 0.5), (0.5, 0.9)), "must be 1: the correlation of 'b' with itself"),
        (((1.0, 0.5), (0.4, 1.0)), "must be the same as [1][0] = 0.4"),
        (((1.0, 1.0), (1.0, 1.0)), "must be between -1 and 1, 2e-09 or more from both"),
        (((1.0, -1 + 1e-10), (-1 + 1e-10, 1.0)), "between -1 and 1, 2e-09 or more from both"),
    ],
)
def test_a_matrix_that_is_none_says_what_is_wrong(ranks, message):
    assert message in matrix_problem(("a", "b"), ranks).problem


def test_two_inputs_may_have_any_correlation_that_is_not_almost_one():
    for r in (0.9995, 1 - 2.1e-9, -1 + 2.1e-9):
        assert matrix_problem(("a", "b"), ((1.0, r), (r, 1.0))) is None


def test_a_near_miss_is_answered_with_what_would_do():
    ranks = ((1.0, 0.9, 0.1), (0.9, 1.0, 0.9), (0.1, 0.9, 1.0))
    problem = matrix_problem(("a", "b", "c"), ranks)
    assert problem.problem == (
        "no inputs can have these rank correlations together; given the others,"
        " the correlation of 'a' with 'b', 0.9, must be between -0.308 and 0.494"
    )
    for entry, good in ((-0.309, False), (-0.308, True), (0.494, True), (0.495, False)):
        mended = ((1.0, entry, 0.1), (entry, 1.0, 0.9), (0.1, 0.9, 1.0))
        assert (matrix_problem(("a", "b", "c"), mended) is None) == good
    # Four inputs of which no two can be made to fit by one entry alone.
    ranks = tuple(tuple(1.0 if i == j else -0.6 for j in range(4)) for i in range(4))
    assert (
        "multiply all but the diagonal by 0.53 or less"
        in matrix_problem(tuple("abcd"), ranks).problem
    )
    weaker = tuple(tuple(1.0 if i == j else -0.6 * 0.53 for j in range(4)) for i in range(4))
    assert matrix_problem(tuple("abcd"), weaker) is None


@pytest.mark.parametrize("method", ["saltelli", "morris", "fast"])
def test_designs_for_independent_inputs_are_refused_and_others_named(method):
    entries = {"x1": UNIFORM, "x3": UNIFORM}
    message = refusal(tables(entries, method, 128, dependence=CORRELATED))
    assert message.startswith(f'[design] method = "{method}": assumes independent inputs')
    assert "use monte-carlo or latin-hypercube" in message and "delta and pawn" in message


def test_methods_for_independent_inputs_are_refused_and_others_named():
    given = tables({"x1": UNIFORM, "x3": UNIFORM}, samples=256, dependence=CORRELATED)
    message = refusal(given | {"analysis": {"sensitivity": ["rbd-fast"]}})
    assert message.startswith('[analysis] sensitivity = "rbd-fast": assumes independent inputs')
    assert "those that do not are 'delta' or 'pawn' or 'quantile' or 'regional'" in message
    ds = computed(study_of(given))
    assert sensitivities(ds)["method"] == "delta"
    with pytest.raises(InputError, match="'rbd-fast' assumes independent inputs.*delta, pawn, "):
        sensitivities(ds, "rbd-fast")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parameters": ["x3", "x9"]}, '[dependence] parameters = "x9": is not uncertain'),
        ({"parameters": ["x3", "x2"]}, "follows another parameter already"),
        ({"parameters": ["x3", "x3"]}, '"x3" is listed twice'),
        ({"rank_corelation": 1}, "did you mean 'rank_correlation'?"),
    ],
)
def test_a_wrong_dependence_is_refused(changes, message):
    entries = {"x1": UNIFORM, "x2": {"equals": "x1"}, "x3": UNIFORM}
    assert message in refusal(tables(entries, dependence=CORRELATED | changes))
