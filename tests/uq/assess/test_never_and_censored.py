"""Lives that may never end, known at once, and lives that are censored: both in one output."""

import numpy as np
import pytest
from computed import asking, compared, kinds, linear, summarised, with_output
from scipy import stats

import uq
from models.analytic import EXPONENTIAL_WEAR
from models.beam import MODEL as BEAM
from models.vibrator import MODEL as VIBRATOR
from uq.assess.survival import survival
from uq.contract import Output

ENDS = 0.4
TIME = 1.5
TRUTH = ENDS * stats.weibull_min(2).cdf(TIME)


def mixed(n, seed=1):
    """Return lives of which 60 % never end, known at once; the others may be censored."""
    rng = np.random.default_rng(seed)
    life = np.where(rng.random(n) < ENDS, rng.weibull(2.0, n), np.inf)
    leaving = np.where(np.isinf(life), np.inf, rng.exponential(1.0, n))
    return np.minimum(life, leaving), leaving < life


def result(values, censored, known_at_once=True, method="monte-carlo", replicates=1):
    ds = linear(method, samples=len(values) // replicates, replicates=replicates)
    ds = with_output(ds, "life", values, "lifetime", censored)
    ds["life"].attrs["never_known_at_once"] = int(known_at_once)
    return asking(ds, thresholds={"life": TIME})


def below(ds):
    return summarised(ds)["outputs"]["life"]["thresholds"][repr(TIME)]["kaplan_meier"]["below"]


def test_a_censored_row_is_not_one_that_never_ends():
    ds = result(*mixed(40_000))
    probability = below(ds)
    assert probability["value"] == pytest.approx(TRUTH, abs=0.012)
    assert probability["low"] < TRUTH < probability["high"]
    curve = survival(ds, "life").sel(time=TIME, method="ffill")
    assert float(curve["survival"]) == pytest.approx(1 - probability["value"])
    assert probability["high"] - probability["low"] == pytest.approx(
        float(curve["high"] - curve["low"]), rel=1e-9
    )


def test_b_lives_are_those_of_the_rows_that_end():
    entry = summarised(result(*mixed(20_000)))["outputs"]["life"]["b_lives"]["B10"]
    expected = stats.weibull_min(2).ppf(0.1 / ENDS)
    assert entry["value"] == pytest.approx(expected, rel=0.03)
    assert entry["low"] < expected < entry["high"]


def test_where_never_is_learnt_late_a_row_that_never_ends_stays_at_risk():
    values, censored = mixed(4000)
    late = below(result(values, censored, known_at_once=False))
    left = np.where(np.isinf(values), values[np.isfinite(values)].max(), values)
    ended = ~censored & np.isfinite(values)
    seen = stats.CensoredData(uncensored=values[ended], right=left[~ended])
    assert late["value"] == pytest.approx(1 - float(stats.ecdf(seen).sf.evaluate(TIME)))
    assert late["value"] < 0.25 < TRUTH


def test_without_censored_rows_the_band_is_that_of_all_rows_alike():
    values = np.where(np.arange(500) % 5 < 3, np.inf, np.random.default_rng(3).weibull(2.0, 500))
    bands = [
        survival(result(values, np.zeros(500), is_known_at_once), "life")
        for is_known_at_once in (True, False)
    ]
    for name in ("survival", "low", "high"):
        np.testing.assert_allclose(bands[0][name], bands[1][name], rtol=1e-9)


def test_without_rows_that_never_end_the_band_is_greenwoods():
    rng = np.random.default_rng(4)
    life, leaving = rng.weibull(2.0, 200), rng.exponential(1.0, 200)
    curve = survival(result(np.minimum(life, leaving), leaving < life), "life")
    is_over = leaving >= life
    seen = stats.CensoredData(uncensored=life[is_over], right=leaving[~is_over])
    estimate = stats.ecdf(seen).sf
    with pytest.warns(RuntimeWarning, match="undefined"):
        band = estimate.confidence_interval(method="log-log")
    # Where few have ended, or are left, the band is exact instead.
    times = curve["time"].values[(curve["survival"] > 0.2) & (curve["survival"] < 0.9)]
    inner = curve.sel(time=times)
    np.testing.assert_allclose(inner["survival"], estimate.evaluate(times), rtol=1e-12)
    np.testing.assert_allclose(inner["low"], band.low.evaluate(times), rtol=1e-9)
    np.testing.assert_allclose(inner["high"], band.high.evaluate(times), rtol=1e-9)


def test_each_replicate_has_its_own_share_that_ends():
    values, censored = mixed(4096, seed=5)
    probability = below(result(values, censored, True, "latin-hypercube", 8))
    assert probability["value"] == pytest.approx(TRUTH, abs=0.04)
    assert probability["low"] < TRUTH < probability["high"] < probability["low"] + 0.1


def test_a_replicate_in_which_no_row_ends_has_survived():
    values = np.r_[np.full(16, np.inf), np.arange(1.0, 17.0)]
    curve = survival(result(values, np.r_[np.zeros(20), np.ones(12)], True, "sobol", 2), "life")
    assert float(curve["survival"][0]) == pytest.approx(31 / 32)
    assert np.isfinite(curve["survival"]).all()


def test_an_end_that_censored_rows_might_have_outlived_has_no_band():
    values = np.r_[np.full(10, np.inf), np.arange(1.0, 11.0)]
    curve = survival(result(values, np.arange(20) == 12), "life")
    assert float(curve["survival"][-1]) == 0.5 and np.isnan(float(curve["low"][-1]))
    assert np.isfinite(curve["low"][1:-1]).all()


def test_two_results_are_compared_by_the_same_estimate():
    first, other = (result(*mixed(4000, seed)) for seed in (1, 2))
    other.attrs["seed"] = first.attrs["seed"] + 1
    threshold = compared(first, other)["outputs"]["life"]["thresholds"][repr(TIME)]
    probability = threshold["below"]
    for which, ds in (("a", first), ("b", other)):
        assert (
            probability[which]["value"] == below(ds)["value"]
            and "censoring" in probability[which]["assumes"]
        )
    apart = probability["difference"]
    assert apart["value"] == pytest.approx(probability["b"]["value"] - probability["a"]["value"])
    assert apart["low"] < 0 < apart["high"] < 0.08
    assert threshold["above"]["difference"]["value"] == pytest.approx(-apart["value"])


def test_machines_say_whether_never_is_known_at_once(tmp_path):
    assert Output("s", "a life", "lifetime").never_known_at_once
    assert EXPONENTIAL_WEAR.outputs["life"].never_known_at_once
    for machine in (BEAM, VIBRATOR):
        lives = [output for output in machine.outputs.values() if output.has_censored_flag]
        assert lives and not any(life.never_known_at_once for life in lives)
    ds = kinds()
    assert ds["life"].attrs["never_known_at_once"] == 1
    assert "never_known_at_once" not in ds["work"].attrs
    # A file from before outputs said so is read as its numbers were then.
    del ds["life"].attrs["never_known_at_once"]
    ds.to_netcdf(tmp_path / "old.nc")
    assert uq.open_result(tmp_path / "old.nc")["life"].attrs["never_known_at_once"] == 0
