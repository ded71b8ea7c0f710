"""From standstill to the outcome: regimes, orbits against long runs, published facts."""

import numpy as np
import pytest
from machines import over_the_bounds

from models.vibrator.equations.system import systems
from models.vibrator.exact import propagator
from models.vibrator.lanes.machines import prepared
from models.vibrator.lanes.orbit import find_orbits
from models.vibrator.paper.table1 import machines
from models.vibrator.parameters import REGIMES, Params, Settings
from models.vibrator.start import fast
from models.vibrator.start.regimes import ASYNCHRONOUS, CAPTURED, LOCKED_0, LOCKED_PI, wrapped
from models.vibrator.start.synchronous import propose, search
from models.vibrator.theory import averaged
from tests.support import vibrator_papers as closed_forms
from tests.support.vibrator_papers import combined_centre, reduced_inertia, reduced_mass
from uq.contract import Status


def fleet(n=1, **values):
    fields = {**Params._field_defaults, **values}
    return Params(*(np.broadcast_to(np.asarray(v, float), (n,)).copy() for v in fields.values()))


def outcomes(p, **settings):
    return fast.outcomes(p, Settings(**settings))


def scattered(n, seed=0):
    rng = np.random.default_rng(seed)
    names = ("rated_torque_1", "rated_torque_2", "stiffness_x", "stiffness_y", "unbalance_1")
    values = {name: Params._field_defaults[name] * rng.uniform(0.9, 1.1, n) for name in names}
    values["synchronous_speed_1"] = 157 * rng.normal(1, 5e-4, n)
    values["axis_offset"] = rng.normal(0, 0.02, n)
    return fleet(n, **values)


def row(p, i):
    return Params._make(float(field[i]) for field in p)


def test_the_published_table_is_met():
    out, status = outcomes(machines())
    assert (status == Status.OK).all()
    size = np.abs(out.disphasing)
    asymmetric = [0, 1, 3, 4, 5, 7]
    assert (size[[2, 6]] < 1e-9).all()
    assert size[asymmetric].min() == pytest.approx(0.027, abs=5e-4)
    assert size[asymmetric].max() == pytest.approx(0.052, abs=5e-4)
    assert (out.angular_amplitude[asymmetric] < 1e-4).all()
    assert (out.angular_amplitude[[2, 6]] < 1e-12).all()
    assert (out.regime == LOCKED_0).all()


def test_angles_are_accurate_over_all_bounds():
    p = over_the_bounds(3000, 8)._replace(
        mount_stiffness=np.full(3000, np.inf),
        mount_rotational_stiffness=np.full(3000, np.inf),
        feed_mass=np.zeros(3000),
    )
    exists = averaged.disphasing(p).stable
    m = prepared(Params._make(field[exists] for field in p))
    proposed = propose(m, 0)
    assert proposed.exists.sum() > 10
    for i in np.flatnonzero(proposed.exists):
        state, period = proposed.orbits.state[[i]], proposed.orbits.period[[i]]
        fine = find_orbits(m.constants[[i]], state, period, 4 * proposed.steps[i])
        assert fine.converged and abs(wrapped(fine.angle[0] - proposed.disphasing[i])) < 1e-6


def test_theory_and_simulation_agree_at_small_angles():
    p = machines()
    out, _ = outcomes(p)
    assert np.abs(out.disphasing - averaged.disphasing(p).angle).max() < 1e-4


def test_the_start_is_that_of_the_exact_propagator():
    p = scattered(3)
    out, _ = outcomes(p)
    m = systems(p)
    times = np.arange(1, 8001) * 5e-4
    for i in range(3):
        machine = m.row(i)
        motion = propagator.propagate(
            machine, propagator.start(row(p, i), machine), 4.0, 1e-10, times=times
        )
        angle = motion.samples[:, 3] - motion.samples[:, 4]
        off = np.abs(wrapped(angle - out.disphasing[i]))
        assert out.synchronisation_time[i] == pytest.approx(times[off > 0.05][-1], abs=1e-3)
        far = np.hypot(motion.samples[:, 0], motion.samples[:, 1]).max()
        assert out.max_excursion[i] == pytest.approx(far, rel=1e-3)


@pytest.mark.slow
def test_the_orbit_is_where_a_long_run_ends():
    p = scattered(2)
    p = p._replace(damping_ratio=np.full(2, 0.07))
    out, _ = outcomes(p)
    m = systems(p)
    for i in range(2):
        machine = m.row(i)
        period = 2 * np.pi / out.speed[i]
        times = 60.0 + period * np.arange(64) / 64
        motion = propagator.propagate(
            machine, propagator.start(row(p, i), machine), 61.0, 1e-11, times=times
        )
        states = motion.samples
        mean = wrapped((states[:, 3] - states[:, 4]).mean())
        assert out.disphasing[i] == pytest.approx(mean, abs=1e-7)
        harmonic = 2 * (states[:, 2] * np.exp(-2j * np.pi * np.arange(64) / 64)).mean()
        assert out.angular_amplitude[i] == pytest.approx(abs(harmonic), rel=1e-5)
        cos, sin = np.cos(p.working_angle[i]), np.sin(p.working_angle[i])
        along = cos * states[:, 0] + sin * states[:, 1]
        lever = sin * p.support_half_spacing[i] * states[:, 2]
        assert out.stroke_left[i] == pytest.approx(np.ptp(along - lever) / 2, rel=3e-3)
        assert out.stroke_right[i] == pytest.approx(np.ptp(along + lever) / 2, rel=3e-3)
        rigid = machine.rigid
        for power, torque, slip, top, w in (
            (out.power_1, rigid.torque_1, rigid.slip_1, rigid.synchronous_speed_1, states[:, 8]),
            (out.power_2, rigid.torque_2, rigid.slip_2, rigid.synchronous_speed_2, states[:, 9]),
        ):
            lag = top - w
            assert power[i] == pytest.approx((w * torque * lag / (slip**2 + lag**2)).mean(), 1e-6)


def test_a_row_has_the_same_bits_alone_and_among_others():
    p = scattered(40)
    p.synchronous_speed_1[7] = 150.0  # never locks
    p.rated_torque_1[9] = p.rated_torque_2[9] = 12.0
    together, _ = outcomes(p, run_up=8.0)
    for i in (0, 7, 9, 39):
        alone, _ = outcomes(Params._make(field[i : i + 1] for field in p), run_up=8.0)
        for name, value, all_ in zip(alone._fields, alone, together, strict=True):
            assert np.array_equal(value[0], all_[i], equal_nan=True), name


def test_motors_too_unlike_never_lock():
    out, status = outcomes(fleet(synchronous_speed_1=150.0))
    assert status[0] == Status.OK
    assert REGIMES[out.regime[0]] == "asynchronous"
    assert np.isinf(out.synchronisation_time[0]) and not out.censored[0]
    assert np.isnan(out.disphasing[0]) and np.isnan(out.multiplier[0])
    assert 145 < out.speed[0] < 157


def test_motors_that_cannot_lift_their_unbalances_stall():
    """At a rated torque of 12 N m the starting torque is 11.4 N m, the weight's moment 49 N m."""
    weak = {"rated_torque_1": 12.0, "rated_torque_2": 12.0, "stiffness_x": 2.07e6}
    out, _ = outcomes(fleet(2, **weak, support_offset=0.0, gravity=[0.0, 9.81]), run_up=8.0)
    assert [REGIMES[i] for i in out.regime] == ["captured", "one-stalled"]


def test_weak_motors_on_stiff_supports_are_caught_at_resonance():
    weak = {"stiffness_x": 2.07e6, "support_offset": 0.0}
    torque = np.array([20.0, 240.0])
    out, _ = outcomes(fleet(2, **weak, rated_torque_1=torque, rated_torque_2=torque))
    assert out.regime.tolist() == [CAPTURED, LOCKED_0]
    resonance = np.sqrt(2.07e6 / 2200)
    assert out.speed[0] == pytest.approx(resonance, rel=0.2)


def test_a_motor_without_torque_is_dragged_or_stalls():
    out, _ = outcomes(fleet(rated_torque_1=8.0, overload_capacity=0.08))
    assert REGIMES[out.regime[0]] in ("one-stalled", "captured")
    assert np.isnan(out.disphasing[0])


def test_motors_lock_at_pi_where_the_synchronising_moment_is_negative():
    # Supports so stiff along the working axis that its natural frequency is near the speed.
    p = fleet(
        2,
        working_angle=0.0,
        stiffness_x=2.4e7,
        support_offset=0.0,
        shaft_distance=0.1,
        rated_torque_1=2000.0,
        rated_torque_2=2000.0,
        initial_phase_1=[0.3, 0.0],
    )
    guess = averaged.disphasing(p)
    out, _ = outcomes(p)
    assert (np.abs(guess.angle) > np.pi / 2).all()
    assert (out.regime == LOCKED_PI).all()
    assert (np.abs(wrapped(out.disphasing - guess.angle)) < 0.05).all()


def test_the_step_of_the_start_does_not_matter():
    p = scattered(8)
    coarse, _ = outcomes(p)
    fine, _ = outcomes(p, steps_per_turn=48)
    assert np.abs(coarse.disphasing - fine.disphasing).max() < 1e-7
    assert np.abs(coarse.synchronisation_time - fine.synchronisation_time).max() < 2e-3
    assert np.allclose(coarse.max_excursion, fine.max_excursion, rtol=1e-3)


def test_amplitudes_of_unlocked_motors_are_those_between_the_steps():
    apart = fleet(8, synchronous_speed_1=np.linspace(147, 152, 8))
    coarse, _ = outcomes(apart, run_up=6.0)
    fine, _ = outcomes(apart, run_up=6.0, steps_per_turn=200)
    assert (coarse.regime == ASYNCHRONOUS).all()
    for name in ("angular_amplitude", "stroke_left", "stroke_right"):
        np.testing.assert_allclose(getattr(coarse, name), getattr(fine, name), rtol=1e-3)


def test_a_run_longer_than_its_budget_is_said_and_censored(monkeypatch):
    monkeypatch.setattr(fast, "BUDGET", 4)
    out, status = outcomes(fleet(2, synchronous_speed_1=[157.0, 150.0]), run_up=600.0)
    assert status.tolist() == [Status.OK, Status.OUT_OF_BUDGET]
    assert out.censored.tolist() == [False, True]
    assert 1 < out.synchronisation_time[1] < 5
    assert REGIMES[out.regime[1]] == "asynchronous"
    assert np.isfinite(out.multiplier[0])


def fold_of_synchronous_orbits(p):
    """Follow the synchronous orbit while the synchronous speeds part; return where it ends."""
    apart, step = 0.0, 0.02
    angle, speed = np.zeros(1), np.full(1, 156.6)
    while step > 1e-4:
        trial = p._replace(
            synchronous_speed_1=np.full(1, 157 + (apart + step) / 2),
            synchronous_speed_2=np.full(1, 157 - (apart + step) / 2),
        )
        trial = trial._replace(
            breakdown_speed_1=trial.synchronous_speed_1 - 31.0,
            breakdown_speed_2=trial.synchronous_speed_2 - 31.0,
        )
        orbits = search(prepared(trial), speed, angle, np.ones(1, bool), 0)
        if orbits.exists[0]:
            apart += step
            angle, speed = orbits.disphasing, 2 * np.pi / orbits.orbits.period
        else:
            step /= 2
    return apart


def moment_and_slope(p, w):
    """Return K of eq. (5) and a_el + a_o of eq. (3) for isotropic centred supports."""
    at = combined_centre(
        p.body_mass, p.body_inertia, p.unbalanced_mass, p.shaft_distance, p.shaft_half_angle
    )
    mass = reduced_mass(at.mass, p.stiffness_x, w)
    inertia = reduced_inertia(at.inertia, p.stiffness_y, p.support_half_spacing, w)
    b = closed_forms.synchronising_coefficient(at.distance, inertia, mass, mass)
    slope = closed_forms.speed_coefficient(
        p.rated_torque_1,
        p.overload_capacity,
        p.synchronous_speed_1,
        p.breakdown_speed_1,
        p.bearing_constant_1,
        p.unbalance_1,
        w,
    )
    return closed_forms.synchronising_moment(p.unbalance_1, w, b), slope


def centre_and_inertia(p, w):
    """Return the combined centre, J', and the isotropic M' of eqs (5) to (8)."""
    at = combined_centre(
        p.body_mass,
        p.body_inertia,
        p.unbalanced_mass,
        p.shaft_distance,
        p.shaft_half_angle,
        p.axis_offset,
    )
    inertia = reduced_inertia(at.inertia, p.stiffness_y, p.support_half_spacing, w)
    return at, inertia, reduced_mass(at.mass, p.stiffness_x, w)


SOFT = {"stiffness_x": 1e5, "stiffness_y": 1e5, "support_offset": 0.0, "damping_ratio": 1e-3}


def test_unequal_motors_run_apart_as_the_sixth_equation_says():
    apart = np.array([0.05, 0.2, 0.5])
    p = fleet(3, **SOFT, synchronous_speed_2=157 - apart, breakdown_speed_2=126 - apart)
    out, _ = outcomes(p)
    moment, slope = moment_and_slope(p, out.speed)
    closed = closed_forms.disphasing_of_motors(apart, slope, moment)
    assert out.disphasing == pytest.approx(closed, rel=0.01)


def test_an_axis_off_centre_disphases_and_rocks_as_equations_seven_and_eight_say():
    p = fleet(3, **SOFT, axis_offset=[-0.2, 0.02, 0.1])
    out, _ = outcomes(p)
    at, inertia, mass = centre_and_inertia(p, out.speed)
    closed = closed_forms.disphasing_of_offset(at, inertia, mass, mass)
    assert out.disphasing == pytest.approx(closed, rel=0.01)
    rocking = closed_forms.angular_amplitude(out.disphasing, p.unbalance_1, at, inertia)
    assert out.angular_amplitude == pytest.approx(rocking, rel=0.01)
    assert (out.angular_amplitude > 1e-6).all()


def test_synchronisation_ends_where_the_fourth_equation_says():
    p = fleet(stiffness_x=2.07e6, support_offset=0.0)
    moment, slope = moment_and_slope(p, 156.6)
    assert fold_of_synchronous_orbits(p) == pytest.approx((moment / slope)[0], rel=0.02)


@pytest.mark.slow
def test_motors_weaker_than_the_synchronising_moment_show_hysteresis():
    # K > p M_zn: synchronous running goes on beyond (4), but is not reached from rest.
    p = fleet(stiffness_x=2.07e6, support_offset=0.0, rated_torque_1=30.0, rated_torque_2=30.0)
    moment, slope = moment_and_slope(p, 156.6)
    assert moment[0] > p.overload_capacity[0] * 30.0
    limit = (moment / slope)[0]
    assert fold_of_synchronous_orbits(p) > 1.2 * limit
    for motor, sign in (("1", 0.55), ("2", -0.55)):
        for name in ("synchronous_speed_", "breakdown_speed_"):
            getattr(p, name + motor)[:] += sign * limit
    out, _ = outcomes(p)
    assert out.regime[0] == ASYNCHRONOUS
