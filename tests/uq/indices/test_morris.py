"""Elementary effects: known answers, published ones, honest intervals."""

from itertools import product
from math import pi

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import (
    asking,
    computed,
    linear,
    with_output,
    with_seed,
    with_status,
)
from SALib.analyze import morris as salib_morris
from screened import A, g_function, index_entry, ishigami

from uq.sampling.unit_cube import LEVELS, STEP, TAIL

LEVELS_OF_ONE = TAIL + (1 - 2 * TAIL) * np.arange(LEVELS) / (LEVELS - 1)


def exact_effects(function, d):
    """Return mu, sigma and mu* of every input, from every place that a step can start from."""
    starts = np.array(list(product(LEVELS_OF_ONE, repeat=d)))
    answers = []
    for i in range(d):
        below = starts[np.isin(starts[:, i], LEVELS_OF_ONE[: LEVELS // 2])]
        above = below.copy()
        above[:, i] += STEP
        effects = (function(above) - function(below)) / STEP
        answers.append((effects.mean(), effects.std(), np.abs(effects).mean()))
    return dict(zip(("mu", "sigma", "mu_star"), np.array(answers).T, strict=True))


def ishigami_of(u):
    x1, x2, x3 = (2 * pi * u - pi).T
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def g_of_four(u):
    """Return the g-function of the first four inputs, with the mean of the rest."""
    others = np.mean(np.abs(4 * LEVELS_OF_ONE - 2))
    first = (np.abs(4 * u - 2) + A[:4]) / (1 + A[:4])
    return first.prod(axis=1) * ((others + 99) / 100) ** 4


def test_effects_of_a_linear_function_are_its_coefficients():
    entry = index_entry(linear("morris", 8, 4))
    for i in (1, 2, 3, 4):
        assert entry["mu"][f"x{i}"]["value"] == pytest.approx(i)
        assert entry["mu_star"][f"x{i}"]["value"] == pytest.approx(i)
        assert entry["sigma"][f"x{i}"]["value"] == pytest.approx(0, abs=1e-12)
        assert entry["mu_star"][f"x{i}"]["low"] is None  # it does not scatter


@pytest.mark.parametrize(
    ("study", "exact", "kinds"),
    [
        (ishigami("morris", 128, 16), exact_effects(ishigami_of, 3), ("mu", "sigma", "mu_star")),
        (g_function("morris", 128, 8), exact_effects(g_of_four, 4), ("mu", "mu_star")),
    ],
    ids=["ishigami", "g-function"],
)
def test_effects_are_those_of_all_steps_that_the_levels_allow(study, exact, kinds):
    entry = index_entry(computed(study))
    for kind in kinds:
        for i, value in enumerate(exact[kind]):
            effect = entry[kind][f"x{i + 1}"]
            # Twice the half width is four standard errors.
            width = 0.0 if effect["high"] is None else effect["high"] - effect["low"]
            assert effect["value"] == pytest.approx(value, abs=max(width, 1e-9))


def test_mu_star_of_ishigami_is_the_published_one():
    # SALib's regression test, with levels at the very ends: 7.70, 7.88, 6.25.
    entry = index_entry(computed(ishigami("morris", 256, 16)))
    published = {"x1": 7.70, "x2": 7.88, "x3": 6.25}
    for name, value in published.items():
        assert entry["mu_star"][name]["value"] == pytest.approx(value, rel=0.08)


def test_measures_are_those_of_salib():
    study = g_function("morris", 16, 2)
    ds = computed(study)
    x = np.column_stack([ds[f"x{i}"].values for i in range(1, 9)])
    order = np.lexsort([ds["block"], ds["group"], ds["replicate"]])
    problem = {"num_vars": 8, "names": list("abcdefgh"), "bounds": [[0.0, 1.0]] * 8}
    theirs = salib_morris.analyze(problem, x[order], ds["y"].values[order], num_resamples=2, seed=1)
    for kind in ("mu", "sigma", "mu_star"):
        ours = [estimate["value"] for estimate in index_entry(ds)[kind].values()]
        # SALib divides by the step between the ends of a law, ours stop short of them.
        np.testing.assert_allclose(ours, np.array(theirs[kind]) / (1 - 2 * TAIL), rtol=1e-9)


@pytest.mark.slow
def test_intervals_of_effects_hold_as_often_as_they_say():
    exact, study = exact_effects(ishigami_of, 3), ishigami("morris", 16, 8)
    hits = {(kind, i): [] for kind in ("mu", "mu_star") for i in (0, 2)}
    for seed in range(400):
        entry = index_entry(computed(with_seed(study, seed)))
        for (kind, i), hit in hits.items():
            effect = entry[kind][f"x{i + 1}"]
            hit.append(effect["low"] <= exact[kind][i] <= effect["high"])
    for hit in hits.values():
        assert 0.92 <= np.mean(hit) <= 0.98  # four standard errors are 0.044


def test_optimised_trajectories_say_that_they_are_biased():
    optimised, plain = (
        index_entry(computed(ishigami(method, 32, 4))) for method in ("morris-optimised", "morris")
    )
    assert any("favour the corners" in note for note in optimised["notes"])
    assert plain["notes"] == []
    assert optimised["mu_star"]["x1"]["value"] > 1.2 * plain["mu_star"]["x1"]["value"]


def test_a_failed_row_takes_its_trajectory_along():
    ds = linear("morris", 8, 4)
    y = ds["y"].values.copy()
    y[:3] = np.nan  # three rows of one trajectory
    ds = with_status(with_output(ds, "z", y), slice(0, 3), 2)
    whole = sensitivities(asking(ds, outputs=["z"]))
    assert (whole["groups_dropped"], whole["rows_used"]) == (1, 31 * 5)
    assert whole["outputs"]["z"]["mu_star"]["x4"]["value"] == pytest.approx(4)
