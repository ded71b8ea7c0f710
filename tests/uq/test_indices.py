import json
import warnings
from itertools import combinations

import numpy as np
import pytest
from computed import asking, computed, kinds, linear, study_of, with_output
from SALib.analyze import pawn, rbd_fast
from SALib.analyze import sobol as salib
from SALib.analyze.delta import calc_delta
from scipy import stats

import uq
from uq.contract import Status
from uq.errors import InputError
from uq.indices.given_data import DUMMIES
from uq.indices.sensitivities import methods, sensitivities

INPUTS = ("x1", "x2", "x3")


def ishigami(method="saltelli", samples=128, replicates=8, seed=1, **more_design):
    design = {"method": method, "samples": samples, "replicates": replicates, "seed": seed}
    law = {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}
    return computed(
        study_of(
            {
                "study": {"name": "ishigami", "model": "ishigami"},
                "design": design | more_design,
                "uncertain": dict.fromkeys(INPUTS, law),
            }
        )
    )


def indices(ds, method=None, output=None):
    """Return what is said of each output; JSON without any number that is not finite."""
    return json.loads(json.dumps(sensitivities(ds, method, output), allow_nan=False))


def values(entry, kind):
    return [index["value"] for index in entry[kind].values()]


# Sobol' ------------------------------------------------------------------------------------------


def test_indices_of_ishigami_lie_near_the_published_ones_and_within_their_intervals():
    entry = indices(ishigami(samples=1024))["outputs"]["y"]
    for kind, published in {"S1": (0.3139, 0.4424, 0), "ST": (0.5576, 0.4424, 0.2437)}.items():
        assert values(entry, kind) == pytest.approx(published, abs=0.02)
        for index in entry[kind].values():
            assert index["low"] < index["value"] < index["high"]
    assert entry["notes"] == []


@pytest.mark.parametrize("second_order", [False, True])
def test_values_are_those_of_salib_on_all_rows(second_order):
    ds = ishigami(samples=64, replicates=4, second_order=second_order)
    entry = indices(ds)["outputs"]["y"]
    problem = {"num_vars": 3, "names": list(INPUTS)}
    expected = salib.analyze(problem, ds["y"].values, calc_second_order=second_order, seed=1)
    # SALib centres by all rows, this by the independent ones; the indices agree but for that.
    assert values(entry, "S1") == pytest.approx(expected["S1"], abs=5e-3)
    assert values(entry, "ST") == pytest.approx(expected["ST"], rel=1e-12)
    assert ("S2" in entry) == second_order
    if second_order:
        assert list(entry["S2"]) == ["x1,x2", "x1,x3", "x2,x3"]
        pairs = [expected["S2"][pair] for pair in combinations(range(3), 2)]
        assert values(entry, "S2") == pytest.approx(pairs, abs=1e-2)


def test_values_are_those_of_scipy():
    ds = ishigami(samples=256, replicates=1)
    entry = indices(ds)["outputs"]["y"]
    rows = ds["y"].values.reshape(256, 5)
    rows = rows - rows[:, [0, 4]].mean()
    blocks = {"f_A": rows[:, 0], "f_B": rows[:, 4], "f_AB": rows[:, 1:4].T}
    func = {name: np.atleast_2d(block) for name, block in blocks.items()}
    func["f_AB"] = func["f_AB"][:, None, :]
    expected = stats.sobol_indices(func=func, n=256)
    assert values(entry, "S1") == pytest.approx(np.ravel(expected.first_order), rel=1e-9)
    assert values(entry, "ST") == pytest.approx(np.ravel(expected.total_order), rel=1e-9)


def test_order_of_rows_does_not_matter():
    ds = ishigami(samples=16, replicates=4)
    shuffled = ds.isel(sample=np.random.default_rng(0).permutation(ds.sizes["sample"]))
    assert sensitivities(shuffled) == sensitivities(ds)


def test_interval_is_students_of_the_replicates():
    ds = ishigami(samples=64, replicates=5)
    entry = indices(ds)["outputs"]["y"]
    alone = [
        ds.isel(sample=ds["replicate"].values == r).assign_attrs(replicates=1) for r in range(5)
    ]
    found = [indices(one)["outputs"]["y"]["ST"]["x2"]["value"] for one in alone]
    half = stats.t.ppf(0.975, 4) * np.std(found, ddof=1) / np.sqrt(5)
    index = entry["ST"]["x2"]
    assert index["high"] - index["value"] == pytest.approx(half, rel=1e-6)
    assert index["value"] - index["low"] == pytest.approx(half, rel=1e-6)


def test_one_replicate_gives_values_without_intervals_and_says_so():
    entry = indices(ishigami(replicates=1))["outputs"]["y"]
    assert entry["ST"]["x1"]["value"] == pytest.approx(0.5576, abs=0.15)
    assert entry["ST"]["x1"]["low"] is entry["ST"]["x1"]["high"] is None
    assert "replicates" in entry["notes"][0]


@pytest.mark.parametrize("how", ["nan", "inf", "raise"])
def test_a_failed_row_removes_its_whole_group_and_is_counted(how):
    settings = {"fail_above": 0.97, "fail_how": how}
    ds = linear("saltelli", samples=64, replicates=4, settings=settings)
    found = indices(ds)
    lacking = np.isnan(ds["y"].values.reshape(64 * 4, 6)).any(axis=1)
    assert 0 < lacking.sum() == found["groups_dropped"] == found["outputs"]["y"]["groups_dropped"]
    assert found["rows_used"] == found["outputs"]["y"]["rows_used"] == (~lacking).sum() * 6
    kept = ds["y"].values.reshape(64 * 4, 6)[~lacking]
    problem = {"num_vars": 4, "names": ["x1", "x2", "x3", "x4"]}
    expected = salib.analyze(problem, kept.ravel(), calc_second_order=False, seed=1)
    assert values(found["outputs"]["y"], "ST") == pytest.approx(expected["ST"], rel=1e-12)


def test_an_undefined_row_removes_its_group_like_a_failed_one():
    ds = ishigami(samples=64, replicates=4)
    ds["y"][7] = np.nan
    assert indices(ds)["groups_dropped"] == 1


def test_constant_failed_and_missing_rows_are_refused_not_zero():
    ds = linear("saltelli", samples=16, replicates=4)
    ds = with_output(ds, "flat", np.full(ds.sizes["sample"], 0.1))
    ds = with_output(ds, "gone", np.full(ds.sizes["sample"], np.nan))
    few = np.where(ds["group"].values + ds["replicate"].values > 1, np.nan, ds["y"].values)
    found = indices(with_output(ds, "few", few))["outputs"]
    assert "same value" in found["flat"]["refused"]
    assert "0 of 64 groups" in found["gone"]["refused"]
    assert "3 of 64 groups" in found["few"]["refused"]
    for name in ("flat", "gone", "few"):
        assert "S1" not in found[name]
    assert found["y"]["ST"]["x4"]["value"] == pytest.approx(16 / 30, abs=0.1)
    # Outputs without indices do not count against those with.
    assert indices(ds)["groups_dropped"] == 0
    for rows in (slice(1, None), [0, 1, 2, 9, 10, 11]):
        with pytest.raises(InputError, match="rows of the design are missing"):
            sensitivities(ds.assign_attrs(replicates=1).isel(sample=rows))
    with pytest.raises(InputError, match="rows of the design are missing"):
        sensitivities(ds.isel(sample=np.r_[0:6, 6:12, 12:18, 18:23, 29]))


def test_an_input_without_any_effect_is_zero_without_interval():
    ds = linear("saltelli", samples=32, replicates=4)
    product = ds["x1"].values * ds["x2"].values * ds["x4"].values
    entry = indices(with_output(ds, "product", product))["outputs"]["product"]
    assert entry["ST"]["x3"] == entry["S1"]["x3"] == {"value": 0.0, "low": None, "high": None}
    assert entry["notes"] == ["no effect in any row, hence no interval: x3"]


def test_a_replicate_without_rows_takes_the_intervals_away():
    ds = linear("saltelli", samples=16, replicates=4)
    ds["y"][ds["replicate"].values == 2] = np.nan
    entry = indices(ds)["outputs"]["y"]
    assert entry["ST"]["x1"]["value"] is not None and entry["ST"]["x1"]["low"] is None
    assert "replicates" in entry["notes"][0]


def test_mean_far_from_zero_does_not_spoil_the_indices():
    ds = ishigami(samples=128, replicates=4)
    far = with_output(ds, "far", ds["y"].values + 1e6)
    found = indices(far)["outputs"]
    assert values(found["far"], "S1") == pytest.approx(values(found["y"], "S1"), abs=1e-6)


# Lifetimes ---------------------------------------------------------------------------------------


def lives(values, censored=None, thresholds=()):
    ds = linear("saltelli", samples=64, replicates=4)
    life = with_output(ds, "life", values(ds["y"].values), "lifetime", censored)
    return asking(life, outputs=["life"], thresholds={"life": list(thresholds)})


def test_lifetimes_are_judged_by_rate_and_by_the_studys_own_times():
    ds = lives(
        lambda y: np.where(y > 1, 1 / np.maximum(y - 1, 1e-9), np.inf), thresholds=[0.2, 0.5]
    )
    found = indices(ds)["outputs"]
    assert list(found) == ["rate(life)", "P(life<0.2)", "P(life<0.5)"]
    # The rate of a life that never ends is 0; here the rate is max(y - 1, 0).
    by_rate = with_output(ds, "rate", np.maximum(ds["y"].values - 1, 0.0))
    by_rate = asking(by_rate, outputs=["rate"])
    assert values(found["rate(life)"], "ST") == pytest.approx(
        values(indices(by_rate)["outputs"]["rate"], "ST"), rel=1e-6
    )
    event = with_output(ds, "event", ds["life"].values < 0.2)
    event = indices(asking(event, outputs=["event"]))["outputs"]["event"]
    assert found["P(life<0.2)"]["ST"] == event["ST"]


def test_names_of_lifetimes_carry_their_element():
    ds = kinds("monte-carlo", 128, analysis={"thresholds": {"life": 1e6}})
    names = list(indices(ds)["outputs"])
    assert names[:2] == ["work[side=left]", "work[side=right]"]
    assert names[2:4] == [
        "rate(life[side=left,depth=0.5])",
        "P(life[side=left,depth=0.5]<1000000.0)",
    ]
    assert names[-3:] == ["angle", "P(regime=slow)", "P(regime=fast)"]
    assert len(names) == 2 + 8 + 1 + 2


def test_censored_lives_have_no_rate_but_may_have_a_probability():
    def censored_at_half(ds_values):
        return np.minimum(1 / ds_values, 0.5)

    free = lives(lambda y: 1 / y)
    censored = 1 / free["y"].values > 0.5
    found = indices(lives(censored_at_half, censored, [0.3, 0.5, 0.7]))["outputs"]
    assert "censored" in found["rate(life)"]["refused"]
    assert f"{censored.sum()} rows" in found["P(life<0.7)"]["refused"]
    for name in ("P(life<0.3)", "P(life<0.5)"):
        assert found[name]["ST"]["x4"]["value"] > 0.2


def test_rows_without_a_life_drop_their_groups_from_every_target():
    ds = lives(lambda y: np.where(y > 9, np.nan, 1 / y), thresholds=[0.2])
    lacking = np.isnan(ds["life"].values.reshape(-1, 6)).any(axis=1).sum()
    for name in ("rate(life)", "P(life<0.2)"):
        assert indices(ds)["outputs"][name]["groups_dropped"] == lacking > 0


def test_an_event_that_never_or_always_happens_is_refused():
    found = indices(lives(lambda y: 1 + y, thresholds=[0.5, 100.0]))["outputs"]
    assert "same value" in found["P(life<0.5)"]["refused"]
    assert "same value" in found["P(life<100.0)"]["refused"]
    zero = indices(lives(lambda y: np.where(y > 5, 0.0, y)))["outputs"]["rate(life)"]
    assert "lifetime zero" in zero["refused"]


# Given data --------------------------------------------------------------------------------------


@pytest.mark.parametrize("design", ["monte-carlo", "latin-hypercube", "sobol", "halton"])
@pytest.mark.parametrize(
    ("method", "index", "expected", "tolerance"),
    [
        ("rbd-fast", "S1", (0.3139, 0.4424, 0.0), 0.06),
        # Histograms of four million rows; slices of 1024 rows are coarse, and delta comes out low.
        ("delta", "delta", (0.25, 0.40, 0.20), 0.17),
        ("pawn", "pawn", (0.24, 0.39, 0.09), 0.06),
    ],
)
def test_given_data_methods_rank_ishigami_and_carry_no_interval(
    design, method, index, expected, tolerance
):
    entry = indices(ishigami(design, samples=1024, replicates=1), method)["outputs"]["y"]
    assert values(entry, index) == pytest.approx(expected, abs=tolerance)
    x1, x2, x3 = values(entry, index)
    assert x2 > x1 > x3
    assert all(one["low"] is None and one["high"] is None for one in entry[index].values())
    assert 0 < entry["dummy"][index] < min(expected[:2])


@pytest.mark.parametrize(
    ("method", "index"), [("rbd-fast", "S1"), ("delta", "delta"), ("pawn", "pawn")]
)
def test_dummy_is_passed_by_one_input_in_twenty_that_plays_no_part(method, index):
    rng = np.random.default_rng(5)
    passed = []
    for _ in range(12):
        ds = with_output(linear(samples=100), "noise", rng.random(100))
        entry = indices(asking(ds, outputs=["noise"]), method)["outputs"]["noise"]
        passed += [value > entry["dummy"][index] for value in values(entry, index)]
    assert DUMMIES == 19
    assert stats.binomtest(sum(passed), len(passed), 0.05).pvalue > 0.01


def test_given_data_values_are_those_of_salib():
    ds = ishigami("monte-carlo", samples=303, replicates=1)
    x, y = np.column_stack([ds[name].values for name in INPUTS]), ds["y"].values
    problem = {"num_vars": 3, "names": list(INPUTS)}
    fast = indices(ds, "rbd-fast")["outputs"]["y"]
    assert values(fast, "S1") == pytest.approx(rbd_fast.analyze(problem, x, y, seed=1)["S1"])
    rounded = with_output(ds.assign(x3=ds["x3"].round(0)), "rounded", y.round(0))
    for one, name in ((ds, "y"), (rounded, "rounded")):
        x_of = np.column_stack([one[name].values for name in INPUTS])
        expected = pawn.analyze(problem, x_of, one[name].values)["median"]
        assert values(indices(one, "pawn")["outputs"][name], "pawn") == pytest.approx(expected)
    scores = stats.norm.ppf((stats.rankdata(y) - 0.5) / 303)
    grid, ends = np.linspace(scores.min(), scores.max(), 100), np.linspace(0, 303, 6)
    assert values(indices(ds, "delta")["outputs"]["y"], "delta") == pytest.approx(
        [calc_delta(scores, grid, column, ends) for column in x.T]
    )
    dummies = np.random.default_rng(0).random((303, DUMMIES))
    problem = {"num_vars": DUMMIES, "names": [str(i) for i in range(DUMMIES)]}
    largest = max(rbd_fast.analyze(problem, dummies, y, seed=1)["S1"])
    assert fast["dummy"]["S1"] == pytest.approx(largest)


def test_given_data_depends_on_nothing_but_the_rows():
    ds = ishigami("monte-carlo", samples=200, replicates=1)
    state = np.random.get_state()[1].copy()  # noqa: NPY002
    shown = warnings.formatwarning
    filters = list(warnings.filters)
    first = [sensitivities(ds, method) for method in ("rbd-fast", "delta", "pawn")]
    assert (np.random.get_state()[1] == state).all()  # noqa: NPY002
    assert warnings.formatwarning is shown and warnings.filters == filters
    assert [sensitivities(ds, method) for method in ("rbd-fast", "delta", "pawn")] == first


def test_delta_and_pawn_do_not_depend_on_the_scale_of_the_output():
    ds = ishigami("monte-carlo", samples=500, replicates=1)
    ds = with_output(ds, "grown", np.exp(3 * ds["y"].values))
    for method in ("delta", "pawn"):
        found = indices(ds, method)["outputs"]
        assert values(found["grown"], method) == pytest.approx(values(found["y"], method))
        assert max(values(found["grown"], method)) < 1


def test_given_data_drops_rows_and_counts_them():
    ds = linear(samples=200, settings={"fail_above": 0.8})
    for method in ("rbd-fast", "delta", "pawn"):
        found = indices(ds, method)
        assert found["groups_dropped"] == int(ds["y"].isnull().sum()) > 0
        assert found["rows_used"] == 200 - found["groups_dropped"]
        assert found["outputs"]["y"]["rows_used"] == found["rows_used"]
        sound = ds.isel(sample=~np.isnan(ds["y"].values))
        alone = indices(sound, method)["outputs"]["y"]
        assert alone == found["outputs"]["y"] | {"groups_dropped": 0}


def test_given_data_judges_64_rows():
    for method in ("rbd-fast", "delta", "pawn"):
        assert "refused" not in indices(linear(samples=64), method)["outputs"]["y"]


def test_given_data_refuses_what_it_cannot_judge():
    ds = linear(samples=200)
    y = ds["y"].values
    ds = with_output(ds, "flat", np.full(200, 3.0))
    ds = with_output(ds, "short", np.where(np.arange(200) < 63, y, np.nan))
    ds = with_output(ds, "event", y > 5)
    for method in ("rbd-fast", "delta", "pawn"):
        found = indices(ds, method)["outputs"]
        assert "same value" in found["flat"]["refused"]
        assert "63 of 200 rows" in found["short"]["refused"]
        assert ("refused" in found["event"]) == (method == "delta")


# What is asked -----------------------------------------------------------------------------------


def test_method_is_the_studys_or_the_designs_own():
    assert methods(linear("saltelli")) == ("sobol",)
    assert methods(linear("halton", 128)) == ("rbd-fast",)
    ds = linear(samples=128, analysis={"sensitivity": ["pawn", "delta"]})
    assert methods(ds) == ("pawn", "delta")
    assert sensitivities(ds)["method"] == "pawn"
    assert sensitivities(ds, "rbd-fast")["method"] == "rbd-fast"


@pytest.mark.parametrize(
    ("design", "method", "sentence"),
    [
        (
            "monte-carlo",
            "sobol",
            "needs a design of saltelli; this result is of design 'monte-carlo'",
        ),
        (
            "saltelli",
            "delta",
            "needs a design of monte-carlo or latin-hypercube or sobol or halton",
        ),
        ("monte-carlo", "pawm", "no such method 'pawm'; did you mean 'pawn'"),
    ],
)
def test_a_method_that_the_design_cannot_feed_is_refused(design, method, sentence):
    with pytest.raises(InputError, match=sentence):
        sensitivities(linear(design), method)


def test_outputs_can_be_named_in_every_way():
    ds = kinds(samples=128, analysis={"thresholds": {"life": 1.0}, "outputs": ["work"]})
    assert list(indices(ds)["outputs"])[:2] == ["work[side=left]", "work[side=right]"]
    assert list(indices(ds, output="angle")["outputs"]) == ["angle"]
    assert list(indices(ds, output="work[side=left]")["outputs"]) == ["work[side=left]"]
    assert len(indices(ds, output="life")["outputs"]) == 8
    name = "P(life[side=left,depth=0.5]<1.0)"
    assert list(indices(ds, output=name)["outputs"]) == [name]
    name = "rate(life[side=right,depth=1.5])"
    assert list(indices(ds, output=name)["outputs"]) == [name]
    both = ["P(regime=slow)", "P(regime=fast)"]
    assert list(indices(ds, output="regime")["outputs"]) == both
    assert list(indices(ds, output=both[1])["outputs"]) == both[1:]
    for wrong, sentence in {
        "wrok": "no such output 'wrok'; did you mean 'work'",
        "work[side=lefd]": r"no such element 'work\[side=lefd\]'; did you mean 'work\[side=left\]'",
        "rate(work[side=left])": "no such output",
        "P(life[side=left,depth=0.5]<2.0)": "no such output",
        "P(regime=medium)": "no such output",
    }.items():
        with pytest.raises(InputError, match=sentence):
            sensitivities(ds, output=wrong)


def test_indices_as_arrays_say_the_same():
    ds = ishigami(samples=64, replicates=4, second_order=True)
    arrays = uq.sensitivity(ds)
    entry = indices(ds)["outputs"]["y"]
    assert list(arrays["parameter"].values) == list(INPUTS)
    one = arrays.sel(output="y", parameter="x2")
    assert [float(one[name]) for name in ("ST", "ST_low", "ST_high")] == list(
        entry["ST"]["x2"].values()
    )
    assert float(arrays["S2_high"].sel(output="y", pair="x1,x3")) == entry["S2"]["x1,x3"]["high"]

    plain = with_output(linear(samples=128), "flat", np.full(128, 1.0))
    arrays = uq.sensitivity(plain, "rbd-fast")
    assert float(arrays["dummy_S1"].sel(output="y")) > 0
    assert np.isnan(arrays["S1"].sel(output="flat")).all()
    assert arrays["refused"].sel(output="y") == ""
    assert "same value" in arrays["refused"].sel(output="flat").item()


def test_all_failed_is_refused_everywhere():
    for design, chosen in (("saltelli", ["sobol"]), ("monte-carlo", ["rbd-fast", "delta", "pawn"])):
        ds = linear(design, samples=128, settings={"fail_above": -1.0})
        assert (ds["status"] == Status.NON_FINITE).all()
        for method in chosen:
            found = indices(ds, method)
            assert "refused" in found["outputs"]["y"]
            assert found["rows_used"] == 0
            assert np.isnan(uq.sensitivity(ds, method).get("S1", np.nan)).all()
