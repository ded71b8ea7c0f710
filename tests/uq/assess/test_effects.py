"""Average effects: slopes that are known, directions that are not claimed, shares over an input."""

import numpy as np
import pytest

from uq.assess.effects import effects, event_curve
from uq.stats.dependent_rows import Dependence

RNG = np.random.default_rng(5)


def test_the_slope_of_a_power_law_is_its_exponent():
    x = RNG.lognormal(0.0, 0.3, (500, 2))
    noise = 0.1 * x[:, 0] * RNG.normal(size=500)
    slopes = effects(np.log(x[:, 0] ** -2 * x[:, 1]) + noise, {"a": x[:, 0], "b": x[:, 1]})
    assert slopes["a"].logarithmic and slopes["a"].direction == -1 and slopes["b"].direction == 1
    assert slopes["a"].slope.low < -2 < slopes["a"].slope.high
    assert slopes["b"].slope.low < 1 < slopes["b"].slope.high


def test_an_effect_that_turns_has_no_direction():
    x = RNG.uniform(-np.pi, np.pi, 2000)
    (sine,) = effects(np.sin(x), {"x": x}).values()
    (cosine,) = effects(np.cos(x), {"x": x}).values()
    assert sine.slope.low > 0 and sine.turns and sine.direction == 0
    assert cosine.direction == 0
    (bent,) = effects(np.exp(x), {"x": x}).values()
    assert not bent.turns and bent.direction == 1


def test_an_input_without_effect_has_no_direction():
    x, noise = RNG.normal(size=(2, 400))
    (slope,) = effects(noise, {"x": x}).values()
    assert slope.slope.low < 0 < slope.slope.high and slope.direction == 0


def test_rows_that_agree_count_once():
    x = np.repeat(RNG.normal(size=100), 10)
    y = x + np.repeat(RNG.normal(size=100), 10)
    (alone,) = effects(y, {"x": x}).values()
    samples = Dependence(np.repeat(np.arange(100), 10), samples=100, are_samples=True)
    (together,) = effects(y, {"x": x}, samples).values()
    wide, narrow = (slope.slope.high - slope.slope.low for slope in (together, alone))
    assert wide == pytest.approx(10**0.5 * narrow, rel=0.1)


def test_few_rows_and_inputs_that_repeat_have_no_effects():
    x = RNG.normal(size=15)
    assert effects(x, {"x": x}) == {}
    x = RNG.normal(size=200)
    assert effects(x, {"x": x, "same": x}) == {}
    assert effects(np.ones(200), {"x": x}) == {}


def test_the_probability_over_an_input_is_the_share_in_each_part():
    x = RNG.uniform(size=1200)
    hits = (RNG.uniform(size=1200) < x).astype(float)
    hits[:10] = np.nan
    curve = event_curve(hits, x)
    assert len(curve.shares) == 12 and (curve.least, curve.most) == (0, 11)
    for low, high, estimate in zip(curve.edges, curve.edges[1:], curve.shares, strict=False):
        inside = (x >= low) & (x <= high) & np.isfinite(hits)
        assert estimate.value == pytest.approx(hits[inside].mean(), abs=0.02)
        assert estimate.low < (low + high) / 2 + 0.1 and estimate.high > (low + high) / 2 - 0.1
    assert curve.around(3) == tuple(curve.edges[3:5])
    whole = event_curve((x > 0.5).astype(float), x)
    assert whole.around(whole.most)[0] == pytest.approx(0.5, abs=0.1) == whole.around(0)[1]
    assert event_curve(hits[:40], x[:40]) is None
    assert event_curve(hits, np.ones(1200)) is None


def test_each_of_few_values_is_a_part_of_its_own():
    x = np.repeat([1.0, 2.0, 3.0, 5.0], [600, 300, 95, 5])
    hits = np.where(x == 3.0, 1.0, 0.0)
    curve = event_curve(hits, x)
    assert curve.edges.tolist() == [1, 1.5, 2.5, 5]  # few rows of a value go with the next
    assert [share.value for share in curve.shares] == [0, 0, 0.95] and not curve.of_values
    assert event_curve(hits[:995], x[:995]).of_values


def test_parts_of_whole_numbers_end_between_them():
    x = np.random.default_rng(0).integers(0, 50, 3000).astype(float)
    curve = event_curve((x >= 20).astype(float), x)
    inner = curve.edges[1:-1]
    assert (inner % 1 == 0.5).all() and len(curve.shares) >= 9 and not curve.of_values
    for low, high, estimate in zip(curve.edges, curve.edges[1:], curve.shares, strict=False):
        inside = (x > low) & (x < high) | (x == low) & (low == 0)
        assert estimate.value == pytest.approx((x[inside] >= 20).mean(), abs=0.1)
