"""A band that holds the whole survival curve."""

import numpy as np
import pytest
from computed import asking, linear, with_output
from scipy import stats

from uq.assess.survival import survival
from uq.render.figures.distribution_plots import lifetime

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


def holds(curve, truth):
    """Return whether a band contains a curve, also just before each of its steps."""
    true = truth(curve["time"].values)
    low, high = curve["band_low"].values, curve["band_high"].values
    outside = (true < low) | (true > high)  # false where there is none
    return not (outside.any() or (true[1:] < low[:-1]).any())


@pytest.mark.parametrize("never", [0.0, 0.3])
def test_of_a_complete_sample_it_is_exact(never):
    values, _ = seen(0, 100, never, censored=False)
    curve = curve_of(values)
    ended = curve.sizes["time"]
    share = np.sort(np.random.default_rng(1).random((20_000, 100)))  # that has ended at each end
    outside = (share[:, :ended] < 1 - curve["band_high"].values).any(axis=1)
    before_next = share[:, 1 : ended + 1]
    most = 1 - curve["band_low"].values[: before_next.shape[1]]
    outside |= (before_next > most).any(axis=1)
    assert outside.mean() == pytest.approx(0.05, abs=0.008)


@pytest.mark.slow
@pytest.mark.parametrize("never", [0.0, 0.6])
def test_it_holds_the_whole_curve_of_censored_rows(never):
    held = 0
    for seed in range(300):
        curve = curve_of(*seen(seed, 80, never, censored=True))
        held += holds(curve, lambda time: never + (1 - never) * LAW.sf(time))
    assert 0.93 <= held / 300 <= 0.98


@pytest.mark.slow
@pytest.mark.parametrize(("scale", "share"), [(0.45, 0.8), (0.28, 0.89)])
def test_it_holds_the_whole_curve_where_most_rows_are_censored(scale, share):
    rng, held, censored = np.random.default_rng(7), 0, []
    for _ in range(300):
        life, left = LAW.rvs(200, random_state=rng), rng.exponential(scale, 200)
        censored.append(np.mean(left < life))
        held += holds(curve_of(np.minimum(life, left), left < life), LAW.sf)
    assert np.mean(censored) == pytest.approx(share, abs=0.02)
    assert 0.93 <= held / 300 <= 0.985


def test_it_is_wider_than_the_pointwise_interval_where_both_are():
    curve = curve_of(*seen(3, 400, 0.2, censored=True)).dropna("time")
    middle = curve.isel(time=(curve["survival"] > 0.4).values & (curve["survival"] < 0.9).values)
    assert (middle["band_low"] <= middle["low"]).all()
    assert (middle["band_high"] >= middle["high"]).all()


def test_it_is_open_downwards_where_no_row_is_left():
    values, censored = seen(4, 100, 0.0, censored=True)
    curve = curve_of(values, censored)
    assert np.isfinite(curve["band_low"]).all() and np.isfinite(curve["band_high"]).all()
    assert float(curve["band_low"][-1]) == 0.0 < float(curve["band_high"][-1])


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
    dark, light = axes.collections[:2]
    assert (dark.get_label(), light.get_label()) == ("pointwise 95 % band", "simultaneous band")
    assert dark.get_alpha() > light.get_alpha()
