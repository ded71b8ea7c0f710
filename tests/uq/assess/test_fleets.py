"""Fleets of units that share a world, against closed forms and brute force."""

import numpy as np
import pytest
from command_line import strict_json
from computed import asking, linear, with_output
from fleet_studies import LISTED, SHARED, brute_force, fleet_result, fleet_study, lognormal

import uq as api
from benchmarks.coverage import fleets as counted
from uq.assess.fleet import fleet_facts, fleet_of
from uq.assess.fleet_units import units_of
from uq.assess.random_effects import ONE_UNIT, DeconvolvedProbability
from uq.assess.summary_table import summary
from uq.errors import InputError
from uq.files.whole_files import write_result
from uq.result.elements import elements_of
from uq.result.result import Result
from uq.stats.counting import at_most
from uq.stats.dependent_rows import INDEPENDENT


@pytest.mark.parametrize(("size", "allow"), [(1, 0), (3, 0), (3, 1), (3, 5), (6, 2), (7, 0)])
def test_the_mean_over_all_fleets(size, allow):
    ended = np.random.default_rng(0).random((4, 7, 2))
    ended[1, 2] = ended[2, :3] = np.nan
    for numbers in (ended, np.where(np.isnan(ended), np.nan, np.round(ended))):
        expected = [[brute_force(world[:, k], size, allow) for k in (0, 1)] for world in numbers]
        assert at_most(numbers, size, allow) == pytest.approx(
            np.array(expected), abs=1e-13, nan_ok=True
        )


def test_many_worlds_are_computed_in_blocks(monkeypatch):
    ended = np.random.default_rng(0).random((50, 8, 1))
    whole = at_most(ended, 5, 1)
    monkeypatch.setattr("uq.stats.counting._MOST_NUMBERS", 100)
    assert at_most(ended, 5, 1) == pytest.approx(whole, abs=1e-15)


def test_lives_as_computed_where_nothing_is_to_be_integrated():
    ds = fleet_result(units=6, samples=50)
    fleet = fleet_of(Result(ds), 5, [5e5], allow=1, plain=True)
    assert fleet.integrated == ()
    element = next(elements_of(ds, ["life"]))
    ended = (element.values < 5e5).astype(float).reshape(50, 6, 1)
    assert fleet.by[5e5][1].estimate.value == pytest.approx(at_most(ended, 5, 1).mean())
    with pytest.raises(InputError, match="set units = 7; .* depth is not"):
        fleet_of(Result(ds), 7, plain=True)


def test_no_power_of_the_mean():
    """Units of a sample agree: the mean of powers is not the power of the mean."""
    by_time = fleet_of(Result(fleet_result()), 50, [5e5]).by[5e5]
    p = by_time[0].estimate.value / 50
    assert by_time[1].estimate.value > 2 * (1 - p) ** 50


def test_repeats_are_chance_within_a_unit():
    """The number of a unit is the mean of its repeats."""
    laws = {"depth": LISTED, "threshold": lognormal(1.0, 1e-10, level="chance")}
    ds = fleet_result(units=3, samples=40, design={"repeats": 4}.items(), **laws)
    element = next(elements_of(ds, ["life"]))
    ended = units_of(Result(ds), element).ended(5e5)
    assert ended.shape == (40, 3, 1)
    assert ended[..., 0] == pytest.approx(element.below(5e5).reshape(40, 3, 4).mean(axis=2))
    estimate = fleet_of(Result(ds), 2, [5e5]).by[5e5][1].estimate
    pairs = [brute_force(world, 2, 0) for world in ended[..., 0]]
    assert estimate.value == pytest.approx(np.mean(pairs))


def test_points_over_what_is_shared_state_what_they_assume():
    """Where units are only counted; not where the probability is known in each world."""
    counted_units = fleet_of(Result(fleet_result(units=4, samples=100, depth=LISTED)), 4, [5e5])
    sentence = "the 5 and 95 % points assume probits of the units' probabilities are about normal"
    assert any(note.startswith(sentence) for note in counted_units.notes)
    for estimate in counted_units.by[5e5]:
        assert estimate.low.assumes and estimate.high.assumes and not estimate.estimate.assumes
    assert counted_units.first[0.5].high.assumes
    entry = fleet_facts(counted_units).json["by"]["500000.0"]["failed"]
    assert "about normal" in entry["band_low_assumes"] and "assumes" not in entry
    table = api.fleet(fleet_result(units=4, samples=100, depth=LISTED), 4, by=5e5)
    of_numbers = table["assumes"].loc[["failed", "at_most_allowed"]]
    assert all("about normal" in text for text in of_numbers)
    assert not any(api.fleet(fleet_result(), 4, by=5e5)["assumes"])
    fleet = fleet_of(Result(fleet_result()), 4, [5e5])
    assert not any("assume" in note for note in fleet.notes)


def test_a_narrow_interval_comes_with_what_it_covers():
    for shares in (True, False):
        law = lognormal(0.5, 1e-9, level="shared" if shares else "own")
        fleet = fleet_of(Result(fleet_result(units=3, rate=law)), 3, [5e5])
        (note,) = (note for note in fleet.notes if "cover sampling only" in note)
        assert ("what all units of a fleet share" in note) == shares
        assert ("level = 'shared'" in note) == (not shares)


def test_a_fleet_of_one_is_a_unit():
    ds = fleet_result()
    fleet = fleet_of(Result(ds), 1, [5e5])
    table = summary(ds).loc["life"]
    assert fleet.first[0.5].estimate.value == pytest.approx(table["q0.5"], rel=1e-9)


def test_more_units_than_there_are_is_refused():
    ds = fleet_result(units=3, samples=30, depth=LISTED)
    with pytest.raises(InputError, match="set units = 4; .* depth is not") as refused:
        fleet_of(Result(ds), 4)
    assert str(refused.value).count("\n") == 0
    assert fleet_of(Result(ds), 3).samples == 30


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"size": 0}, "at least 1"),
        ({"size": 1, "allow": -1}, "at least 0"),
        ({"size": 1, "by": [-1.0]}, "not a time"),
        ({"size": 1, "by": [np.inf]}, "not a time"),
        ({"size": 1, "output": "rate"}, "no such output"),
    ],
)
def test_mistakes_are_sentences(options, words):
    with pytest.raises(InputError, match=words):
        fleet_of(Result(fleet_result()), **options)


def test_a_horizon_before_the_time_is_refused():
    ds = fleet_result(units=3, samples=30, depth=LISTED)
    life = ds["life"].values
    cut = with_output(ds, "life", np.minimum(life, 1e6), "lifetime", life > 1e6)
    with pytest.raises(InputError, match="censored before 2000000.0 s"):
        fleet_of(Result(cut), 2, [2e6])
    fleet = fleet_of(Result(cut), 3, [9e5])
    assert (
        fleet.by[9e5][1].estimate.value == fleet_of(Result(ds), 3, [9e5]).by[9e5][1].estimate.value
    )


@pytest.mark.slow
def test_failed_rows_are_taken_at_best_and_at_worst():
    ds = fleet_result(units=4, samples=100, depth=LISTED)
    status, life = ds["status"].values.copy(), ds["life"].values.copy()
    status[::40], life[::40] = 1, np.nan
    lost = ds.assign(status=ds["status"].copy(data=status), life=ds["life"].copy(data=life))
    fleet = fleet_of(Result(lost), 4, [5e5])
    assert fleet.samples == 90
    assert any("10 of 400 rows are invalid" in note for note in fleet.notes)
    failed, kept = fleet.by[5e5]
    whole = fleet_of(Result(ds), 4, [5e5]).by[5e5]
    for number, truth in zip((failed, kept), whole, strict=True):
        assert number.failed.low < number.estimate.low < number.estimate.high < number.failed.high
        assert number.failed.low < truth.estimate.value < number.failed.high
    first = fleet.first[0.5]
    assert first.failed.low <= first.estimate.low < first.estimate.high <= first.failed.high


def test_no_more_than_the_fleet_can_end():
    kept = fleet_of(Result(fleet_result(units=4, samples=100, depth=LISTED)), 4, [5e5], allow=4)
    for number in (kept.by[5e5][1].estimate, kept.by[5e5][1].low, kept.by[5e5][1].high):
        assert number.numbers == (1.0, 1.0, 1.0) and not number.assumes


def test_nothing_shared_has_no_band():
    ds = fleet_result(rate=lognormal(SHARED, 1e-9))
    assert (
        fleet_of(Result(ds), 1, [5e5]).by[5e5][0].low.reason == "samples share nothing that varies"
    )


def test_a_few_shared_values_have_no_points_between_them():
    listed = {"distribution": "discrete-choice", "values": [1e-9, 2e-9], "level": "shared"}
    both = {"rate": listed, "depth": LISTED}
    (failed, _) = fleet_of(Result(fleet_result(units=10, **both)), 1, [5e5]).by[5e5]
    assert np.isfinite(failed.estimate.value)
    assert "one of a few values" in failed.low.reason == failed.high.reason
    band = fleet_of(Result(fleet_result(units=10, rate=listed)), 1, [5e5]).by[5e5][0]
    assert band.low.value < band.high.value  # each probability is known


def test_the_noise_of_units_is_no_spread():
    """Samples that differ by the luck of their units alone have no band."""
    rng = np.random.default_rng(3)
    ended = (rng.random((100, 10, 1)) < 0.3).astype(float)
    spread = DeconvolvedProbability(ended, np.ones(1), INDEPENDENT)
    if not spread.refusal:
        assert spread(0.45).value < 0.05 and spread(0.15).value > 0.95
    single = DeconvolvedProbability(ended[:, :1], np.ones(1), INDEPENDENT)
    assert single.refusal == ONE_UNIT


def test_python_terminal_json_and_report_agree(uq, tmp_path, no_other_figures):
    path, result = tmp_path / "fleet.toml", tmp_path / "fleet.nc"
    path.write_text(fleet_study(units=2, samples=40).text)
    assert uq("run", path, "-o", result, "--workers", "0").code == 0
    table = api.fleet(api.open_result(result), 100, by=4e5, allow=2)
    document = strict_json(
        uq("fleet", result, "--size", "100", "--by", "4e5", "--allow", "2", "--json").out
    )
    assert (document["size"], document["allow"]) == (100, 2)
    entry = document["by"]["400000.0"]["at_most_allowed"]
    line = table.loc["at_most_allowed"]
    for name in ("value", "low", "high", "band_low", "band_high"):
        assert entry[name] == pytest.approx(line[name])
    assert document["first"]["quantiles"]["0.5"]["value"] > 0
    assert document["by"]["400000.0"]["failed"]["value"] == pytest.approx(
        table.loc["failed"]["value"]
    )
    shown = uq("fleet", result, "--size", "100", "--by", "4e5", "--allow", "2").out
    assert "P(at most 2 have ended)" in shown and "depth integrated exactly" in shown
    assert max(map(len, shown.splitlines())) <= 80
    assert uq("report", result, "-o", tmp_path / "page.html").code == 0
    assert "Fleets of 2 units" in (tmp_path / "page.html").read_text()


@pytest.mark.parametrize("law", list(counted.LAWS))
def test_bands_of_counted_units_hold_whatever_the_law_over_samples(law):
    lines = counted.other_laws(law, 4)
    ends = [line for line in lines if "of samples" in line.what]
    assert len(ends) == 2
    assert all(line.held >= 3 and line.given == 4 for line in ends)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(counted.CASES))
def test_intervals_of_fleets_hold_the_truth(name):
    assert [line for line in counted.fleets(name, 200) if line.unexplained] == []


def test_units_whose_life_ends_in_success_have_succeeded(uq, folder):
    ds = with_output(linear(samples=64), "start", np.linspace(1.0, 5.0, 64), "lifetime")
    ds["start"].attrs["success"] = "the motors have locked"
    write_result(asking(ds, outputs=["start"]), folder / "out.nc")
    shown = uq("fleet", "out.nc", "--size", "1", "--by", "3000 ms").out
    assert "the first of 1 has succeeded" in shown and "by 3000 ms" in shown
    assert "have succeeded" in shown and "ended" not in shown
    refused = uq("fleet", "out.nc", "--size", "1", "--by", "3 kg")
    assert (refused.code, refused.out) == (2, "")
    assert refused.err.startswith("--by 3 kg: the unit 'kg' does not fit 'a life'")
