"""A band that holds the whole survival curve."""

import numpy as np
import pytest
from computed import asking, linear, with_output
from scipy import stats

from uq.analysis.lifetime import survival
from uq.drawing.distribution_plots import lifetime

LAW = stats.weibull_min(2.0)


def curve_of(values, censored=None, **design):
    rows = len(values) // design.get("replicates", 1)
    ds = linear(samples=rows, **design)
    ds = asking(with_output(ds, "life", values, "lifetime", censored), outputs=["life"])
    return survival(ds, "life")


def seen(seed, rows, never, censored):
    """Return lives, some never ending and known to, and which of them are censored."""
    rng = np.random.default_rng(seed)
    life = LAW.rvs(rows, random_state=rng)
    ends = rng.random(rows) >= never
    left = rng.exponential(1.5, rows) if censored else np.inf
    return np.where(ends, np.minimum(life, left), np.inf), ends & (left < life)


def test_of_a_complete_sample_it_is_kolmogorovs():
    values, _ = seen(0, 100, 0.3, censored=False)
    curve = curve_of(values)
    half = stats.kstwo.ppf(0.95, 100)
    inside = (curve["band_low"] > 0) & (curve["band_high"] < 1)
    wide = (curve["band_high"] - curve["band_low"])[inside]
    np.testing.assert_allclose(wide, 2 * half)


@pytest.mark.slow
@pytest.mark.parametrize("never", [0.0, 0.6])
def test_it_holds_the_whole_curve_of_censored_rows(never):
    held = 0
    for seed in range(150):
        curve = curve_of(*seen(seed, 80, never, censored=True))
        time = curve["time"].values
        known = np.isfinite(curve["band_low"].values)
        truth = never + (1 - never) * LAW.sf(time)
        low, high = curve["band_low"].values, curve["band_high"].values
        inside = (low <= truth) & (truth <= high)
        before = (low[:-1] <= truth[1:]) & (truth[1:] <= high[:-1])  # until just before a step
        held += inside[known].all() and before[known[:-1] & known[1:]].all()
    assert 0.90 <= held / 150 <= 0.99


def test_it_is_wider_than_the_pointwise_interval_where_both_are():
    curve = curve_of(*seen(3, 400, 0.2, censored=True)).dropna("time")
    middle = curve.isel(time=(curve["survival"] > 0.4).values & (curve["survival"] < 0.9).values)
    assert (middle["band_low"] <= middle["low"]).all()
    assert (middle["band_high"] >= middle["high"]).all()


def test_it_ends_where_few_rows_are_at_risk():
    values, censored = seen(4, 100, 0.0, censored=True)
    curve = curve_of(values, censored)
    assert np.isnan(curve["band_low"].values[-5:]).all()
    assert np.isfinite(curve["band_low"].values[:50]).all()


def test_rows_that_are_not_independent_have_none_and_say_so():
    values, _ = seen(5, 128, 0.0, censored=False)
    curve = curve_of(values, method="latin-hypercube", replicates=8)
    assert np.isnan(curve["band_low"]).all() and "independent" in curve.attrs["band"]


def test_without_ends_there_is_none():
    for values, censored in ((np.full(30, 7.0), np.ones(30)), (np.full(30, np.nan), None)):
        assert np.isnan(curve_of(values, censored)["band_low"]).all()


def test_the_figure_shows_both_and_says_which_is_which():
    values, censored = seen(6, 200, 0.2, censored=True)
    ds = asking(with_output(linear(samples=200), "life", values, "lifetime", censored))
    axes = lifetime(ds, "life").axes[0]
    title = " ".join(axes.get_title(loc="left").split())
    assert "pointwise 95 % band" in title and "light: simultaneous band" in title
    assert len(axes.collections) >= 2
