"""Data for the paper's figures: known work-rates, lives and changes, and sound labels."""

import numpy as np
import pytest

from models.beam.explore import (
    bifurcation_diagram,
    continue_orbit,
    follow_wear,
    phase_portrait,
    wear_history,
    work_rate_against_gap,
)
from models.beam.explore.diagram import upcrossing_rates
from models.beam.parameters import Params, Settings

X0 = 2.5e-4
FIRST, SECOND = 32.3591, 57.1042  # omega = 5.61 and 9.900


@pytest.fixture(scope="module")
def first():
    """The first case, to twice the gap."""
    return wear_history(Params(forcing_frequency=FIRST), Settings(depths=(X0,)), 8192)


def all_labelled(ds):
    return all(v.attrs["units"] and v.attrs["long_name"] for v in ds.data_vars.values())


def test_a_history_begins_with_the_settled_response_and_reaches_the_known_life(first):
    assert all_labelled(first)
    assert first.gap[0].values == pytest.approx(X0)
    assert sorted(first.mean_work[0].values) == pytest.approx([3.394367, 3.919359], rel=2e-3)
    assert (first.gap.diff("look") >= 0).all()
    worn = first.gap.max("site")
    assert np.interp(2 * X0, worn, first.dimensionless_time) == pytest.approx(0.380, rel=0.06)
    assert (first.gap_ratio == first.gap.sel(site="left") / first.gap.sel(site="right")).all()
    watt = 13750.0 * X0**2 * 2 * np.pi * 5.768
    assert first.work_rate.values == pytest.approx(first.mean_work.values * watt, rel=1e-3)


def test_time_and_its_dimensionless_form_say_the_same(first):
    ratio = (first.time / first.dimensionless_time)[1:]
    unit = 4e-6 / (1e-14 * 13750.0 * X0 * 2 * np.pi * 5.768)
    assert ratio.values == pytest.approx(unit, rel=1e-3)


def test_the_branches_lost_are_events_with_their_gaps(first):
    symmetric, lost = (first.isel(regime_change=k) for k in (0, 1))
    assert (symmetric.change_from, symmetric.change_to) == (
        "period-1-asymmetric",
        "period-1-symmetric",
    )
    assert symmetric.change_gap.values / X0 == pytest.approx(1.18, abs=0.04)
    assert (lost.change_from, lost.change_to) == ("period-1-symmetric", "aperiodic")
    assert 1.45 < lost.change_gap.max() / X0 < 1.65  # lost at 1.45, left some time later
    at = np.interp(lost.change_time, first.time, first.gap.sel(site="right"))
    assert at == pytest.approx(lost.change_gap.sel(site="right"))


def test_a_history_with_unequal_wear_coefficients_wears_one_site_more():
    p = Params(forcing_frequency=54.797, wear_coefficient_ratio=2.0)
    ds = wear_history(p, Settings(depths=(0.2 * X0,)), 4096)
    assert (ds.gap.sel(site="left")[1:] > ds.gap.sel(site="right")[1:]).all()
    grown, work = ds.gap.diff("look"), ds.mean_work[1:]
    assert (2 * grown / grown.sum("site"))[-1].values == pytest.approx([2 / 3, 4 / 3], rel=0.1)
    assert np.isfinite(work).all()


def test_looks_too_short_to_tell_a_regime_are_refused():
    with pytest.raises(ValueError, match="128 looks of 32 periods need more than 4000 periods"):
        wear_history(Params(), Settings(), 4000)


def test_work_rates_at_gaps_that_do_not_wear_are_those_of_the_branch():
    gaps = np.linspace(1, 1.4, 9) * X0
    p = Params(forcing_frequency=54.797)
    ds = work_rate_against_gap(p, Settings(), gaps)
    assert all_labelled(ds)
    assert ds.mean_work[0].values == pytest.approx([32.3639, 32.3639], rel=2e-3)
    swept = work_rate_against_gap(p, Settings(), gaps[:3], "up")
    assert swept.work_rate.values == pytest.approx(ds.work_rate[:3].values, rel=3e-3)
    assert (ds.regime == "period-1-symmetric").all() and (ds.period == 1).all()


def test_sweeping_up_and_down_leads_to_different_responses():
    gaps = np.array([1.6, 1.8, 2.0, 2.2]) * X0
    up, down = (work_rate_against_gap(Params(), Settings(), gaps, way) for way in ("up", "down"))
    assert up.gap.equals(down.gap)
    assert up.regime[2] == "period-1-asymmetric" and down.regime[2] == "aperiodic"
    assert up.work_rate[2].max() > 1.2 * down.work_rate[2].max()


def test_a_history_ends_where_contact_does():
    p = Params(
        contact_stiffness=1e3, forcing_frequency=3.0, force_amplitude=0.15, mass_damping=30.0
    )
    ds = wear_history(p, Settings(depths=(1e-3,)), 4096)
    assert ds.regime[-1] == "no-impact"
    last = ds.isel(regime_change=-1)
    assert last.change_to == "no-impact"
    assert last.change_gap.values == pytest.approx(4.66 * X0, rel=0.01)


def test_a_portrait_is_closed_and_passes_the_stops_symmetrically():
    p = Params(forcing_frequency=54.797)
    ds = phase_portrait(p, Settings(steps_per_period=800), [X0, 1.2 * X0])
    assert all_labelled(ds)
    x, v = ds.displacement.values, ds.velocity.values
    assert x.shape == v.shape == (2, 800)
    assert (x.max(axis=1) > [X0, 1.2 * X0]).all()
    assert x.min(axis=1) == pytest.approx(-x.max(axis=1), rel=2e-3)
    # the area within is the integral of v^2 over a period
    time = 1 / (54.797 * 800)
    area = -0.5 * (x * np.roll(v, -1, 1) - v * np.roll(x, -1, 1)).sum(axis=1)
    acceleration = (np.roll(v, -1, 1) - np.roll(v, 1, 1)) / (2 * time)
    assert area == pytest.approx(((v**2 - x * acceleration).sum(axis=1)) * time / 2, rel=1e-2)


def test_both_propagators_draw_the_same_portrait():
    p = Params(forcing_frequency=54.797)
    fast, slow = (
        phase_portrait(p, Settings(propagator=name, steps_per_period=400), [X0])
        for name in ("fast", "exact")
    )
    assert np.abs(fast.displacement - slow.displacement).max() < 2e-3 * slow.displacement.max()
    assert np.abs(fast.velocity - slow.velocity).max() < 1e-2 * slow.velocity.max()


def test_slopes_at_a_level_are_those_of_the_curve():
    t = np.linspace(0, 6 * np.pi, 600)
    h = t[1]
    rates = upcrossing_rates(np.sin(t + 0.1), 0.3) / h
    assert rates == pytest.approx(np.full(len(rates), np.sqrt(1 - 0.09)), rel=1e-5)
    assert len(rates) == 3


def test_impacts_of_a_periodic_response_repeat_and_no_response_has_none():
    ds = bifurcation_diagram(Params(), Settings(), [2.0, 54.797, SECOND], 8)
    assert all_labelled(ds)
    assert ds.frequency_ratio.values == pytest.approx([0.3467, 9.5, 9.9], rel=1e-3)
    assert ds.regime.values[1:].tolist() == ["period-1-symmetric", "period-1-asymmetric"]
    for k in (1, 2):
        v = ds.impact_velocity[k].values
        v = v[np.isfinite(v)]
        assert len(v) % 8 == 0 or len(v) % 8 == 7  # the first may be before the window
        per = len(v) // 8 or 1
        assert v[per:] == pytest.approx(v[:-per], rel=1e-3)
    w0 = 2 * np.pi * 54.797 / ds.frequency_ratio[1].item()
    assert ds.dimensionless_impact_velocity.values == pytest.approx(
        ds.impact_velocity.values / (X0 * w0), nan_ok=True
    )


def test_sweeps_in_frequency_follow_the_branch_that_rest_leads_to():
    band = np.linspace(9.4, 9.6, 5) * 57.1042 / 9.9
    rest = bifurcation_diagram(Params(), Settings(), band, 8)
    up = bifurcation_diagram(Params(), Settings(), band, 8, "up")
    assert up.work_rate.values == pytest.approx(rest.work_rate.values, rel=5e-3)
    assert up.impact_velocity.max("impact").values == pytest.approx(
        rest.impact_velocity.max("impact").values, rel=5e-3
    )


def test_a_sweep_has_one_of_three_names_and_gaps_are_positive():
    with pytest.raises(ValueError, match="'none', 'up' or 'down', not 'back'"):
        work_rate_against_gap(Params(), Settings(), [X0], "back")
    with pytest.raises(ValueError, match="gaps must be positive"):
        phase_portrait(Params(), Settings(), [0.0])


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda p, s: wear_history(p, s, looks=0), "looks must be a positive whole number, not 0"),
        (lambda p, s: phase_portrait(p, s, [X0], periods=-1), "periods must be a positive whole"),
        (lambda p, s: bifurcation_diagram(p, s, [-57.0]), "must be a list of positive numbers"),
        (lambda p, s: bifurcation_diagram(p, s, 57.0), "must be a list of positive numbers"),
        (lambda p, s: continue_orbit(p, s, "frequency", stop=58.0), "parameter must be 'forcing_"),
        (lambda p, s: continue_orbit(p, s, stop=np.nan), "stop must be a number"),
        (lambda p, s: continue_orbit(p, s, stop=58.0, period=0), "period must be positive: 0"),
        (lambda p, s: continue_orbit(p, s, stop=58.0, state=[1.0]), "state must have 44 numbers"),
        (lambda p, s: follow_wear(p, s, stop=2 * X0, accuracy=0.0), "accuracy must be positive"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(call, says):
    with pytest.raises(ValueError, match=says):
        call(Params(), Settings())


@pytest.mark.parametrize(
    "call",
    [
        lambda p: wear_history(p, Settings()),
        lambda p: work_rate_against_gap(p, Settings(), [X0]),
        lambda p: continue_orbit(p, stop=58.0),
        lambda p: follow_wear(p, stop=2 * X0),
    ],
)
def test_a_random_load_is_not_left_out_silently(call):
    with pytest.raises(ValueError, match="random_force_level > 0"):
        call(Params(random_force_level=1e-3))


def test_a_sweep_with_residual_flexibility_is_refused():
    settings = Settings(modes=4, residual_flexibility=True)
    with pytest.raises(ValueError, match="without residual_flexibility"):
        work_rate_against_gap(Params(), settings, [X0, 2 * X0], sweep="up")
