"""Levels: which rows share inputs and seeds, and what a design refuses."""

from dataclasses import replace

import numpy as np
import pytest
from computed import UNIFORM, computed, study_of
from nested_studies import LEVELS, nested, nested_result
from noisy_studies import noisy

from uq.errors import InputError
from uq.result.nesting import nesting_of, one_of_each_sample
from uq.result.result import Result
from uq.result.result_file import relabel
from uq.sampling.levels import coordinates, dimension
from uq.study.definition import what_changed
from uq.study.row_sampling import row_block, rows
from uq.study.schema import json_schema

NESTING = ("monte-carlo", "latin-hypercube", "sobol", "halton")


def varies(table, axis):
    return bool((np.ptp(table, axis=axis) > 0).all())


@pytest.mark.parametrize("method", NESTING)
@pytest.mark.parametrize("replicates", [1, 2])
def test_an_input_varies_on_its_level_alone(method, replicates):
    ds = computed(nested(method=method, replicates=replicates))
    place = nesting_of(ds)
    assert (place.samples, place.units, place.repeats) == (16 * replicates, 3, 2)
    assert ds.sizes["row"] == 16 * replicates * 3 * 2
    shared, unit_values, chance = (place.table(ds[name].values) for name in LEVELS)
    assert varies(shared[:, 0, 0], 0) and not np.ptp(shared, axis=(1, 2)).any()
    assert varies(unit_values[:, :, 0], 1) and not np.ptp(unit_values, axis=2).any()
    assert varies(chance, 2) and varies(chance, 1)
    assert [ds[name].attrs["level"] for name in LEVELS] == list(LEVELS.values())


@pytest.mark.parametrize("method", NESTING)
def test_each_row_of_a_sample_follows_the_laws(method):
    ds = computed(nested(method=method, samples=256))
    place = nesting_of(ds)
    for name in LEVELS:
        for place_in_sample in place.table(ds[name].values).reshape(256, -1).T:
            off = np.abs(np.sort(place_in_sample) - (np.arange(256) + 0.5) / 256).max()
            assert off < 1.95 / 16  # Kolmogorov's law: one in 1000


def test_a_sample_of_one_row_is_that_of_the_plain_design():
    plain = nested(levels=dict.fromkeys(LEVELS, "own"), units=1, repeats=1)
    level = nested(units=1, repeats=1)
    assert level.identity == plain.identity
    for column, other in zip(row_block(level, 0, 16), row_block(plain, 0, 16), strict=True):
        assert np.array_equal(column, other)
    assert "world" not in computed(level)


@pytest.mark.parametrize("method", ["monte-carlo", "sobol", "halton"])
def test_any_range_has_the_same_bits_and_samples_append(method):
    study = nested(method=method)
    whole = row_block(study, 0, rows(study))
    for start, stop in ((0, 1), (5, 6), (4, 17), (95, 96), (30, 30)):
        for column, part in zip(whole, row_block(study, start, stop), strict=True):
            assert np.array_equal(column[start:stop], part)
    longer = row_block(study.with_samples(32), 0, rows(study))
    for column, other in zip(whole, longer, strict=True):
        assert np.array_equal(column, other)


def test_each_row_has_a_seed_of_its_own():
    study = noisy("monte-carlo", 8, 2, units=3, repeats=4)
    seeds = row_block(study, 0, rows(study)).seed
    assert len(set(seeds.tolist())) == 8 * 2 * 3 * 4


def test_a_point_of_the_cube_gives_what_varies_and_no_more():
    places = coordinates(("shared", "own", "chance"), 3, 2)
    assert places[0].tolist() == [0, 1, 2]
    assert len(np.unique(places)) == dimension(("shared", "own", "chance"), 3, 2) == 1 + 3 + 6
    assert places.max() == 9
    assert dimension(("own", "own"), 1, 1) == 2


def test_the_identity_knows_levels_units_and_repeats():
    identities = {
        nested(**change).identity
        for change in ({}, {"units": 2, "repeats": 3}, {"units": 6, "repeats": 1})
    }
    other = nested(levels=LEVELS | {"x3": "own"})
    assert len(identities | {other.identity}) == 4
    changed = what_changed(nested().text, other.model.version, other)
    assert changed == '[uncertain.x3] level = "chance", now "own"'


def test_rows_of_a_sample_are_found_in_any_order():
    ds = nested_result()
    order = np.random.default_rng(0).permutation(ds.sizes["row"])[:50]
    place, some = nesting_of(ds), nesting_of(ds.isel(row=order))
    table, part = place.table(ds["y"].values), some.table(ds["y"].values[order])
    worlds = np.unique(place.sample[order])
    is_finite = np.isfinite(part)
    assert is_finite.sum() == 50
    assert np.array_equal(part[is_finite], table[worlds][is_finite])
    means = some.means(ds["y"].values[order])
    assert means == pytest.approx(np.nanmean(part.reshape(len(worlds), -1), axis=1))
    assert place.means(ds["y"].values, place.unit == 0) == pytest.approx(table[:, 0].mean(axis=1))
    assert one_of_each_sample(ds)["y"].values == pytest.approx(table[:, 0, 0])


def test_an_input_that_follows_another_has_its_level():
    study = nested(uncertain={"x4": {"equals": "x1"}})
    ds = computed(study)
    assert Result(ds).levels["x4"] == "shared" == ds["x4"].attrs["level"]
    assert np.array_equal(ds["x4"].values, ds["x1"].values)
    factor = {"distribution": "uniform", "lower": 0.5, "upper": 0.9, "times": "x1"}
    above_zero = {"x1": {"distribution": "uniform", "lower": 0.1, "upper": 1.0, "level": "shared"}}
    scaled = nested(uncertain=above_zero | {"x4": factor | {"level": "shared"}})
    table = nesting_of(ds).table(computed(scaled)["x4"].values)
    assert not np.ptp(table, axis=(1, 2)).any()


def test_dependent_inputs_of_one_level_keep_it():
    dependence = {"parameters": ["x1", "x4"], "rank_correlation": [[1.0, 0.9], [0.9, 1.0]]}
    study = study_of(
        {
            "study": {"name": "joined", "model": "linear"},
            "design": {"method": "monte-carlo", "samples": 200, "units": 3},
            "uncertain": dict.fromkeys(("x1", "x4"), UNIFORM | {"level": "shared"})
            | {"x2": UNIFORM},
            "dependence": dependence,
        }
    )
    ds = computed(study)
    values, other = (nesting_of(ds).table(ds[name].values)[:, :, 0] for name in ("x1", "x4"))
    assert not np.ptp(values, axis=1).any() and not np.ptp(other, axis=1).any()
    assert np.corrcoef(values[:, 0], other[:, 0])[0, 1] > 0.8


SHARED, OWN = UNIFORM | {"level": "shared"}, UNIFORM
FACTOR = {"distribution": "uniform", "lower": 0.5, "upper": 0.9, "times": "x1"}
POSITIVE = {"distribution": "uniform", "lower": 0.1, "upper": 1.0, "level": "shared"}
PAIR = {"parameters": ["x1", "x2"], "rank_correlation": [[1.0, 0.5], [0.5, 1.0]]}


@pytest.mark.parametrize(
    ("tables", "line"),
    [
        (
            {"design": {"method": "saltelli"}},
            "[design] units = 3: a sample of a 'saltelli' design has no units; use method ="
            " 'monte-carlo' or 'latin-hypercube' or 'sobol' or 'halton'",
        ),
        (
            {"design": {"method": "morris", "units": 1, "repeats": 2}},
            "[design] repeats = 2: a sample of a 'morris' design has no repeats; use method =",
        ),
        (
            {"design": {"method": "sobol", "units": 40_000}},
            "[design] units = 40000: a sample then draws 40001 numbers, and a point of a 'sobol'"
            " design has at most 21201; use method = 'monte-carlo'",
        ),
        (
            {"design": {"units": 2000, "repeats": 2000}},
            "[design] units = 2000: units x repeats must be at most 1000000: 4000000",
        ),
        ({"design": {"units": 0}}, "[design] units = 0: must be at least 1"),
        (
            {"uncertain": {"x1": UNIFORM | {"level": "sharde"}}},
            "[uncertain.x1] level = \"sharde\": no such level; did you mean 'shared'? (allowed:"
            " shared, own, chance)",
        ),
        (
            {"uncertain": {"x4": {"equals": "x1", "level": "own"}}},
            "[uncertain.x4] equals = \"x1\": is on the level 'shared', and 'x4' on 'own': 'equals'"
            " joins inputs of one level; give 'x4' level = \"shared\"",
        ),
        (
            {"uncertain": {"x1": POSITIVE, "x4": FACTOR}},
            "[uncertain.x4] times = \"x1\": is on the level 'shared', and 'x4' on 'own': 'times'"
            " joins inputs of one level; give 'x4' level = \"shared\"",
        ),
        (
            {"dependence": PAIR},
            "[dependence] parameters: must be inputs of one level: x1 is shared, x2 is own",
        ),
        (
            {"analysis": {"tolerance": {"coverage": 0.95, "confidence": 0.95}}},
            "[analysis] tolerance = {coverage = 0.95, confidence = 0.95}: refused: its confidence"
            " assumes independent rows, and the units and repeats of one sample are not; set both"
            " to 1, or leave it out",
        ),
        (
            {"analysis": {"twin": {"fail_above": 3.0}}},
            "[analysis] twin = {fail_above = 3.0}: needs independent rows, and the units and"
            " repeats of one sample are not; set both to 1, or leave it out",
        ),
    ],
)
def test_what_several_rows_of_a_sample_rule_out_is_refused(tables, line):
    base = {
        "study": {"name": "refused", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 16, "units": 3},
        "uncertain": {"x1": SHARED, "x2": OWN},
    }
    whole = {name: base.get(name, {}) | tables.get(name, {}) for name in (base | tables)}
    with pytest.raises(InputError) as refused:
        study_of(whole)
    assert [message.removeprefix("study: ")[: len(line)] for message in refused.value.lines] == [
        line
    ]


def test_a_level_may_change_where_no_row_depends_on_it():
    first, other = (
        nested(levels=LEVELS | {"x1": x}, units=1, repeats=1) for x in ("own", "shared")
    )
    ds = computed(first)
    assert relabel(ds, other)["y"].equals(ds["y"])
    seeded = replace(other, design=other.design.model_copy(update={"seed": 6}))
    assert "level" not in what_changed(first.text, first.model.version, seeded)


def test_an_extended_run_equals_one_from_the_start(uq, tmp_path):
    import uq as api

    path = tmp_path / "nested.toml"
    path.write_text(nested().text)
    short, long = tmp_path / "short.nc", tmp_path / "long.nc"
    assert uq("run", path, "-o", short, "--workers", "0", "--chunk-rows", "7").code == 0
    assert uq("extend", short, "--samples", "24", "--workers", "0").code == 0
    path.write_text(nested(samples=24).text)
    assert uq("run", path, "-o", long, "--workers", "0").code == 0
    extended, whole = api.open_result(short), api.open_result(long)
    assert extended.drop_attrs().equals(whole.drop_attrs())
    assert extended.attrs["samples"] == 24
    assert uq("verify", short).code == 0


def test_the_schema_allows_units_where_a_design_has_them():
    rules = {}
    for rule in json_schema()["allOf"]:
        names = rule["if"]["properties"].get("design")
        if names:
            table = rule["then"]["properties"]["design"]["properties"]
            rules[names["properties"]["method"]["const"]] = table
    assert {name for name, table in rules.items() if "units" not in table} == set(NESTING)
    assert rules["saltelli"]["repeats"] == {"const": 1}
