"""Sensitivity methods against further published cases, and OpenTURNS where it has the method."""

from itertools import combinations
from math import factorial, pi

import numpy as np
import openturns as ot
import pytest
from asked_indices import sensitivities
from computed import computed, linear, study_of, summarised, with_output, with_status
from published import PORTFOLIO_LAWS, portfolio_indices
from SALib.analyze import shapley as salib_shapley
from test_given_data import CASES, FIRST, TOTAL

from benchmarks.coverage.dependent import of_paths_alone

PORTFOLIO = {
    "sobol": ("saltelli", 1024, 8),
    "fast": ("fast", 2049, 4),
    "rbd-fast": ("monte-carlo", 4096, 1),
    "hdmr": ("monte-carlo", 2048, 1),
    "shapley": ("shapley", 4096, 1),
}


def result(model, laws, method, samples, replicates=1, seed=1):
    design = {"method": method, "samples": samples, "replicates": replicates, "seed": seed}
    tables = {"study": {"name": "published", "model": "linear"}, "design": design}
    return computed(study_of(tables | {"uncertain": laws}, model))


def case(model, *design):
    names, law = CASES[model]
    return result(model, dict.fromkeys(names, law), *design)


def entry(ds, method):
    return sensitivities(ds, method)["outputs"]["y"]


def values(indices_):
    return [estimate["value"] for estimate in indices_.values()]


@pytest.mark.parametrize(
    "method",
    [
        pytest.param(design_name, marks=[pytest.mark.slow] * (design_name == "hdmr"))
        for design_name in PORTFOLIO
    ],
)
def test_indices_of_a_portfolio_are_the_published_ones(method):
    index_values = entry(result("published:PORTFOLIO", PORTFOLIO_LAWS, *PORTFOLIO[method]), method)
    for kind, truth in portfolio_indices().items():
        if kind in index_values:
            assert values(index_values[kind]) == pytest.approx(truth, abs=0.06)
    assert {"S1", "ST", "shapley"} & index_values.keys()


def test_the_function_of_morris_shows_what_he_published():
    # Morris (1991), figure 1: the first ten inputs matter, of these the last three without bend or
    # interaction, with a mean effect of about 40; the other ten do not.
    law = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    laws = {f"x{i}": law for i in range(1, 21)}
    index_values = entry(result("published:MORRIS", laws, "morris", 10, 8), "morris")
    star, sigma, mu = (np.array(values(index_values[kind])) for kind in ("mu_star", "sigma", "mu"))
    assert star[:10].min() > 2 * star[10:].max()
    assert sigma[7:10].max() < 0.5 * sigma[:7].min()
    assert mu[7:10] == pytest.approx(40.0, abs=6.0)


@pytest.mark.parametrize("model", ["ishigami", "g-function"])
def test_extended_fast_is_as_near_as_that_of_openturns(model):
    index_values = entry(case(model, "fast", 1025, 4), "fast")
    names, law = CASES[model]
    uniform = ot.JointDistribution([ot.Uniform(law["lower"], law["upper"])] * len(names))
    second = ot.FAST(ot.PythonFunction(len(names), 1, func_sample=_of(model)), uniform, 1025)
    ours = {"S1": values(index_values["S1"]), "ST": values(index_values["ST"])}
    theirs = {"S1": second.getFirstOrderIndices(), "ST": second.getTotalOrderIndices()}
    for kind, truth in (("S1", FIRST[model]), ("ST", TOTAL[model])):
        assert ours[kind] == pytest.approx(truth, abs=0.05)
        assert ours[kind] == pytest.approx(list(theirs[kind]), abs=0.08)


def _of(model):
    from uq.study.installed_models import find_model

    machine = find_model(model)

    def function(x):
        x = np.asarray(x)
        return machine.batch(x, np.zeros(len(x), np.uint64), machine.settings())[0]["y"][:, None]

    return function


# Shapley effects ----------------------------------------------------------------------------------


def exact_shapley(variance_of, d):
    """Return Shapley's shares of a value of sets, by his formula."""
    effects = []
    for i in range(d):
        others = [j for j in range(d) if j != i]
        effects.append(
            sum(
                factorial(k) * factorial(d - k - 1) / factorial(d)
                * (variance_of({*some, i}) - variance_of(set(some)))
                for k in range(d)
                for some in combinations(others, k)
            )
        )  # fmt: skip
    return np.array(effects) / variance_of(set(range(d)))


def g_variance(some):
    """Return the variance of the g-function's mean given some inputs."""
    a = np.array([0, 1, 4.5, 9, 99, 99, 99, 99])
    return np.prod([1 + 1 / (3 * (1 + a[i]) ** 2) for i in some]) - 1


def ishigami_variance(some):
    alone = {0: 0.5 * (1 + 0.1 * pi**4 / 5) ** 2, 1: 49 / 8}
    both = 8 * 0.01 * pi**8 / 225
    return sum(v for i, v in alone.items() if i in some) + both * ({0, 2} <= set(some))


@pytest.mark.parametrize(
    ("model", "truth"),
    [
        ("ishigami", exact_shapley(ishigami_variance, 3)),
        ("g-function", exact_shapley(g_variance, 8)),
    ],
)
def test_shapley_effects_are_the_known_ones_and_those_of_salib(model, truth):
    ds = case(model, "shapley", 4096)
    effects = entry(ds, "shapley")["shapley"]
    for estimate, value in zip(effects.values(), truth, strict=True):
        assert abs(estimate["value"] - value) < estimate["high"] - estimate["low"] < 0.1
    assert sum(values(effects)) == pytest.approx(1.0)
    names = CASES[model][0]
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0, 1]] * len(names)}
    x = np.column_stack([ds[name].values for name in names])
    theirs = salib_shapley.analyze(problem, x, ds["y"].values)
    alone = of_paths_alone(ds, "y")  # SALib has no control variate
    assert [estimate.value for estimate in alone.values()] == pytest.approx(
        theirs["shapley_normalized"]
    )
    half = [(estimate.high - estimate.low) / 2 for estimate in alone.values()]
    assert half == pytest.approx(theirs["shapley_normalized_conf"], rel=2e-3)  # Student, normal


def test_a_failed_row_takes_its_path_along_and_order_does_not_matter():
    ds = linear("shapley", 256)
    y = ds["y"].values.copy()
    y[3] = np.nan
    hurt = with_status(with_output(ds, "y", y), [3], 2)
    sensitivity_result = sensitivities(hurt)
    assert (sensitivity_result["groups_dropped"], sensitivity_result["rows_used"]) == (1, 255 * 5)
    mixed = hurt.isel(row=np.random.default_rng(0).permutation(hurt.sizes["row"]))
    again = sensitivities(mixed)["outputs"]["y"]["shapley"]
    assert values(again) == pytest.approx(values(sensitivity_result["outputs"]["y"]["shapley"]))
    few = sensitivities(linear("shapley", 16))["outputs"]["y"]
    assert few["refused"] == "only 16 whole paths; 32 are needed"


def test_steps_between_equal_values_have_no_effect():
    law = {"distribution": "discrete-choice", "values": [0.0, 1.0]}
    ds = result("linear", dict.fromkeys(("x1", "x2", "x3", "x4"), law), "shapley", 4096)
    effects = entry(ds, "shapley")["shapley"]
    for i, estimate in enumerate(effects.values(), start=1):
        assert estimate["low"] - 0.01 < i**2 / 30 < estimate["high"] + 0.01


def test_both_ends_of_each_path_serve_for_statistics():

    statistics = summarised(linear("shapley", 128, 8))
    assert statistics["rows_used"] == 2 * 128 * 8
    mean = statistics["outputs"]["y"]
    assert mean["mean_interval"]["low"] < 5.0 < mean["mean_interval"]["high"]
