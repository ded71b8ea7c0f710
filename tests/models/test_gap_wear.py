"""The wear of one gap takes the times of its closed forms, and of a second integrator."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.gap_wear.batch import batch
from models.gap_wear.declarations import SCARS, GapWearParameters, GapWearSettings

YEAR = 31_557_600.0
DEPTH = 4.36e-4


def lives(accuracy=1e-4, rows=None, **choices):
    """Return the outputs of rows, or of the nominal row."""
    rows = [GapWearParameters()] if rows is None else rows
    settings = GapWearSettings(**({"accuracy": accuracy, "depths": (DEPTH,)} | choices))
    outputs, status, _ = batch(np.array(rows), np.zeros(len(rows), np.uint64), settings)
    assert not status.any()
    return outputs


def shape(scar, p):
    """Return B and p of a scar."""
    flat = 4 / 3 * p.support_width * math.sqrt(2 * p.rod_radius)
    return {
        "prismatic": (p.contact_area, 1.0),
        "flat-bar": (flat, 1.5),
        "dimple": (math.pi * math.sqrt(p.rod_radius * p.support_radius), 2.0),
        "inclined": (8 * math.sqrt(2 * p.rod_radius) / (15 * p.support_inclination), 2.5),
    }[scar]


@pytest.mark.parametrize("scar", SCARS)
@pytest.mark.parametrize("kappa", [0.0, 3.0])
def test_a_constant_work_rate_wears_a_volume(scar, kappa):
    p = GapWearParameters(support_wear_ratio=kappa, support_inclination=0.5)
    factor, power = shape(scar, p)
    known_time = (1 + kappa) ** (power - 1) * factor * DEPTH**power
    known_time /= p.wear_coefficient * p.work_rate
    found_time = lives(scar=scar, rows=[p])["time_to_depth"][0, 0]
    assert found_time == pytest.approx(known_time, rel=1e-12)


def test_a_flat_bar_in_a_plant_takes_twelve_years():
    assert lives(scar="flat-bar")["time_to_depth"][0, 0] / YEAR == pytest.approx(12.177, abs=1e-3)


def test_a_bar_that_is_worn_over_its_width_wears_a_prism():
    p = GapWearParameters(support_inclination=0.01)  # the width times the angle is below the depth
    factor, power = shape("inclined", p)
    tilt = p.support_inclination * p.support_width
    volume = factor * (DEPTH**power - (DEPTH - tilt) ** power)
    found_time = lives(scar="inclined", rows=[p])["time_to_depth"][0, 0]
    known_time = volume / (p.wear_coefficient * p.work_rate)
    assert found_time == pytest.approx(known_time, rel=1e-10)


def orders(errors):
    """Return the orders in the length of steps, which follows the root of the accuracy."""
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


ACCURACIES = [1e-2, 2.5e-3, 6.25e-4, 1.5625e-4]


@pytest.mark.parametrize("m", [2.0, 3.0, 5.0])
@pytest.mark.parametrize("kappa", [0.0, 2.0])
def test_wear_that_feeds_itself_is_of_second_order(m, kappa):
    p = GapWearParameters(exponent=m, support_wear_ratio=kappa)
    a = (1 + kappa) * p.wear_coefficient * p.work_rate / (p.contact_area * p.initial_gap)
    gap = 1 + (1 + kappa) * DEPTH / p.initial_gap
    known_time = (1 - gap ** (1 - m)) / ((m - 1) * a)
    outputs = [lives(accuracy, rows=[p]) for accuracy in ACCURACIES]
    errors = np.array([out["time_to_depth"][0, 0] - known_time for out in outputs])
    bounds = np.array([out["time_to_depth_error"][0, 0] for out in outputs])
    assert (np.abs(errors) <= bounds).all() and (bounds < 20 * np.abs(errors)).all()
    assert (np.abs(errors) < known_time * np.array(ACCURACIES)).all()
    np.testing.assert_allclose(orders(errors)[1:], 2, atol=0.3)


def test_creep_and_wear_feed_each_other():
    p = GapWearParameters(exponent=1.0, creep_down=6e-5)
    a = p.wear_coefficient * p.work_rate / (p.contact_area * p.initial_gap)
    errors = []
    for accuracy in ACCURACIES:
        out = lives(accuracy, rows=[p], growths=(DEPTH,))
        t = out["time_to_gap_growth"][0, 0]
        rise = p.creep_down / p.creep_time / (a + 1 / p.creep_time)
        gap = p.initial_gap * math.exp(a * t)
        gap += rise * (math.exp(a * t) - math.exp(-t / p.creep_time))
        errors.append(gap / (p.initial_gap + DEPTH) - 1)
        assert abs(errors[-1]) < accuracy
    np.testing.assert_allclose(orders(np.array(errors))[1:], 2, atol=0.3)


def test_a_preloaded_gap_opens_or_never_does():
    p = GapWearParameters(preload_deflection=5e-5, creep_down=4e-5, relaxed_share=0.25)
    path = p.creep_down + (1 - p.relaxed_share) * 5e-5
    out = lives(rows=[p])
    known_time = -p.creep_time * math.log(1 - 5e-5 / path)
    assert out["time_to_opening"][0] == pytest.approx(known_time, rel=1e-12)
    assert known_time < out["time_to_depth"][0, 0] < np.inf
    held = lives(rows=[p._replace(creep_down=1.2e-5)])  # less than the share that remains
    assert held["time_to_opening"][0] == held["time_to_depth"][0, 0] == np.inf
    assert not held["time_to_opening_censored"][0]
    unworn = lives(rows=[p._replace(wear_coefficient=0.0)])
    assert unworn["time_to_opening"][0] == pytest.approx(known_time, rel=1e-12)
    assert unworn["time_to_depth"][0, 0] == np.inf


def test_a_time_beyond_the_horizon_is_censored():
    out = lives(horizon=1e8)
    assert out["time_to_depth"][0, 0] == 1e8 and out["time_to_depth_censored"][0, 0]
    assert np.isnan(out["time_to_depth_error"][0, 0])


def test_a_second_integrator_agrees():
    """Rows drawn at random, with prismatic scars, against scipy's DOP853."""
    rng = np.random.default_rng(7)
    rows = [
        GapWearParameters(
            initial_gap=2e-4,
            preload_deflection=rng.choice([0.0, 3e-5]),
            relaxed_share=0.2,
            exponent=rng.uniform(0, 3),
            wear_coefficient=1e-14 * 10 ** rng.uniform(-0.5, 0.5),
            support_wear_ratio=rng.uniform(0, 2),
            creep_down=rng.uniform(3e-5, 6e-5),
            creep_time=rng.uniform(2e7, 8e7),
            relaxation_time=rng.uniform(2e7, 8e7),
        )
        for _ in range(30)
    ]
    out = lives(accuracy=1e-4, rows=rows)
    for i, p in enumerate(rows):
        opened, ended = out["time_to_opening"][i], out["time_to_depth"][i, 0]

        def gap(t, h, p=p):
            relaxed = p.preload_deflection * (1 - p.relaxed_share)
            grown = -p.creep_down * np.expm1(-t / p.creep_time)
            new = -p.preload_deflection if p.preload_deflection > 0 else p.initial_gap
            return new + h + grown - relaxed * np.expm1(-t / p.relaxation_time)

        def rate(t, h, p=p, gap=gap):
            worn = (1 + p.support_wear_ratio) * p.wear_coefficient * p.work_rate / p.contact_area
            return worn * (np.maximum(gap(t, h), 0.0) / p.initial_gap) ** p.exponent

        if p.preload_deflection > 0:
            assert abs(gap(opened, 0.0)) < 1e-15
        else:
            assert opened == 0

        def deep(t, h, p=p):
            return h[0] - (1 + p.support_wear_ratio) * DEPTH

        deep.terminal = True
        span = (opened, 2 * ended)
        solved = solve_ivp(rate, span, [0.0], "DOP853", events=deep, rtol=1e-11, atol=1e-16)
        known_time = solved.t_events[0][0]
        assert abs(ended - known_time) <= out["time_to_depth_error"][i, 0] + 1e-9 * known_time
        assert ended == pytest.approx(known_time, rel=3e-4)
