"""Morris and extended FAST: known answers, honest intervals, holes and borders refused."""

from itertools import product
from math import pi

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import (
    as_text,
    asking,
    computed,
    linear,
    study_of,
    summarised,
    with_output,
    with_seed,
    with_status,
)
from SALib.analyze import fast as salib_fast
from SALib.analyze import morris as salib_morris

from uq.analysis.overview import summary
from uq.designs.registry import DESIGNS
from uq.designs.trajectories import LEVELS, STEP, TAIL
from uq.errors import InputError
from uq.indices.dataset import sensitivity
from uq.methods.registry import fed_by

LEVELS_OF_ONE = TAIL + (1 - 2 * TAIL) * np.arange(LEVELS) / (LEVELS - 1)
A = np.array([0, 1, 4.5, 9, 99, 99, 99, 99.0])


def ishigami(method, samples, replicates=1, seed=0):
    return _of("ishigami", ("x1", "x2", "x3"), -pi, pi, method, samples, replicates, seed)


def g_function(method, samples, replicates=1, seed=0):
    names = tuple(f"x{i}" for i in range(1, 9))
    return _of("g-function", names, 0.0, 1.0, method, samples, replicates, seed)


def _of(model, names, lower, upper, method, samples, replicates, seed):
    law = {"distribution": "uniform", "lower": lower, "upper": upper}
    design = {"method": method, "samples": samples, "replicates": replicates, "seed": seed}
    tables = {"study": {"name": "a", "model": model}, "design": design}
    return study_of(tables | {"uncertain": dict.fromkeys(names, law)})


def found(ds, output="y", method=None):
    return sensitivities(ds, method)["outputs"][output]


def values_of(entry):
    return {
        (kind, name): one["value"]
        for kind, table in entry.items()
        if isinstance(table, dict)
        for name, one in table.items()
    }


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
    entry = found(linear("morris", 8, 4))
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
    entry = found(computed(study))
    for kind in kinds:
        for i, value in enumerate(exact[kind]):
            one = entry[kind][f"x{i + 1}"]
            # Twice the half width is four standard errors.
            width = 0.0 if one["high"] is None else one["high"] - one["low"]
            assert one["value"] == pytest.approx(value, abs=max(width, 1e-9))


def test_mu_star_of_ishigami_is_the_published_one():
    # SALib's regression test, with levels at the very ends: 7.70, 7.88, 6.25.
    entry = found(computed(ishigami("morris", 256, 16)))
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
        ours = [one["value"] for one in found(ds)[kind].values()]
        # SALib divides by the step between the ends of a law, ours stop short of them.
        np.testing.assert_allclose(ours, np.array(theirs[kind]) / (1 - 2 * TAIL), rtol=1e-9)


@pytest.mark.slow
def test_intervals_of_effects_hold_as_often_as_they_say():
    exact, study = exact_effects(ishigami_of, 3), ishigami("morris", 16, 8)
    hits = {(kind, i): [] for kind in ("mu", "mu_star") for i in (0, 2)}
    for seed in range(400):
        entry = found(computed(with_seed(study, seed)))
        for (kind, i), hit in hits.items():
            one = entry[kind][f"x{i + 1}"]
            hit.append(one["low"] <= exact[kind][i] <= one["high"])
    for hit in hits.values():
        assert 0.92 <= np.mean(hit) <= 0.98  # four standard errors are 0.044


def test_optimised_trajectories_say_that_they_are_biased():
    optimised, plain = (
        found(computed(ishigami(method, 32, 4))) for method in ("morris-optimised", "morris")
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


def test_a_failed_row_takes_its_curve_along():
    ds = linear("fast", 129, 4)
    full = found(ds)
    y = ds["y"].values.copy()
    y[0] = np.nan
    hurt = with_status(with_output(ds, "z", y), [0], 2)
    indices = sensitivities(asking(hurt, outputs=["z"]))
    assert (indices["groups_dropped"], indices["rows_used"]) == (1, 15 * 129)
    for kind in ("S1", "ST"):
        for name, one in indices["outputs"]["z"][kind].items():
            assert one["value"] == pytest.approx(full[kind][name]["value"], abs=0.02)
    y[ds["block"].values == 0] = np.nan
    gone = found(asking(with_output(ds, "z", y), outputs=["z"]), "z")
    assert gone["refused"] == "none of 4 curves for x1 has a value in each row"


@pytest.mark.parametrize("method", ["morris", "fast"])
@pytest.mark.parametrize("value", [1.0, np.nan, np.inf])
def test_an_output_without_variance_is_refused_not_zero(method, value):
    ds = linear(method, 80, 2)
    ds = with_output(ds, "flat", np.full(ds.sizes["sample"], value))
    entry = found(asking(ds, outputs=["flat"]), "flat")
    assert entry["refused"] and not {"S1", "ST", "mu_star"} & entry.keys()


def test_missing_rows_are_refused():
    for method in ("morris", "fast"):
        ds = linear(method, 80, 2)
        with pytest.raises(InputError, match="rows of the design are missing"):
            sensitivities(ds.isel(sample=slice(1, None)))
        shuffled = ds.isel(sample=np.random.default_rng(1).permutation(ds.sizes["sample"]))
        assert values_of(found(shuffled)) == pytest.approx(values_of(found(ds)), abs=1e-9)


V1, V2, V13 = 0.5 * (1 + pi**4 / 50) ** 2, 49 / 8, pi**8 * 8 / 22500
ISHIGAMI = {
    "S1": np.array([V1, V2, 0.0]) / (V1 + V2 + V13),
    "ST": np.array([V1 + V13, V2, V13]) / (V1 + V2 + V13),
}
PARTS = 1 / (3 * (1 + A) ** 2)
G_FUNCTION = {
    "S1": PARTS / (np.prod(1 + PARTS) - 1),
    "ST": PARTS * np.prod(1 + PARTS) / (1 + PARTS) / (np.prod(1 + PARTS) - 1),
}


@pytest.mark.parametrize(
    ("study", "exact"),
    [(ishigami("fast", 1025, 2), ISHIGAMI), (g_function("fast", 1025, 2), G_FUNCTION)],
    ids=["ishigami", "g-function"],
)
def test_extended_fast_comes_close_and_claims_no_interval(study, exact):
    entry = found(computed(study))
    for kind, values in exact.items():
        for one, value in zip(entry[kind].values(), values, strict=True):
            assert one["value"] == pytest.approx(value, abs=0.05)  # ST of x2 is 0.045 off
            assert one["low"] is None and one["high"] is None
    assert entry["notes"][0].startswith("no intervals: the method's own error")


def test_extended_fast_is_that_of_salib():
    ds = computed(ishigami("fast", 200, 1))
    order = np.lexsort([ds["group"], ds["block"]])
    problem = {"num_vars": 3, "names": ["x1", "x2", "x3"]}
    with pytest.warns(UserWarning, match="FAST confidence intervals"):
        theirs = salib_fast.analyze(problem, ds["y"].values[order], num_resamples=2)
    for kind in ("S1", "ST"):
        ours = [one["value"] for one in found(ds)[kind].values()]
        np.testing.assert_allclose(ours, theirs[kind], rtol=1e-9, atol=1e-12)


def test_too_few_points_for_the_inputs_are_told():
    (_, note) = found(computed(g_function("fast", 129)))["notes"]
    assert note == "7 inputs share 2 frequencies; samples = 449 would give each its own"
    assert len(found(computed(g_function("fast", 449)))["notes"]) == 1


@pytest.mark.parametrize("study", [ishigami, g_function])
def test_a_random_balance_design_feeds_rbd_fast(study):
    exact = ISHIGAMI if study is ishigami else G_FUNCTION
    entry = found(computed(study("rbd-fast", 2048, 1)))
    for one, value in zip(entry["S1"].values(), exact["S1"], strict=True):
        assert one["value"] == pytest.approx(value, abs=0.06)
    assert 0 < entry["dummy"]["S1"] < 0.1


# The border to SALib: what is lacking never reaches it, and no seed is taken for none.

# One design for each method, the last that feeds it; 'regional' takes regimes, not numbers.
_LAST = {method: name for name, one in DESIGNS.items() if one.draw for method in fed_by(one)}
FED = [
    pytest.param(design, method, marks=[pytest.mark.slow] * (method == "hdmr"))
    for method, design in _LAST.items()
    if method != "regional"
]


@pytest.mark.parametrize(("design", "method"), FED)
def test_one_lacking_value_changes_little_and_zeroes_nothing(design, method):
    ds = linear(design, 256, 4)
    full = found(ds, method=method)
    assert "refused" not in full
    y = ds["y"].values.copy()
    y[5] = np.nan
    hurt = with_status(with_output(ds, "z", y), [5], 2)
    hurt = sensitivities(asking(hurt, outputs=["z"]), method)
    assert hurt["groups_dropped"] == 1
    for kind, values in full.items():
        if isinstance(values, dict) and kind not in ("dummy", "sigma"):
            for name, one in values.items():
                value = hurt["outputs"]["z"][kind][name]["value"]
                assert value == pytest.approx(one["value"], abs=0.05)
            if kind != "S2":  # a linear function has no interactions
                assert max(abs(one["value"]) for one in values.values()) > 0.1


@pytest.mark.parametrize(("design", "method"), FED)
def test_seed_zero_is_a_seed(design, method):
    once, again, other = (found(linear(design, 256, 2, seed=s), method=method) for s in (0, 0, 1))
    assert once == again and "refused" not in once
    if design not in ("morris", "morris-optimised"):  # which know a linear function exactly
        assert once != other


# What else reads a result


def test_there_are_no_statistics_of_trajectories_and_it_is_said():
    ds = linear("morris", 8, 4)
    told = summarised(ds)
    assert (told["samples"], told["rows_used"]) == (160, 0)
    assert told["outputs"]["y"]["mean"] is None
    assert told["outputs"]["y"]["quantiles"]["0.5"]["value"] is None
    assert told["notes"] == [
        "no statistics: the rows of a 'morris' design do not follow the laws of the inputs;"
        " see 'uq sensitivity'"
    ]
    assert np.isnan(summary(ds)["mean"].item())


def test_curves_are_as_good_as_any_rows_for_statistics():
    told = summarised(linear("fast", 257, 8))
    assert told["rows_used"] == 257 * 8 * 4
    assert told["outputs"]["y"]["mean"] == pytest.approx(5, abs=0.05)


def test_measures_stand_in_arrays_tables_and_figures(uq, write_study, folder):
    arrays = sensitivity(linear("morris", 8, 4))
    assert arrays["mu_star"].sel(parameter="x3").item() == pytest.approx(3)
    path = write_study("ishigami", "morris", 8, 4, name="screening")
    assert uq("run", path).code == 0
    shown = uq("sensitivity", "results/screening.nc").out
    assert "mu_star" in shown and "sigma" in shown
    drawn = uq("plot", "results/screening.nc").out.split()
    assert [name.rpartition("/")[2] for name in sorted(drawn)] == [
        "morris-y.pdf",
        "morris-y.png",
        "morris-y.svg",
    ]


def test_the_template_names_the_designs(uq):
    text = uq("init", "ishigami").out
    for name in DESIGNS:
        assert f"# {name}: " in text


def test_a_wrong_method_is_told_which_design_can(uq):
    ds = linear("monte-carlo", 128)
    with pytest.raises(InputError, match="'morris' needs a design of morris or morris-optimised"):
        sensitivities(ds, "morris")
    tables = {
        "study": {"name": "a", "model": "linear"},
        "design": {"method": "saltelli", "samples": 64},
        "uncertain": {"x1": {"distribution": "uniform", "lower": 0.0, "upper": 1.0}},
        "analysis": {"sensitivity": ["fast"]},
    }
    with pytest.raises(InputError) as caught:
        study_of(tables)
    assert "a 'saltelli' design cannot feed it, method = 'fast' can" in str(caught.value)
    assert as_text(tables)
