"""Branches of orbits: where they begin, end and lose stability, against published values."""

import numpy as np
import pytest
from exact_beams import at_omega, set_up

from models.beam.explore.branches import continue_orbit, follow_wear
from models.beam.parameters import Params

X0 = Params().initial_gap


def hertz():
    """Return the fundamental frequency over 2 pi: omega times it is the forcing frequency [Hz]."""
    return at_omega(1.0).forcing_frequency


def branch(omega, stop, **options):
    return continue_orbit(at_omega(omega), stop=stop * hertz(), **options)


def kinds(ds):
    return ds.event.values.tolist()


@pytest.mark.parametrize(
    ("omega", "rates"), [(5.61, (3.919359, 3.394367)), (9.9, (82.55679, 29.56878))]
)
def test_work_rates_at_the_start_of_a_branch(omega, rates):
    ds = branch(omega, omega + 1e-3).isel(point=0)
    heavy = np.sort(ds.dimensionless_work_rate)[::-1]
    np.testing.assert_allclose(heavy, rates, rtol=1e-6)
    p = at_omega(omega)
    watt = p.contact_stiffness * X0**2 * 2 * np.pi * hertz()
    np.testing.assert_allclose(ds.work_rate, ds.dimensionless_work_rate * watt, rtol=1e-12)


@pytest.mark.parametrize(
    ("omega", "stop", "edge", "end"),
    [
        (5.61, 5.59, 5.6045, "neimark-sacker"),
        (5.61, 5.64, 5.6253, "symmetry-breaking"),
        (9.9, 9.86, 9.879, "symmetry-breaking"),
        (9.9, 10.03, 10.008, "grazing"),
    ],
)
def test_windows_of_stable_orbits_of_period_one(omega, stop, edge, end):
    ds = branch(omega, stop)
    assert ds.end == end
    assert ds.event_value[-1] / hertz() == pytest.approx(edge, abs=2e-3)
    assert ds.stable.all()
    asymmetric = ds.work_rate.diff("site") / ds.work_rate.sum("site")
    assert abs(asymmetric[0]) > 0.05


def test_points_of_a_branch_are_settled_motions():
    """A beam that starts on the branch stays there, and one that starts nearby comes back."""
    ds = branch(9.9, 9.95).isel(point=-1)
    p = at_omega(ds.forcing_frequency.item() / hertz())
    setup = set_up(p)
    setup.state[0, :44] = ds.state * 1.001
    work = setup.advance(1000).work[0, -1] * ds.forcing_frequency.item() / hertz() / (2 * np.pi)
    assert ds.forcing_frequency.item() == pytest.approx(9.95 * hertz())
    np.testing.assert_allclose(work, ds.dimensionless_work_rate, rtol=1e-5)


def test_a_symmetric_branch_goes_straight_through_the_birth_of_asymmetric_orbits():
    ds = branch(9.5, 10.2, stable_only=False)
    assert ds.end == "stop"
    assert kinds(ds) == ["symmetry-breaking"] * 2
    assert ds.event_value[0] / hertz() == pytest.approx(9.879, abs=2e-3)
    assert ds.event_stable_before.values.tolist() == [True, False]
    assert ds.event_stable_after.values.tolist() == [False, True]
    np.testing.assert_allclose(*ds.work_rate.transpose(), rtol=1e-6)
    stable = (ds.multiplier_real**2 + ds.multiplier_imag**2).max("multiplier") < 1
    np.testing.assert_array_equal(ds.stable, stable)


def test_a_branch_is_followed_over_its_folds():
    """Beyond its grazing and two folds the orbit of 9.9 is another one at the same frequency."""
    ds = branch(9.9, 10.05, stable_only=False)
    assert ds.end == "stop"
    assert kinds(ds)[:3] == ["grazing", "fold", "fold"]
    assert (np.diff(ds.forcing_frequency) < 0).any()
    folds = ds.event_value.values[1:3] / hertz()
    np.testing.assert_allclose(folds, [10.00803, 9.93859], atol=1e-4)


def test_grazing_comes_without_warning():
    """The tip turns at the stop's face while every multiplier is well within the circle."""
    ds = branch(9.9, 10.05)
    assert kinds(ds) == ["grazing", "fold"]
    assert ds.event_stable_after.values.tolist() == [True, False]
    assert ds.event_multiplier[0] < 0.98
    place = ds.event_value[0].item()
    before = ds.sel(point=ds.forcing_frequency < place)
    after = ds.sel(point=ds.forcing_frequency > place)
    assert before.impact_velocity.count("impact").max() == 1
    assert after.impact_velocity.count("impact").min() == 2
    assert after.clearance.min() < 0.05 * X0


def test_at_a_period_doubling_the_period_doubles():
    ds = branch(7.1, 7.14, period=2)
    assert (ds.end, ds.attrs["period"]) == ("period-doubling", 2)
    place = ds.event_value[0].item() / hertz()
    last = ds.isel(point=-1)
    assert last.multiplier_real[0] == pytest.approx(-1, abs=1e-2)
    assert abs(last.multiplier_imag[0]) == 0
    setup = set_up(at_omega(place + 5e-4))
    setup.state[0, :44] = last.state
    setup.advance(4000)
    strobe = setup.advance(8).strobe[0]
    assert np.abs(strobe[4:] - strobe[:4]).max() < 1e-6
    assert np.abs(strobe[2:4] - strobe[:2]).max() > 1e-3


def test_gaps_grow_in_proportion():
    p = at_omega(9.5)._replace(gap_asymmetry=0.01)
    ds = continue_orbit(p, parameter="gap", stop=1.2 * X0)
    assert ds.end == "stop"
    assert ds.gap[0] == X0 and ds.gap[-1] == pytest.approx(1.2 * X0)
    np.testing.assert_allclose(ds.gaps.sel(site="right"), 1.005 * ds.gap, rtol=1e-12)
    np.testing.assert_allclose(ds.gaps.sel(site="left"), 0.995 * ds.gap, rtol=1e-12)


def test_larger_gaps_are_smaller_forces():
    """Lengths in gaps know the force over the gap alone."""
    ds = continue_orbit(at_omega(9.5), parameter="gap", stop=1.25 * X0).isel(point=-1)
    weaker = at_omega(9.5)._replace(force_amplitude=Params().force_amplitude / 1.25)
    other = continue_orbit(weaker, stop=weaker.forcing_frequency * 1.001).isel(point=0)
    np.testing.assert_allclose(ds.work_rate, other.work_rate * 1.25**2, rtol=1e-8)
    np.testing.assert_allclose(ds.impact_velocity, other.impact_velocity * 1.25, rtol=1e-8)


def test_where_no_orbit_of_the_period_exists_it_says_so():
    with pytest.raises(ValueError, match="does not settle on an orbit of period 1"):
        branch(7.5, 7.6)


# Slow wear


def test_wear_at_561_ends_by_complex_multipliers():
    ds = follow_wear(at_omega(5.61), stop=2 * X0)
    assert ds.end == "neimark-sacker"
    assert ds.gaps[-1].max() / X0 == pytest.approx(1.45, abs=0.01)
    assert ds.event_multiplier[-1] == pytest.approx(1, abs=1e-5)
    assert abs(ds.multiplier_imag[-1, 0]) > 0.1
    ratio = ds.gaps.min("site") / ds.gaps.max("site")
    assert ratio.min() < ratio[-1]
    # the rates fall until the orbits of both sites are all but one
    heavy = ds.work_rate.max("site")
    assert (heavy.diff("point") < 0).mean() > 0.9


def test_wear_at_99_ends_by_grazing():
    ds = follow_wear(at_omega(9.9), stop=3 * X0)
    named = [*ds.data_vars.values(), ds.time, ds.dimensionless_time]
    assert all(v.attrs["units"] and v.attrs["long_name"] for v in named)
    assert ds.end == "grazing"
    last = ds.gaps[-1] / X0
    assert last.max() == pytest.approx(2.63, abs=0.02)
    assert last.min() / last.max() == pytest.approx(0.68, abs=0.005)
    assert ds.event_multiplier[0] == pytest.approx(0.976, abs=0.004)
    place = ds.event_gaps[0] / X0
    assert place.max() == pytest.approx(2.63, abs=0.02)
    heavy = ds.dimensionless_work_rate[-1]
    np.testing.assert_allclose(np.sort(heavy), [157, 269], rtol=0.05)


@pytest.mark.parametrize(("omega", "time"), [(9.9, 0.007806), (9.5, 0.023937)])
def test_time_to_gap_two(omega, time):
    p = at_omega(omega)
    ds = follow_wear(p, stop=2 * X0).isel(point=-1)
    assert ds.gaps.max() / X0 == pytest.approx(2, rel=1e-8)
    assert ds.dimensionless_time == pytest.approx(time, rel=5e-4)
    rate = p.wear_coefficient / p.contact_area * p.contact_stiffness * X0 * 2 * np.pi * hertz()
    np.testing.assert_allclose(ds.time, ds.dimensionless_time / rate, rtol=1e-12)


def test_steps_of_wear_are_controlled():
    """Archard's law holds between any two points, and the error is what was asked for."""
    p = at_omega(9.9)
    coarse = follow_wear(p, stop=2 * X0, accuracy=1e-4)
    fine = follow_wear(p, stop=2 * X0, accuracy=1e-7)
    assert len(fine.point) > 2 * len(coarse.point)
    error = abs(coarse.time[-1] / fine.time[-1] - 1)
    assert 1e-9 < error < 1e-4
    wear = p.wear_coefficient / p.contact_area  # per work and area (eq 5)
    growth = fine.gaps[-1] - fine.gaps[0]
    work = np.trapezoid(fine.work_rate, fine.time, axis=0)
    np.testing.assert_allclose(growth, wear * work, rtol=1e-3)


def test_each_site_has_its_own_wear_coefficient():
    p = at_omega(9.5)._replace(wear_coefficient_ratio=1e-9)
    ds = follow_wear(p, stop=1.1 * X0)
    growth = (ds.gaps[-1] - ds.gaps[0]) / X0
    assert growth.sel(site="right") == pytest.approx(0.1, rel=1e-6)
    assert abs(growth.sel(site="left")) < 1e-8


def test_wear_fades_where_contact_does():
    p = Params(
        forcing_frequency=3.0, force_amplitude=0.15, mass_damping=30.0, contact_stiffness=1e3
    )
    ds = follow_wear(p, stop=5 * X0)
    assert ds.end == "no-impact"
    assert ds.work_rate[-1].sum() < 2e-6 * ds.work_rate[0].sum()
    rate = ds.work_rate.sum("site")
    assert (rate[-100:].diff("point") < 0).all()


def test_without_contact_there_is_no_wear():
    ds = follow_wear(Params(force_amplitude=0.05), stop=2 * X0)
    assert ds.end == "no-impact"
    assert ds.time.values.tolist() == [0.0]
    assert not ds.work_rate.any()
