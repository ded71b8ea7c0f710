import numpy as np
import pytest
from asked_indices import sensitivities
from computed import asking, kinds, linear, summarised, with_output, with_status
from scipy import stats

import uq
from uq.assess.statistics.moments import between_share
from uq.contract import Status
from uq.errors import InputError
from uq.indices.given_data import DUMMIES
from uq.stats.dependent_rows import Dependence


def test_inputs_of_a_regime_are_distinguished_from_those_of_the_rest():
    # The regime is slow for x1 < 0.5, of x1 in [0.01, 0.99], and x2 plays no part.
    ds = kinds(samples=512, analysis={"outputs": ["work", "regime"]})
    table = uq.regimes(ds)
    assert list(table["regime"].values) == ["slow", "fast"]
    slow = table.sel(regime="slow")
    assert float(slow["distance"].sel(parameter="x1")) == 1.0
    assert float(slow["distance"].sel(parameter="x2")) < float(slow["distance_dummy"])
    quantiles = slow["input_quantile"].sel(parameter="x1")
    expected = 0.01 + 0.49 * quantiles["probability"].values
    assert quantiles.values == pytest.approx(expected, abs=0.05)
    hits = ds["x1"].values <= 0.5
    assert int(slow["count"]) == hits.sum()
    wilson = stats.binomtest(int(hits.sum()), 512).proportion_ci(method="wilson")
    assert (float(slow["share_low"]), float(slow["share_high"])) == pytest.approx(tuple(wilson))
    left = slow.sel(output="work[side=left]")
    assert float(left["mean"]) == pytest.approx(ds["x1"].values[hits].mean())
    assert float(left["sd"]) == pytest.approx(ds["x1"].values[hits].std(ddof=1))


def test_labels_say_what_the_codes_mean():
    ds = with_status(kinds(), slice(3), Status.TIMED_OUT)
    words = uq.labels(ds["regime"])
    assert words.dims == ("row",)
    assert list(words.values) == ["slow" if x <= 0.5 else "fast" for x in ds["x1"].values]
    assert words.attrs["long_name"] == ds["regime"].attrs["long_name"]
    assert list(uq.labels(ds["status"][2:4]).values) == ["timed-out", "ok"]
    with pytest.raises(InputError, match="'angle' is not a category"):
        uq.labels(ds["angle"])


def test_regional_distance_is_scipys_and_its_dummies_share_its_null():
    ds = kinds(samples=256, analysis={"outputs": ["regime"]})
    entry = sensitivities(ds, "regional")["outputs"]["P(regime=fast)"]
    hits = ds["x1"].values > 0.5
    expected = stats.ks_2samp(ds["x2"].values[hits], ds["x2"].values[~hits]).statistic
    assert entry["KS"]["x2"]["value"] == pytest.approx(expected)
    # The largest of 19 lies about the 95 % quantile of the law of the distance.
    rng, n = np.random.default_rng(3), int(hits.sum())
    null = [
        stats.ks_2samp(draws[:n], draws[n:], method="asymp").statistic
        for draws in rng.random((400, 256))
    ]
    assert DUMMIES == 19
    assert np.quantile(null, 0.6) < entry["dummy"]["KS"] < np.quantile(null, 0.999)


def test_regional_needs_an_event():
    with pytest.raises(InputError, match="needs an event"):
        sensitivities(linear(samples=128), "regional")
    refused = sensitivities(linear(samples=128), "regional", "y")["outputs"]["y"]["refused"]
    assert "not an event" in refused
    y = linear(samples=128)["y"].values
    ds = asking(with_output(linear(samples=128), "life", y, "lifetime"), thresholds={"life": 5.0})
    outputs = sensitivities(ds, "regional")["outputs"]
    assert list(outputs) == ["P(life<5.0)"]
    assert outputs["P(life<5.0)"]["KS"]["x4"]["value"] > outputs["P(life<5.0)"]["dummy"]["KS"]


def test_sobol_indices_of_a_regime_are_those_of_its_indicator():
    ds = kinds("saltelli", 128, 8)
    entry = sensitivities(ds, output="P(regime=fast)")["outputs"]["P(regime=fast)"]
    assert entry["ST"]["x1"]["value"] == pytest.approx(1.0, abs=0.02)
    assert entry["ST"]["x2"]["value"] == 0.0


def test_variance_between_regimes():
    # Of a uniform input cut at its middle, three quarters of the variance lie between the halves.
    for design, replicates in (("monte-carlo", 1), ("latin-hypercube", 8), ("saltelli", 8)):
        entry = summarised(kinds(design, 128, replicates))["outputs"]["work[side=left]"]
        split = entry["between_regimes"]
        assert split["low"] < 0.75 < split["high"], design
        assert split["value"] == pytest.approx(0.75, abs=0.06)
    assert "between_regimes" not in summarised(linear())["outputs"]["y"]


def test_variance_between_regimes_of_noise_has_no_interval():
    rng = np.random.default_rng(0)
    y, codes = rng.normal(size=300), rng.integers(0, 3, 300)
    split = between_share(y, codes)
    assert abs(split.value) < 0.03 and np.isnan((split.low, split.high)).all()
    # By hand: 1, 2 | 4, 6 has means 1.5 and 5, variance 59/16, of which 49/16 between.
    four, pairs = np.array([1.0, 2.0, 4.0, 6.0]), np.array([0, 0, 1, 1])
    assert between_share(four, pairs, Dependence(np.zeros(4, int))).value == pytest.approx(49 / 59)
    # Of independent rows, less what chance makes of it: 1 - (10/59) 3/2.
    assert between_share(four, pairs).value == pytest.approx(44 / 59)
    for y, codes in (([1.0, 1.0, 1.0, 1.0], [0, 0, 1, 1]), ([1.0, 2.0], [0, 0]), ([], [])):
        share = between_share(np.array(y), np.array(codes, dtype=int))
        assert np.isnan(share.numbers).all()


def test_variance_may_lie_between_regimes_alone():
    codes = np.repeat([0, 1, 2], 40)
    for noise in (1e-13, 1e-11, 1e-9):  # of the size of rounding errors, and larger
        y = (codes + 1) / 3 + noise * np.random.default_rng(0).normal(size=120)
        assert between_share(y, codes).value == pytest.approx(1.0)


def test_variance_between_regimes_is_as_uncertain_as_the_jackknife_finds_it():
    rng, n = np.random.default_rng(4), 400
    codes = rng.integers(0, 3, n)
    y = rng.exponential(size=n) * (1 + codes) + codes

    def root(share):
        return np.arctanh(np.sqrt(share))

    split = between_share(y, codes)
    error = (root(split.high) - root(split.low)) / 2 / stats.norm.ppf(0.975)
    without = [root(between_share(np.delete(y, i), np.delete(codes, i)).value) for i in range(n)]
    assert error == pytest.approx(np.std(without) * np.sqrt(n - 1), rel=0.05)


def test_statistics_within_a_regime():
    ds = kinds(samples=400)
    fast = ds["x1"].values > 0.5
    statistics = summarised(ds, regime="fast")
    assert statistics["rows_used"] == fast.sum() and statistics["regime"]["slow"]["count"] == 0
    work = statistics["outputs"]["work[side=left]"]
    assert work["mean"] == pytest.approx(ds["x1"].values[fast].mean())
    # A failed row without a regime may have belonged to this one: it counts as failed.
    ds["work"][3] = np.nan
    ds["regime"][3] = -1
    ds = with_status(ds, 3, Status.NON_FINITE)
    for name in ("fast", "slow"):
        assert summarised(ds, regime=name)["outputs"]["work[side=left]"]["failed"] == 1


def test_indices_within_a_regime_assume_no_independent_inputs():
    ds = kinds(samples=400, analysis={"outputs": ["work"]})
    sensitivity_result = sensitivities(ds, regime="fast")
    assert (
        sensitivity_result["method"] == "delta"
        and sensitivity_result["rows_used"] == (ds["x1"].values > 0.5).sum()
    )
    entry = sensitivity_result["outputs"]["work[side=left]"]
    assert entry["delta"]["x1"]["value"] > entry["dummy"]["delta"] > 0
    with pytest.raises(InputError, match="within a regime the inputs depend on each other"):
        sensitivities(ds, "rbd-fast", regime="fast")
    with pytest.raises(InputError, match="assumes independent inputs"):
        sensitivities(kinds("saltelli", 64, 4), regime="fast")


def test_regimes_that_are_not_there():
    with pytest.raises(InputError, match="no such regime 'fats'; did you mean 'fast'"):
        summarised(kinds(), regime="fats")
    with pytest.raises(InputError, match="has no regimes"):
        summarised(linear(), regime="fast")
    with pytest.raises(InputError, match="has no regimes"):
        uq.regimes(linear())
    slow = kinds(samples=64)
    slow = slow.isel(row=slow["regime"].values == 0)
    with pytest.raises(InputError, match="no row is in the regime 'fast'"):
        summarised(slow, regime="fast")
