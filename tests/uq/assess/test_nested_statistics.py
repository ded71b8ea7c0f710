"""Statistics of samples with several rows rest on samples, or are refused with the reason."""

import numpy as np
import pytest
from computed import asking, compared, computed, linear, summarised, with_output
from nested_studies import nested, nested_result, regimes

import uq as api
from uq.assess.pairing import Pairing, pairing
from uq.assess.sampled_laws import drawn_inputs, laws_and_values
from uq.assess.sensitivities import ONE_ROW, sensitivities
from uq.assess.statistics.moments import between_share
from uq.assess.stopping import interim_estimate
from uq.assess.survival import survival
from uq.errors import InputError
from uq.result.elements import dependence_of
from uq.result.nesting import one_of_each_sample
from uq.result.result import Result
from uq.stats.dependent_rows import Dependence, linearised_means
from uq.stats.intervals import mean_interval, share_interval
from uq.stats.moments import sd_interval
from uq.stats.order_statistics import quantile_interval

SHARED_ALONE = {"x1": "shared"}


def doubled(values, times=5):
    """Return values as if each sample had so many equal rows."""
    return np.repeat(values, times), samples_of(len(values), times)


def samples_of(count, times):
    """Return the dependence of so many samples of so many rows each."""
    return Dependence(np.repeat(np.arange(count), times), samples=count, are_samples=True)


def test_equal_rows_say_no_more_than_one():
    values = np.random.default_rng(0).exponential(size=200)
    many, of = doubled(values)
    assert mean_interval(many, of) == pytest.approx(mean_interval(values))
    for p in (0.1, 0.5):
        ends = quantile_interval(many, p, of)
        alone = quantile_interval(values, p)
        assert ends[1] - ends[0] == pytest.approx(alone[1] - alone[0], rel=0.3)
    ends, alone = sd_interval(many, of), sd_interval(values)
    assert ends[1] - ends[0] == pytest.approx(alone[1] - alone[0], rel=0.25)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 1.0])
def test_a_share_counts_samples_not_rows(share):
    hits = np.arange(200) < share * 200
    many, of = doubled(hits)
    ends, alone = share_interval(many, of), share_interval(hits)
    assert ends[1] - ends[0] >= 0.98 * (alone[1] - alone[0])
    assert ends == pytest.approx(alone, abs=0.02)


def test_rows_that_differ_as_much_as_samples_count_fully():
    rng = np.random.default_rng(0)
    of = samples_of(500, 4)
    hits = rng.random(2000) < 0.3
    ends, rows = share_interval(hits, of), share_interval(hits)
    assert ends[1] - ends[0] == pytest.approx(rows[1] - rows[0], rel=0.15)


def test_unequal_samples_pull_by_their_rows():
    values, of = np.array([1.0, 1.0, 4.0]), np.array([0, 0, 2])
    assert linearised_means(values, of) == pytest.approx([2 / 3, 10 / 3])
    assert linearised_means(values[[0, 2]], of[[0, 2]]).tolist() == [1.0, 4.0]


def test_groups_hold_whole_samples():
    of = samples_of(300, 3)
    groups = of.groups()
    assert len(np.unique(groups)) == 32
    assert all(len(np.unique(groups[of.labels == sample])) == 1 for sample in range(300))
    sizes = np.unique(groups, return_counts=True)[1]
    assert np.ptp(sizes) <= 3
    assert Dependence(np.arange(5)).groups().tolist() == [0, 1, 2, 3, 4]


def test_what_depends_on_the_sample_alone_has_the_interval_of_the_samples():
    ds = nested_result(levels=SHARED_ALONE, samples=200, analysis={"thresholds": {"y": [5.0]}})
    alone = one_of_each_sample(ds)
    assert not Result(ds).has_independent_rows and dependence_of(ds).are_samples
    statistics = summarised(ds)["outputs"]["y"]
    mean = statistics["mean_interval"]
    assert (mean["low"], mean["high"]) == pytest.approx(mean_interval(alone["y"].values))
    above = statistics["thresholds"]["5.0"]["above"]
    assert above["low"] < 0.5 < above["high"]
    assert above["high"] - above["low"] > 0.13  # Wilson's of 1200 rows is 0.056 wide
    assert any(
        "(200 samples of 3 units, 2 repeats of each): intervals are computed from samples" in note
        for note in summarised(ds)["notes"]
    )


def test_an_even_design_needs_replicates():
    single = summarised(nested_result(method="sobol"))
    assert single["outputs"]["y"]["mean_interval"] == {"low": None, "high": None}
    assert any("set replicates = 8" in note for note in single["notes"])
    several = summarised(nested_result(method="sobol", replicates=8))
    assert several["outputs"]["y"]["mean_interval"]["low"] is not None


def test_indices_come_from_one_row_of_each_sample():
    ds = nested_result(samples=300)
    sensitivity_result = sensitivities(Result(ds))
    assert sensitivity_result.rows_used == 300
    assert ONE_ROW in sensitivity_result.targets["y"].indices.notes
    few = sensitivities(Result(nested_result(samples=16))).targets["y"]
    assert few.refused.endswith(ONE_ROW)


def test_no_band_and_no_fit_of_rows_that_depend():
    ds = nested_result(samples=100)
    life = np.exp(ds["y"].values)
    lives = asking(with_output(ds, "life", life, "lifetime", life > 300), outputs=["life"])
    curve = survival(lives, "life")
    assert np.isnan(curve["band_low"]).all() and curve.attrs["band"].startswith("none")
    middle = curve.sel(time=np.median(life), method="ffill")
    assert middle["low"] < 0.5 < middle["high"]
    fits = summarised(lives, fits=True)["outputs"]["life"]["fits"]
    assert all("one row a sample" in fit["refused"] for fit in fits.values())


def test_curves_of_equal_rows_are_as_wide_as_those_of_samples():
    ds = nested_result(levels=SHARED_ALONE, samples=512)
    times = len(ds["y"]) // 512
    rng = np.random.default_rng(0)
    life, left = rng.exponential(size=512), rng.exponential(size=512)
    seen, cut = np.minimum(life, left), life > left
    curves = [
        survival(asking(with_output(dataset, "life", *column), outputs=["life"]), "life")
        for dataset, column in (
            (ds, (np.repeat(seen, times), "lifetime", np.repeat(cut, times))),
            (linear(samples=512), (seen, "lifetime", cut)),
        )
    ]
    for time in (0.3, 1.0, 1.5):
        wide, narrow = (
            float(at["high"] - at["low"])
            for at in (curve.sel(time=time, method="ffill") for curve in curves)
        )
        assert wide == pytest.approx(narrow, rel=0.3)


def test_studies_with_one_seed_are_not_paired_row_by_row():
    ds, other = nested_result(), nested_result(seed=6)
    assert pairing(Result(ds), Result(other)) is Pairing.INDEPENDENT
    assert pairing(Result(ds), Result(ds)) is Pairing.ROWS_SAME
    assert pairing(Result(ds), Result(nested_result(samples=32))) is Pairing.UNKNOWN
    assert pairing(Result(ds), Result(linear(seed=5))) is Pairing.UNKNOWN
    even = nested_result(method="sobol", replicates=4)
    assert pairing(Result(even), Result(even)) is Pairing.REPLICATES
    difference = compared(ds, other)["outputs"]["y"]["mean"]["difference"]
    assert difference["low"] < 0 < difference["high"]


def test_a_run_stops_by_intervals_of_samples():
    until = {"output": "y", "half_width": 0.01}
    study = nested(levels=SHARED_ALONE, samples=64, units=8, until=until)
    ds = computed(study)
    estimate = interim_estimate(study.design, Result(ds)).estimate
    alone = mean_interval(one_of_each_sample(ds)["y"].values)  # at the only check
    assert (estimate.low, estimate.high) == pytest.approx(alone)


def test_inputs_are_compared_with_their_laws_by_one_row_of_each_sample():
    ds = nested_result()
    assert [len(values) for _, values in laws_and_values(Result(ds)).values()] == [16, 16, 16]
    assert [len(values) for values in drawn_inputs(nested()).values()] == [16, 16, 16]


def test_regimes_are_described_by_their_own_rows():
    ds = nested_result(samples=100)
    codes = (ds["x1"].values > 0.7).astype(np.int8)
    ds = regimes(ds, codes)
    statistics = summarised(ds)
    wild = statistics["regime"]["wild"]
    hits = codes[:: len(codes) // 100]
    low, high = share_interval(hits > 0)
    assert (wild["low"], wild["high"]) == pytest.approx((low, high), abs=0.01)
    table = api.regimes(ds)
    assert table["distance"].sel(regime="wild", parameter="x1") == 1.0
    assert table["distance_dummy"].max() > 0.1  # of 100 rows, not of 600


def test_a_damaged_nesting_is_refused():
    from uq.result.result_file import check

    ds = nested_result()
    for fault in (
        ds.assign_coords(unit=("row", ds["unit"].values + 1)),
        ds.assign_coords(world=("row", -ds["world"].values)),
        ds.drop_vars("repeat"),
        ds.assign_attrs(units_per_sample=0),
        ds.assign_attrs(repeats=10**9),
    ):
        with pytest.raises(InputError, match="not a sound result"):
            check(fault)
    check(ds)


def test_the_variance_between_regimes_has_no_interval():
    ds = nested_result(samples=100)
    share = between_share(ds["y"].values, (ds["x1"].values > 0.5).astype(int), dependence_of(ds))
    assert 0 < share.value < 1 and not share.has_interval
