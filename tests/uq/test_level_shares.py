"""Shares of the variance by level: values, what cannot be told apart, and every reader."""

import json

import numpy as np
import pytest
from command_line import strict_json
from computed import asking, computed, once, study_of, with_output
from nested_studies import LEVELS, nested, nested_result
from noisy_studies import noisy
from scipy import stats

import uq as api
from uq.analysis.apportioned import shares_of
from uq.analysis.fleet import fleet_of
from uq.analysis.level_shares import by_level
from uq.errors import InputError
from uq.nested_variance import nested_shares
from uq.rows.nesting import nesting_of
from uq.rows.variables import error_name

SHARED, OWN, CHANCE = LEVELS.values()
VARIANCES = {SHARED: 1.0, OWN: 4.0, CHANCE: 9.0}
"""Of the linear function, in twelfths."""


def effects(variances, shape, seed=0):
    """Return random effects with these variances."""
    rng = np.random.default_rng(seed)
    shapes = (shape[0], 1, 1), (*shape[:2], 1), shape
    return sum(v**0.5 * rng.standard_normal(s) for v, s in zip(variances, shapes, strict=True))


def test_shares_of_the_linear_function():
    ds = nested_result(samples=2000, units=3, repeats=3)
    found = by_level(ds).outputs["y"]
    assert found.variance == pytest.approx(14 / 12, rel=0.05)
    for level, variance in VARIANCES.items():
        one = found.shares[level]
        assert one.value == pytest.approx(variance / 14, abs=0.02)
        assert one.low < one.value < one.high < one.low + 0.08
    assert sum(found.shares[level].value for level in VARIANCES) == pytest.approx(1.0)
    assert found.shares["solver"].reason == "the model states no numerical error of it"


def test_interplay_with_what_is_shared_is_own():
    x1, x2 = (np.random.default_rng(i).choice([-1.0, 1.0], (400, 10 * i, 1)) for i in (0, 1))
    x1 = np.random.default_rng(2).choice([-1.0, 1.0], (400, 1, 1))
    found = nested_shares(x1 * x2)
    assert found.middle.value == pytest.approx(1.0, abs=0.02)
    assert found.outer.low == 0.0


def test_components_are_those_of_the_analysis_of_variance():
    table = effects((0.3, 0.5, 0.2), (6, 4, 3))
    samples, units, repeats = table.shape
    means = table.mean(axis=2)
    within = table.var(axis=2, ddof=1).mean()
    between = repeats * means.var(axis=1, ddof=1).mean()
    outer = units * repeats * means.mean(axis=1).var(ddof=1)
    parts = (
        (outer - between) / (units * repeats),
        (between - within) / repeats,
        within,
    )
    found = nested_shares(table)
    assert found.variance == pytest.approx(sum(parts))
    assert [one.value * found.variance for one in found[:3]] == pytest.approx(parts)
    assert all("needs 8 samples" in one.reason for one in found[:3])


def test_the_interval_is_a_jackknife_over_samples():
    table = effects((0.7, 0.2, 0.1), (12, 4, 3))
    noise = table.mean(axis=2).var(axis=1, ddof=1).mean() / 4 / nested_shares(table).variance

    def logit(share):
        return np.log((share + noise) / (1 - share))

    found = nested_shares(table).outer
    pseudo = np.array(
        [
            12 * found.value - 11 * nested_shares(np.delete(table, i, axis=0)).outer.value
            for i in range(12)
        ]
    )
    squares = (pseudo - pseudo.mean()) ** 2
    slope = 1 / (found.value + noise) + 1 / (1 - found.value)
    widened = 1 + 2 * (squares.max() / squares.sum()) ** 2
    half = stats.t.ppf(0.975, 11) * slope * np.sqrt(widened * squares.sum() / 11 / 12)
    assert logit(found.high) - logit(found.value) == pytest.approx(half)
    assert logit(found.value) - logit(found.low) == pytest.approx(half)


def test_missing_values_leave_the_shares_unbiased():
    table = effects((0.3, 0.3, 0.4), (4000, 4, 3))
    whole = nested_shares(table)
    table[np.random.default_rng(1).random(table.shape) < 0.3] = np.nan
    found = nested_shares(table)
    for one, other in zip(found[:3], whole[:3], strict=True):
        assert one.value == pytest.approx(other.value, abs=0.03)
    table[:10] = np.nan
    assert nested_shares(table).left_out == found.left_out + 10


def test_shifts_and_units_change_no_share():
    table = effects((0.3, 0.3, 0.4), (50, 4, 3))
    one, other = nested_shares(table), nested_shares(1e6 + 1e-3 * table)
    for before, after in zip(one[:3], other[:3], strict=True):
        assert after.numbers == pytest.approx(before.numbers, rel=1e-6)


NONE, ALL, UNKNOWN = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (np.nan, np.nan, np.nan)


@pytest.mark.parametrize(
    ("varying", "shape", "expected"),
    [
        ({SHARED}, (20, 2, 2), (ALL, NONE, NONE)),
        ({OWN}, (20, 2, 2), (NONE, ALL, NONE)),
        ({CHANCE}, (20, 2, 2), (NONE, NONE, ALL)),
        ({SHARED, OWN}, (20, 1, 2), (UNKNOWN, UNKNOWN, NONE)),
        ({SHARED, CHANCE}, (20, 1, 1), (UNKNOWN, NONE, UNKNOWN)),
        ({OWN, CHANCE}, (20, 2, 1), (NONE, ALL, UNKNOWN)),
        ({SHARED, OWN, CHANCE}, (20, 1, 1), (UNKNOWN, UNKNOWN, UNKNOWN)),
    ],
)
def test_what_is_known_without_an_estimate(varying, shape, expected):
    variances = [float(level in varying) for level in LEVELS.values()]
    found = shares_of(effects(variances, shape), varying).shares
    for level, numbers in zip(LEVELS.values(), expected, strict=True):
        assert found[level].numbers == pytest.approx(numbers, nan_ok=True)
        assert bool(found[level].reason) == (numbers is UNKNOWN)


@pytest.mark.parametrize(
    ("varying", "shape"),
    [
        ({SHARED, OWN}, (3000, 3, 1)),
        ({SHARED, CHANCE}, (3000, 3, 1)),
        ({SHARED, CHANCE}, (3000, 1, 3)),
        ({OWN, CHANCE}, (1500, 2, 3)),
        ({SHARED, OWN, CHANCE}, (3000, 3, 2)),
    ],
)
def test_two_levels_are_told_apart_by_what_the_rows_have(varying, shape):
    variances = [{SHARED: 0.2, OWN: 0.3, CHANCE: 0.5}[one] * (one in varying) for one in VARIANCES]
    found = shares_of(effects(variances, shape), varying)
    for level, variance in zip(VARIANCES, variances, strict=True):
        assert found.shares[level].value == pytest.approx(variance / sum(variances), abs=0.05)


def test_one_repeat_counts_chance_as_own():
    found = shares_of(effects((0.2, 0.3, 0.5), (3000, 4, 1)), set(VARIANCES)).shares
    assert found[OWN].value == pytest.approx(0.8, abs=0.05)
    assert found[OWN].assumes == "that chance counts as own"
    assert np.isnan(found[CHANCE].value)
    assert found[CHANCE].reason == (
        "a single repeat cannot separate chance from what is own to a unit; set repeats = 2"
    )


def test_one_unit_tells_chance_alone():
    found = shares_of(effects((0.2, 0.3, 0.5), (3000, 1, 4)), set(VARIANCES)).shares
    assert found[CHANCE].value == pytest.approx(0.5, abs=0.05)
    assert "set units = 2" in found[SHARED].reason and np.isnan(found[OWN].value)


def test_replicates_of_an_even_design_are_what_is_independent():
    table = effects((0.3, 0.3, 0.4), (64, 4, 3))
    eight = nested_shares(table, replicate=np.repeat(np.arange(8), 8)).outer
    alone = nested_shares(table).outer
    assert eight.value == pytest.approx(alone.value)
    assert eight.numbers[1:] != pytest.approx(alone.numbers[1:])
    one = nested_shares(table, replicate=np.zeros(64, int)).outer
    assert one.reason == "a single replicate does not show its scatter" and np.isnan(one.low)


def test_values_that_agree_have_no_shares():
    assert nested_shares(np.ones((20, 2, 2))).outer.reason == "all values are the same"
    same = nested_shares(np.tile(np.random.default_rng(0).random((20, 1, 1)), (1, 3, 1)))
    assert same.middle.value == 0.0 and not same.middle.has_interval
    assert same.middle.reason == "no two samples show different shares"


def test_the_solver_has_the_share_of_its_stated_error():
    ds = nested_result(samples=200)
    scale = 1e-2
    with_error = with_output(ds, error_name("y"), np.full(ds.sizes["sample"], scale))
    found = by_level(with_error).outputs
    assert list(found) == ["y"]
    assert found["y"].shares["solver"].value == pytest.approx(scale**2 / found["y"].variance)


def test_lives_are_apportioned_by_their_logarithm():
    ds = nested_result(samples=100)
    life = np.exp(3 * ds["y"].values)
    lives = with_output(ds, "life", life, "lifetime", np.zeros(len(life)))
    error = with_output(lives, error_name("life"), 0.1 * life)
    found = by_level(asking(error, thresholds={"life": [1e6]}, outputs=["life"])).outputs
    assert list(found) == ["log(life)", "P(life<1000000.0)"]
    expected = by_level(ds).outputs["y"].shares
    for level in VARIANCES:
        assert found["log(life)"].shares[level].numbers == pytest.approx(expected[level].numbers)
    assert found["log(life)"].shares["solver"].value == pytest.approx(
        0.01 / found["log(life)"].variance
    )
    endless = with_output(ds, "life", np.where(life > 1e6, np.inf, life), "lifetime", life < 0)
    assert list(by_level(endless, "life").outputs) == ["rank(life)"]


def lognormal(sigma, **more):
    return {"distribution": "lognormal", "median": 1.0, "sigma": sigma, **more}


NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
SCALING = {
    "a": lognormal(0.3),
    "b": lognormal(0.2, level=SHARED),
    "c": lognormal(1.0, level=CHANCE),
    "z": NORMAL,
}
"""Inputs of life = a b^-2 c^(1/2) exp(z/2)."""

OF_LOG_LIFE = {SHARED: 0.4**2, OWN: 0.3**2 + 0.5**2, CHANCE: 0.5**2}
"""Their variances of the logarithm; all but 0.5^2 of what is own are known without a row."""


def scaled(uncertain=None, tables=(), model="sample_models:SCALED", **design):
    given = {"method": "monte-carlo", "samples": 100, "units": 3, "repeats": 2, "seed": 5}
    study = {
        "study": {"name": "scaled", "model": "scaled"},
        "design": given | design,
        "uncertain": uncertain or SCALING,
        "analysis": {"outputs": ["life"]},
        **dict(tables),
    }
    return study_of(study, model)


@once
def scaled_result(**options):
    return computed(scaled(**options))


def test_what_only_scales_a_life_has_a_known_share():
    ds = scaled_result(samples=400)
    found = by_level(ds).outputs["log(life)"]
    plain = by_level(ds, plain=True).outputs["log(life)"]
    assert set(found.integrated) == {"a", "b", "c"} and plain.integrated == ()
    total = sum(OF_LOG_LIFE.values())
    for level, variance in OF_LOG_LIFE.items():
        one, other = found.shares[level], plain.shares[level]
        assert one.low < variance / total < one.high
        assert other.value == pytest.approx(variance / total, abs=0.06)
        assert one.high - one.low < 0.7 * (other.high - other.low)
    assert sum(found.shares[level].value for level in OF_LOG_LIFE) == pytest.approx(1.0)
    known = OF_LOG_LIFE[SHARED] / found.variance
    assert found.shares[SHARED].value == pytest.approx(known, abs=0.02)
    assert found.variance == pytest.approx(total, rel=0.05)


def test_with_everything_integrated_shares_are_exact():
    """One row of each sample is enough: nothing that the rows cannot tell apart is left."""
    uncertain = {name: law for name, law in SCALING.items() if name != "z"}
    ds = computed(scaled(uncertain, units=1, repeats=1, samples=10))
    found = by_level(ds).outputs["log(life)"]
    variances = {SHARED: 0.16, OWN: 0.09, CHANCE: 0.25}
    for level, variance in variances.items():
        assert found.shares[level].numbers == pytest.approx([variance / 0.5] * 3, rel=1e-9)
    assert found.variance == pytest.approx(0.5, rel=1e-9)
    assert "set repeats" in by_level(ds, plain=True).outputs["log(life)"].shares[CHANCE].reason


@pytest.mark.parametrize(
    ("level", "units", "repeats"),
    [
        (SHARED, 1, 1),
        (OWN, 1, 1),
        (CHANCE, 1, 1),
        (OWN, 1, 2),
        (SHARED, 2, 1),
    ],
)
def test_what_is_not_integrated_on_one_level_needs_one_row_a_sample(level, units, repeats):
    uncertain = SCALING | {"z": NORMAL | {"level": level}}
    ds = computed(scaled(uncertain, units=units, repeats=repeats, samples=2000))
    found = by_level(ds).outputs["log(life)"]
    variances = {SHARED: 0.16, OWN: 0.09, CHANCE: 0.25}
    variances[level] += 0.25
    for name, variance in variances.items():
        one = found.shares[name]
        assert one.low < variance / 0.75 < one.high < one.low + 0.06


def test_powers_that_cancel_do_not_vary():
    """A fleet of any size then follows from samples of one unit."""
    uncertain = {"a": lognormal(0.4), "c": {"equals": "a"}, "z": NORMAL | {"level": SHARED}}
    ds = computed(scaled(uncertain, units=1, repeats=1)).copy(deep=True)
    ds["life"].values[:] = np.exp(ds["z"].values / 2)
    ds["life"].attrs["scales"] = json.dumps({"a": 1.0, "c": -1.0})
    found = by_level(ds).outputs["log(life)"]
    assert found.shares[SHARED].numbers == (1.0, 1.0, 1.0)
    first = fleet_of(ds, 1000).first[0.5]
    assert first.estimate.value == pytest.approx(np.median(ds["life"]), rel=0.1)
    ds["life"].attrs["scales"] = json.dumps({"a": 1.0})
    with pytest.raises(InputError, match="a fleet of 1000 needs samples of as many units, now 1"):
        fleet_of(ds, 1000)


@pytest.mark.parametrize(("method", "said"), [("sobol", ""), ("saltelli", " and method = 'monte")])
def test_what_to_set_is_possible_in_the_design(method, said):
    uncertain = {"a": lognormal(0.4) | {"level": OWN}, "z": NORMAL | {"level": SHARED}}
    design = {"method": method, "units": 1, "repeats": 1, "samples": 64, "replicates": 8}
    ds = computed(scaled(uncertain, **design))
    (reason,) = {
        by_level(ds, plain=True).outputs["log(life)"].shares[one].reason for one in (OWN, SHARED)
    }
    assert reason.startswith(
        f"a single unit cannot show what is shared and what is own; set units = 2{said}"
    )
    with pytest.raises(InputError, match=rf"in \[design\] set units = 9{said}"):
        fleet_of(ds, 9, plain=True)
    band = fleet_of(ds, 1, [1.0], plain=True).by[1.0][0].low.reason
    assert band == reason


def test_what_the_rows_cannot_tell_apart_stays_so():
    """Two levels with something else that varies, in one row of each sample."""
    uncertain = SCALING | {"z": NORMAL, "c": LISTED | {"level": SHARED}}
    ds = computed(scaled(uncertain, units=1, repeats=1))
    found = by_level(ds).outputs["log(life)"]
    assert "set units = 2" in found.shares[SHARED].reason and np.isnan(found.shares[OWN].value)
    assert found.shares[CHANCE].numbers == (0.0, 0.0, 0.0)
    assert "c not integrated: its law is one of listed values" in found.sentences


LISTED = {"distribution": "discrete-choice", "values": [0.5, 1.0, 2.0]}
RANKS = {"parameters": ["a", "z"], "rank_correlation": [[1.0, 0.7], [0.7, 1.0]]}
TRUNCATED = {"distribution": "uniform", "lower": 0.2, "upper": 3.0}


@pytest.mark.parametrize(
    ("uncertain", "tables"),
    [
        (SCALING, {"dependence": RANKS}),
        (SCALING | {"a": TRUNCATED}, {"dependence": RANKS}),
        (SCALING | {"a": TRUNCATED | {"times": "c"}, "c": lognormal(0.4)}, {}),
        (SCALING | {"c": {"equals": "a"}}, {}),
    ],
    ids=["correlated", "correlated, another law", "multiple", "tied"],
)
def test_each_by_its_law_given_the_rest(uncertain, tables):
    """The plain shares of many rows lie in the intervals."""
    ds = scaled_result(uncertain=uncertain, tables=tables.items(), samples=4000)
    found = by_level(ds).outputs["log(life)"]
    plain = by_level(ds, plain=True).outputs["log(life)"]
    assert "a" in found.integrated
    assert found.variance == pytest.approx(plain.variance, rel=0.03)
    for level in (SHARED, OWN, CHANCE):
        one, other = found.shares[level], plain.shares[level]
        assert one.value == pytest.approx(other.value, abs=other.high - other.low)
    assert sum(found.shares[level].value for level in OF_LOG_LIFE) == pytest.approx(1.0)


def test_what_is_not_integrated_says_why():
    never = computed(scaled(tables={"settings": {"never_above": 1.0}}.items()))
    (name, found), *_ = by_level(never).outputs.items()
    assert name == "rank(life)" and found.integrated == ()
    assert "b and a and c not integrated: the lives are replaced by their ranks" in found.sentences
    cut = computed(scaled(tables={"settings": {"horizon": 2.0}}.items()))
    assert "replaced by their ranks" in " ".join(by_level(cut).outputs["rank(life)"].sentences)


def test_replicates_are_what_is_independent_where_inputs_are_integrated():
    ds = computed(scaled(method="sobol", samples=32, replicates=8))
    found = by_level(ds).outputs["log(life)"].shares
    total = sum(OF_LOG_LIFE.values())
    for level, variance in OF_LOG_LIFE.items():
        assert found[level].low < variance / total < found[level].high


def test_terminal_json_and_python_say_what_is_integrated(uq, tmp_path, monkeypatch):
    path = tmp_path / "scaled.nc"
    ds = scaled_result()
    ds.to_netcdf(path)
    found = strict_json(uq("levels", path, "--json").out)["outputs"]["log(life)"]
    assert found["integrated"] == ["b", "a", "c"]
    plain = strict_json(uq("levels", path, "--plain", "--json").out)["outputs"]["log(life)"]
    assert plain["integrated"] == []
    assert found["own"]["high"] - found["own"]["low"] < plain["own"]["high"] - plain["own"]["low"]
    shown = uq("levels", path).out
    assert "b and a and c integrated exactly" in shown
    assert "integrated" not in uq("levels", path, "--plain").out
    table = api.levels(ds)
    assert str(table["integrated"].values[0]) == "b a c"
    assert float(table["share"].sel(level=OWN)[0]) == found["own"]["value"]
    assert str(api.levels(ds, plain=True)["integrated"].values[0]) == ""


def test_a_heavy_tail_is_replaced_and_the_note_promises_nothing_else():
    ds = nested_result(samples=100)
    heavy = with_output(ds, "w", np.exp(12 * ds["y"].values))
    (name, found), *_ = by_level(heavy, "w").outputs.items()
    assert name == "log(w)"
    assert found.sentences[0].endswith(": these are shares of the variance of its logarithm")


def test_a_random_model_differs_by_chance():
    ds = computed(noisy("monte-carlo", 400, 1, units=2, repeats=2))
    found = by_level(ds, "y").outputs["y"].shares
    assert found[SHARED].numbers == (0.0, 0.0, 0.0)
    assert found[OWN].low < 0.5 < found[OWN].high
    assert found[CHANCE].low < 0.5 < found[CHANCE].high
    plain = computed(noisy("monte-carlo", 400, 1))
    assert "set repeats = 2" in by_level(plain, "y").outputs["y"].shares[CHANCE].reason


def regimes(ds, codes):
    """Return a result with regimes."""
    attrs = {
        "role": "output",
        "kind": "category",
        "units": "1",
        "long_name": "regime",
        "may_be_undefined": 0,
        "flag_values": np.array([-1, 0, 1], np.int8),
        "flag_meanings": "none calm wild",
    }
    return ds.assign(regime=("sample", np.asarray(codes, np.int8), attrs))


def test_a_repeat_may_end_in_another_regime():
    ds = nested_result(samples=200, units=3, repeats=4)
    chance = ds["x3"].values
    found = by_level(regimes(ds, chance > 0.25))
    mean = found.another_regime
    assert mean.low < 2 * 0.25 * 0.75 < mean.high
    each = nesting_of(ds).table(found.switching)
    codes = nesting_of(ds).table(chance > 0.25)
    unit = codes[0, 0]
    others = [np.mean(np.delete(unit, i) != unit[i]) for i in range(4)]
    assert each[0, 0] == pytest.approx(others)
    calm = by_level(regimes(ds, ds["x2"].values > 0.5)).another_regime
    assert calm.value == calm.low == 0 and 0 < calm.high < 0.03  # 200 samples, not 2400 rows
    lost = by_level(regimes(ds, np.full(len(chance), -1))).another_regime
    assert "a single repeat" in lost.reason


def test_no_repeat_ends_in_another_regime_where_nothing_is_random():
    ds = nested_result(levels={"x1": "shared", "x2": "own"}, samples=20, repeats=1)
    found = by_level(regimes(ds, ds["x2"].values > 0.5))
    assert found.another_regime.numbers == (0.0, 0.0, 0.0)
    one = nested_result(samples=20, repeats=1)
    assert "set repeats = 2" in by_level(regimes(one, one["x2"].values > 0.5)).another_regime.reason


def test_rows_that_do_not_follow_the_laws_have_no_shares():
    ds = computed(nested(method="morris", units=1, repeats=1))
    with pytest.raises(InputError, match="no shares: the rows of a 'morris' design do not follow"):
        by_level(ds)


def test_python_terminal_json_and_report_agree(uq, tmp_path):
    path, result = tmp_path / "nested.toml", tmp_path / "nested.nc"
    path.write_text(nested(samples=20).text)
    assert uq("run", path, "-o", result, "--workers", "0").code == 0
    known = by_level(api.open_result(result)).outputs["y"].shares
    table = api.levels(api.open_result(result))
    assert dict(table.sizes) == {"output": 1, "level": 4}
    found = strict_json(uq("levels", result, "--json").out)
    assert found["inputs"] == LEVELS
    assert (found["samples"], found["units"], found["repeats"]) == (20, 3, 2)
    for level, one in known.items():
        cells = [
            float(table[name].sel(level=level, output="y"))
            for name in ("share", "share_low", "share_high")
        ]
        assert cells == pytest.approx(one.numbers, nan_ok=True)
        entry = found["outputs"]["y"][level]
        if level != "solver":
            assert (entry["value"], entry["low"], entry["high"]) == one.numbers
    assert found["outputs"]["y"]["solver"]["value"] is None
    assert found["outputs"]["y"]["solver"]["reason"]
    shown = uq("levels", result).out
    assert f"{known[OWN].value:.3f}" in shown and "20 samples of 3 units" in shown
    assert uq("report", result, "-o", tmp_path / "page.html").code == 0
    page = (tmp_path / "page.html").read_text()
    section = page.partition('<section id="levels">')[2].partition("</section>")[0]
    assert f"{known[SHARED].value:.3f}" in section and "20 samples of 3 units" in section


def test_an_unknown_output_is_one_line(uq, tmp_path):
    path, result = tmp_path / "nested.toml", tmp_path / "nested.nc"
    path.write_text(nested(samples=8).text)
    uq("run", path, "-o", result, "--workers", "0")
    ended = uq("levels", result, "--output", "yy")
    assert ended.code == 2 and ended.err.count("\n") == 1 and "did you mean 'y'?" in ended.err


def test_errors_are_no_outputs_of_their_own():
    ds = nested_result()
    with_error = with_output(ds, error_name("y"), np.zeros(ds.sizes["sample"]))
    assert list(by_level(with_error).outputs) == ["y"]


def test_a_regime_has_shares_like_any_event(uq, tmp_path):
    ds = nested_result(samples=400, units=1, repeats=2)
    calm = regimes(ds, ds["x2"].values > 0.5)
    found = by_level(calm, "regime").outputs
    assert list(found) == ["P(regime=calm)", "P(regime=wild)"]
    for shares in found.values():
        assert shares.shares["chance"].value == pytest.approx(0.0, abs=1e-12)
    moody = by_level(regimes(ds, ds["x3"].values > 0.5), "regime").outputs["P(regime=wild)"]
    assert moody.shares["chance"].low < 1.0 <= moody.shares["chance"].high
    rare = by_level(regimes(ds, ds["x3"].values > 0.997), "regime").outputs["P(regime=wild)"]
    assert "are needed for an index" in rare.shares["chance"].reason
    traced = api.trace(calm, "levels/outputs/P(regime=calm)/own")
    assert traced["equal"]
