"""Shapley effects of dependent inputs."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import computed, study_of, with_output, with_status
from dependent_studies import PAIR, assert_near, entry_of, weighted
from input_studies import UNIFORM, refusal, tables
from scipy import special, stats

from benchmarks.coverage import dependent, dependent_effects, problems
from benchmarks.coverage.tally import LOW, OURS
from uq.errors import InputError
from uq.sampling.copulas import copula_of_rank
from uq.sampling.unit_cube import inside


def test_shapley_effects_of_dependent_inputs_are_the_known_ones():
    for r in (0.3, 0.9):
        entry = entry_of(weighted(r))
        assert_near(entry["shapley"], dependent.of_normal(r))
        assert sum(estimate["value"] for estimate in entry["shapley"].values()) == pytest.approx(
            1.0
        )


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
    effects = entry_of(computed(study_of(given, "sample_models:ADDED")))["shapley"]

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

    variances = {
        (): (0.0, sd**2 * float((weight * a).sum()) ** 2),
        (0,): variance(a, given_a[:, None]),
        (2,): variance(given_c[None, :], c),
        (0, 2): variance(a, c),
    }

    def explained(some):
        without, of_factor = variances[tuple(sorted(i for i in some if i != 1))]
        return without + of_factor * (1 in some)

    truth = dict(zip(("a", "b", "c"), dependent_effects.shares(explained, 3), strict=True))
    assert_near(effects, truth)


@pytest.mark.parametrize(
    "copula",
    [
        {"copula": "clayton"},
        {"copula": "clayton", "survival": True},
    ],
    ids=str,
)
def test_shapley_effects_under_a_copula_are_those_of_quadrature(copula):
    # x1 + x2 + 2 x3 + x1 x3 of normal inputs, x1 and x3 dependent.
    pair = {"parameters": ["x1", "x3"], "rank_correlation": [[1.0, 0.7], [0.7, 1.0]]} | copula
    laws = dict.fromkeys(dependent.NAMES[:3], dependent.NORMAL)
    given = tables(laws, "shapley", 8192, "sums", dependence=pair)
    interacting = study_of(given | {"analysis": {"outputs": ["interacting"]}}, dependent.NAME)

    def effects(drawn_given):
        """Return the effects by the trapezoidal rule over scores of a draw given another."""
        z = np.linspace(-7.5, 7.5, 601)
        weight = stats.norm.pdf(z) / stats.norm.pdf(z).sum()
        first, other = np.repeat(z, len(z)), np.tile(z, len(z))
        drawn = stats.norm.ppf(inside(drawn_given(special.ndtr(other), special.ndtr(first))))
        by_first, by_third = (
            (a + 2 * c + a * c).reshape(len(z), -1) for a, c in ((first, drawn), (drawn, first))
        )

        def variance(values, worth):
            return worth @ (values - worth @ values) ** 2

        explained = {
            (): 0.0,
            (0,): variance(by_first @ weight, weight),
            (2,): variance(by_third @ weight, weight),
            (0, 2): variance(by_first.ravel(), np.outer(weight, weight).ravel()),
        }

        def value(inputs):
            of_pair = tuple(i for i in sorted(inputs) if i != 1)
            return explained[of_pair] + (1 in inputs)

        return dict(zip(("x1", "x2", "x3"), dependent_effects.shares(value, 3), strict=True))

    truth = effects(interacting.dependence.pair.conditional_quantile)
    normal = effects(copula_of_rank("normal", 0.7).conditional_quantile)
    assert max(abs(truth[name] - normal[name]) for name in truth) > 0.02
    assert_near(entry_of(computed(interacting))["shapley"], truth)


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
    sensitivity_result = sensitivities(
        with_status(with_output(ds, "weighted", y), [7], 2), output="weighted"
    )
    assert (sensitivity_result["groups_dropped"], sensitivity_result["rows_used"]) == (1, 255 * 5)
    total = sum(
        estimate["value"]
        for estimate in sensitivity_result["outputs"]["weighted"]["shapley"].values()
    )
    assert total == pytest.approx(1.0)


def test_rows_of_another_dependence_are_refused():
    ds = weighted(0.6, 64)
    x = ds["x2"].values.copy()
    x[5] += 1e-3
    with pytest.raises(InputError, match="the rows differ from those of a 'shapley' design"):
        sensitivities(ds.assign(x2=("row", x, ds["x2"].attrs)))


def test_designs_for_dependent_inputs_are_named_with_what_they_feed():
    message = refusal(tables({"x1": UNIFORM, "x3": UNIFORM}, "saltelli", 128, dependence=PAIR))
    assert (
        "use monte-carlo or latin-hypercube or sobol or halton or rbd-fast for delta and" in message
    )
    assert message.endswith(", or shapley for shapley")


def test_paths_have_no_effects_within_a_regime():
    inside = {"distribution": "uniform", "lower": 0.01, "upper": 0.99}
    given = tables({"x1": inside, "x2": inside}, "shapley", 64)
    ds = computed(study_of(given, "sample_models:KINDS"))
    with pytest.raises(InputError, match="'shapley' assumes inputs that depend as their design"):
        sensitivities(ds, regime="fast")


@pytest.mark.slow
def test_intervals_of_dependent_effects_hold_the_truth_in_93_to_97_of_100_cases():
    names = ["exponential, correlation 0.6", "mild lognormal", "two signs and a number"]
    lines = dependent.shapley(1000, {name: dependent.CASES[name] for name in names})
    assert len(lines) == 3 * (4 + 4) + 2 * 3
    assert all(line.given >= 995 for line in lines)  # five decided by one path are refused
    assert not [line for line in lines if line.by == OURS and line.coverage[0] < LOW]
    assert not [line for line in lines if line.unexplained]


def test_paths_alone_that_do_not_tell_the_variance_from_zero_give_nothing():
    case = dependent.CASES["steep lognormal"]
    ds = problems.computed(dependent.study(case.output, case.laws, case.correlations, 8))
    assert dependent.of_paths_alone(ds, case.output) == {}
