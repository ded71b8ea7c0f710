"""Shares of levels of lives that some inputs only scale: known without a row."""

import json

import numpy as np
import pytest
from command_line import strict_json
from computed import computed, once, study_of
from nested_studies import CHANCE, OWN, SHARED

import uq as api
from uq.assess.components_by_level import by_level
from uq.assess.fleet import fleet_of
from uq.errors import InputError
from uq.result.result import Result


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
    entry = by_level(Result(ds)).outputs["log(life)"]
    plain = by_level(Result(ds), plain=True).outputs["log(life)"]
    assert set(entry.integrated) == {"a", "b", "c"} and plain.integrated == ()
    total = sum(OF_LOG_LIFE.values())
    for level, variance in OF_LOG_LIFE.items():
        share, other = entry.shares[level], plain.shares[level]
        assert share.low < variance / total < share.high
        assert other.value == pytest.approx(variance / total, abs=0.06)
        assert share.high - share.low < 0.7 * (other.high - other.low)
    assert sum(entry.shares[level].value for level in OF_LOG_LIFE) == pytest.approx(1.0)
    expected = OF_LOG_LIFE[SHARED] / entry.variance
    assert entry.shares[SHARED].value == pytest.approx(expected, abs=0.02)
    assert entry.variance == pytest.approx(total, rel=0.05)


def test_with_everything_integrated_shares_are_exact():
    """One row of each sample is enough: nothing that the rows cannot tell apart is left."""
    uncertain = {name: law for name, law in SCALING.items() if name != "z"}
    ds = computed(scaled(uncertain, units=1, repeats=1, samples=10))
    entry = by_level(Result(ds)).outputs["log(life)"]
    variances = {SHARED: 0.16, OWN: 0.09, CHANCE: 0.25}
    for level, variance in variances.items():
        assert entry.shares[level].numbers == pytest.approx([variance / 0.5] * 3, rel=1e-9)
    assert entry.variance == pytest.approx(0.5, rel=1e-9)
    assert (
        "set repeats" in by_level(Result(ds), plain=True).outputs["log(life)"].shares[CHANCE].reason
    )


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
    entry = by_level(Result(ds)).outputs["log(life)"]
    variances = {SHARED: 0.16, OWN: 0.09, CHANCE: 0.25}
    variances[level] += 0.25
    for name, variance in variances.items():
        share = entry.shares[name]
        assert share.low < variance / 0.75 < share.high < share.low + 0.06


def test_powers_that_cancel_do_not_vary():
    """A fleet of any size then follows from samples of one unit."""
    uncertain = {"a": lognormal(0.4), "c": {"equals": "a"}, "z": NORMAL | {"level": SHARED}}
    ds = computed(scaled(uncertain, units=1, repeats=1)).copy(deep=True)
    ds["life"].values[:] = np.exp(ds["z"].values / 2)
    ds["life"].attrs["scales"] = json.dumps({"a": 1.0, "c": -1.0})
    entry = by_level(Result(ds)).outputs["log(life)"]
    assert entry.shares[SHARED].numbers == (1.0, 1.0, 1.0)
    first = fleet_of(Result(ds), 1000).first[0.5]
    assert first.estimate.value == pytest.approx(np.median(ds["life"]), rel=0.1)
    ds["life"].attrs["scales"] = json.dumps({"a": 1.0})
    with pytest.raises(InputError, match="a fleet of 1000 needs samples of as many units, now 1"):
        fleet_of(Result(ds), 1000)


@pytest.mark.parametrize(
    ("method", "change"), [("sobol", ""), ("saltelli", " and method = 'monte")]
)
def test_what_to_set_is_possible_in_the_design(method, change):
    uncertain = {"a": lognormal(0.4) | {"level": OWN}, "z": NORMAL | {"level": SHARED}}
    design = {"method": method, "units": 1, "repeats": 1, "samples": 64, "replicates": 8}
    ds = computed(scaled(uncertain, **design))
    (reason,) = {
        by_level(Result(ds), plain=True).outputs["log(life)"].shares[level].reason
        for level in (OWN, SHARED)
    }
    assert reason.startswith(
        f"one unit per sample cannot separate shared inputs from differences between units; set"
        f" units = 2{change}"
    )
    with pytest.raises(InputError, match=rf"in \[design\] set units = 9{change}"):
        fleet_of(Result(ds), 9, plain=True)
    band = fleet_of(Result(ds), 1, [1.0], plain=True).by[1.0][0].low.reason
    assert band == reason


def test_what_the_rows_cannot_tell_apart_stays_so():
    """Two levels with something else that varies, in one row of each sample."""
    uncertain = SCALING | {"z": NORMAL, "c": LISTED | {"level": SHARED}}
    ds = computed(scaled(uncertain, units=1, repeats=1))
    entry = by_level(Result(ds)).outputs["log(life)"]
    assert "set units = 2" in entry.shares[SHARED].reason and np.isnan(entry.shares[OWN].value)
    assert entry.shares[CHANCE].numbers == (0.0, 0.0, 0.0)
    assert "c not integrated: its law is one of listed values" in entry.sentences


LISTED = {"distribution": "discrete-choice", "values": [0.5, 1.0, 2.0]}


RANKS = {"parameters": ["a", "z"], "rank_correlation": [[1.0, 0.7], [0.7, 1.0]]}


TRUNCATED = {"distribution": "uniform", "lower": 0.2, "upper": 3.0}


@pytest.mark.parametrize(
    ("uncertain", "tables"),
    [
        (SCALING, {"dependence": RANKS}),
        (SCALING | {"a": TRUNCATED}, {"dependence": RANKS}),
        (SCALING, {"dependence": RANKS | {"copula": "gumbel"}}),
        (SCALING | {"a": TRUNCATED | {"times": "c"}, "c": lognormal(0.4)}, {}),
        (SCALING | {"c": {"equals": "a"}}, {}),
    ],
    ids=["correlated", "correlated, another law", "gumbel", "multiple", "tied"],
)
def test_each_by_its_law_given_the_rest(uncertain, tables):
    """The plain shares of many rows lie in the intervals."""
    ds = scaled_result(uncertain=uncertain, tables=tables.items(), samples=4000)
    entry = by_level(Result(ds)).outputs["log(life)"]
    plain = by_level(Result(ds), plain=True).outputs["log(life)"]
    assert "a" in entry.integrated
    assert entry.variance == pytest.approx(plain.variance, rel=0.03)
    for level in (SHARED, OWN, CHANCE):
        share, other = entry.shares[level], plain.shares[level]
        assert share.value == pytest.approx(other.value, abs=other.high - other.low)
    assert sum(entry.shares[level].value for level in OF_LOG_LIFE) == pytest.approx(1.0)


def test_what_is_not_integrated_says_why():
    never = computed(scaled(tables={"settings": {"never_above": 1.0}}.items()))
    (name, entry), *_ = by_level(Result(never)).outputs.items()
    assert name == "rank(life)" and entry.integrated == ()
    assert "b and a and c not integrated: the lives are replaced by their ranks" in entry.sentences
    cut = computed(scaled(tables={"settings": {"horizon": 2.0}}.items()))
    assert "replaced by their ranks" in " ".join(
        by_level(Result(cut)).outputs["rank(life)"].sentences
    )


def test_replicates_are_what_is_independent_where_inputs_are_integrated():
    ds = computed(scaled(method="sobol", samples=32, replicates=8))
    shares = by_level(Result(ds)).outputs["log(life)"].shares
    total = sum(OF_LOG_LIFE.values())
    for level, variance in OF_LOG_LIFE.items():
        assert shares[level].low < variance / total < shares[level].high


def test_terminal_json_and_python_say_what_is_integrated(uq, tmp_path, monkeypatch):
    path = tmp_path / "scaled.nc"
    ds = scaled_result()
    ds.to_netcdf(path)
    entry = strict_json(uq("levels", path, "--json").out)["outputs"]["log(life)"]
    assert entry["integrated"] == ["b", "a", "c"]
    plain = strict_json(uq("levels", path, "--plain", "--json").out)["outputs"]["log(life)"]
    assert plain["integrated"] == []
    assert entry["own"]["high"] - entry["own"]["low"] < plain["own"]["high"] - plain["own"]["low"]
    shown = uq("levels", path).out
    assert "b and a and c integrated exactly" in shown
    assert "integrated" not in uq("levels", path, "--plain").out
    table = api.levels(ds)
    assert str(table["integrated"].values[0]) == "b a c"
    assert float(table["share"].sel(level=OWN)[0]) == entry["own"]["value"]
    assert str(api.levels(ds, plain=True)["integrated"].values[0]) == ""
