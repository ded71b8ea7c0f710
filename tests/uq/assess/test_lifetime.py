import numpy as np
import pytest
from computed import asking, kinds, linear, summarised, with_output
from scipy import stats

import uq
from uq.assess.survival import survival
from uq.errors import InputError


def lives(values, censored=None, method="monte-carlo", replicates=1):
    ds = linear(method, samples=len(values) // replicates, replicates=replicates)
    return with_output(ds, "life", values, "lifetime", censored)


def test_without_censored_rows_it_is_the_share_still_alive():
    values = np.random.default_rng(1).exponential(size=50)
    curve = survival(lives(values), "life")
    assert list(curve["time"].values) == sorted(values)
    assert curve["survival"].values == pytest.approx(1 - np.arange(1, 51) / 50)
    assert int(curve["rows"]) == 50 and int(curve["censored"]) == 0
    assert uq.survival is survival


def test_censored_rows_leave_the_risk_set():
    # Klein, Moeschberger, "Survival analysis", 2nd ed. (2003), table 4.1A: 6-MP group, remission.
    ended = [6, 6, 6, 7, 10, 13, 16, 22, 23]
    left = [6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35]
    censored = np.r_[np.zeros(9), np.ones(12)]
    curve = survival(lives(np.r_[ended, left], censored), "life").sel(time=sorted(set(ended)))
    published = [0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448]
    assert curve["survival"].values == pytest.approx(published, abs=6e-4)
    # The same book, table 4.4: log-transformed 95 % interval at 10 months.
    at = curve.sel(time=10)
    assert (float(at["low"]), float(at["high"])) == pytest.approx((0.503, 0.889), abs=2e-3)


def test_where_few_rows_are_at_risk_their_number_counts():
    # Twenty rows leave before the first of the other ten ends: a sample of ten is what is left.
    values = np.r_[np.ones(20), np.arange(2.0, 12.0)]
    curve = survival(lives(values, values == 1), "life")
    for time in range(2, 11):
        at = curve.sel(time=time)
        exact = stats.binomtest(11 - time, 10).proportion_ci(method="exact")
        assert (float(at["low"]), float(at["high"])) == pytest.approx(exact, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("scale", [0.05, 0.4])
def test_survival_where_few_rows_are_left_is_not_overstated(scale):
    # 60 rows of which most leave early: Greenwood's lower end is above the truth in up to 47 %.
    rng, missed, given, time = np.random.default_rng(8), 0, 0, 1.2
    for _ in range(300):
        life, left = rng.weibull(2.0, 60), scale * rng.weibull(0.5, 60)
        curve = survival(lives(np.minimum(life, left), left < life), "life")
        at = curve.sel(time=slice(None, time))
        if at.sizes["time"] and np.isfinite(low := float(at["low"][-1])):
            given += 1
            missed += low > np.exp(-(time**2))
    assert given > 100
    assert missed <= 0.04 * given


def test_rows_that_never_end_make_the_plateau():
    values = np.r_[np.arange(1.0, 61.0), np.full(40, np.inf)]
    curve = survival(lives(values), "life")
    assert curve["survival"][-1] == pytest.approx(0.4) and float(curve["never"]) == 0.4
    assert curve["time"].values.max() == 60 and int(curve["censored"]) == 0
    assert float(curve["low"][-1]) < 0.4 < float(curve["high"][-1])
    expected = stats.binomtest(40, 100).proportion_ci(method="wilson")
    assert float(curve["low"][-1]) == pytest.approx(expected.low, abs=0.01)


def test_what_was_censored_is_not_known_never_to_end():
    ds = lives(np.full(16, np.inf), np.arange(16) < 5)
    entry = summarised(ds)["outputs"]["life"]
    assert (entry["never"], entry["censored"]) == (11, 5)


def test_curve_agrees_with_the_thresholds_of_the_summary():
    ds = asking(lives(np.random.default_rng(2).exponential(size=80)), thresholds={"life": 0.7})
    above = summarised(ds)["outputs"]["life"]["thresholds"]["0.7"]["above"]["value"]
    at = survival(ds, "life").sel(time=0.7, method="ffill")
    assert float(at["survival"]) == pytest.approx(above)


@pytest.mark.parametrize("method", ["latin-hypercube", "sobol", "saltelli"])
def test_other_designs_take_the_band_from_replicates(method):
    ds = linear(method, samples=64, replicates=8)
    ds = with_output(ds, "life", ds["y"].values, "lifetime")
    curve = survival(ds, "life").sel(time=5.0, method="ffill")
    ends = ds.isel(row=np.isin(ds["block"], [0, 5] if method == "saltelli" else [0]))
    shares = (ends["life"] > 5).groupby(ends["replicate"]).mean().values
    half = stats.t.ppf(0.975, 7) * stats.sem(shares)
    assert float(curve["high"] - curve["low"]) == pytest.approx(2 * half, rel=0.05)
    assert float(curve["low"]) < 0.5 < float(curve["high"])
    alone = linear(method, samples=64)
    alone = survival(with_output(alone, "life", alone["y"].values, "lifetime"), "life")
    assert np.isnan(alone["low"]).all() and not np.isnan(alone["survival"]).any()


def test_band_is_never_of_zero_width():
    curve = survival(lives(np.r_[np.full(10, 1.0), np.full(40, 2.0)]), "life")
    assert curve["survival"].values == pytest.approx([0.8, 0.0])
    assert np.isnan(curve["low"][-1]) and np.isnan(curve["high"][-1])
    ds = linear("sobol", samples=64, replicates=4)
    ds = with_output(ds, "life", np.where(ds["x1"] < 0.5, 1.0, 2.0), "lifetime")
    assert np.isnan(survival(ds, "life")["low"][0])  # each replicate has exactly half of its rows


def test_elements_of_an_output_share_their_times():
    ds = kinds(samples=100)
    whole = survival(ds, "life")
    assert whole["survival"].dims == ("side", "depth", "time")
    assert whole["rows"].dims == ("side", "depth")
    part = survival(ds, "life[side=right,depth=1.5]")
    assert part["survival"].dims == ("time",) and part["depth"].item() == 1.5
    same = whole.sel(side="right", depth=1.5).sel(time=part["time"])
    assert same["survival"].values == pytest.approx(part["survival"].values)
    x1 = ds["x1"].values
    assert int(part["censored"]) == (x1 > 0.8).sum()
    assert float(part["never"]) == pytest.approx((x1 < 0.2).mean())


def test_rows_without_a_life_take_no_part():
    values = np.r_[np.arange(1.0, 21.0), np.full(5, np.nan)]
    ds = lives(values)
    curve = survival(ds, "life")
    assert int(curve["undefined"]) == 5 and int(curve["rows"]) == 20
    assert curve["survival"][-1] == 0
    ds["status"][20:] = 3
    assert int(survival(ds, "life")["failed"]) == 5


def test_degenerate_results_have_a_curve_all_the_same():
    never = survival(lives(np.full(20, np.inf)), "life")
    assert never.sizes["time"] == 0 and float(never["never"]) == 1
    gone = survival(lives(np.full(20, np.nan)), "life")
    assert gone.sizes["time"] == 0 and np.isnan(gone["never"])
    held = survival(lives(np.full(20, 7.0), np.ones(20)), "life")
    assert held["survival"].values == [1.0] and np.isnan(held["low"].values)


@pytest.mark.parametrize(
    ("output", "sentence"),
    [
        ("work", "'work' is not a lifetime"),
        ("lief", "no such output 'lief'; did you mean 'life'"),
        ("life[side=left]", "no such element"),
    ],
)
def test_what_is_not_a_lifetime_is_refused(output, sentence):
    with pytest.raises(InputError, match=sentence):
        survival(kinds(), output)


def test_a_curve_that_ends_while_a_replicate_is_censored_has_no_band_there():
    values = np.arange(1.0, 17.0)
    censored = np.zeros(16)
    censored[-2] = 1  # the last row of one replicate is censored, that of the other ends
    curve = survival(lives(values, censored, "latin-hypercube", replicates=2), "life")
    assert float(curve["survival"][-1]) == 0.0 and np.isnan(float(curve["high"][-1]))


@pytest.mark.parametrize("method", ["monte-carlo", "latin-hypercube"])
def test_survival_is_exact_where_few_have_ended(method):
    replicates = 1 if method == "monte-carlo" else 4
    blank = linear(method, samples=200 // replicates, replicates=replicates)
    rng, too_low, repetitions = np.random.default_rng(2), 0, 150
    for _ in range(repetitions):
        life = rng.exponential(size=200)
        ds = with_output(blank, "life", np.maximum(life, 1e-6), "lifetime")
        curve = uq.survival(ds, "life")
        seen = curve["high"].values[curve["time"].values <= 0.0007]  # 0.14 ends expected
        too_low += bool(len(seen)) and bool(seen[-1] < np.exp(-0.0007))
    assert too_low <= 0.05 * repetitions  # Greenwood's: 0.13
