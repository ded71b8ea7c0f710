"""What becomes of a machine that is switched on, by the error-controlled propagator."""

import math

import numpy as np
import pytest

from models.vibrator.equations.system import system, systems
from models.vibrator.exact import propagator
from models.vibrator.exact.budgeted import prepare
from models.vibrator.exact.measures import measure
from models.vibrator.exact.orbit import find_orbit, proposal
from models.vibrator.lanes.orbit import find_orbits
from models.vibrator.lanes.packed import pack
from models.vibrator.parameters import Params, Settings
from models.vibrator.start import exact
from models.vibrator.start.exact import outcomes
from models.vibrator.start.regimes import ASYNCHRONOUS, CAPTURED, LOCKED_0, LOCKED_PI, STALLED
from models.vibrator.theory import averaged
from models.vibrator.trajectory import simulate
from uq.contract import Status

EXACT = Settings(propagator="exact")
FREED = Settings(propagator="exact", kinematics="exact")
SYMMETRIC = Params(stiffness_x=2.07e6, support_offset=0.0)
ON_MOUNTS = Params(
    mount_stiffness=5e7,
    mount_rotational_stiffness=3e7,
    mount_mass=100.0,
    mount_inertia=6.0,
    mount_damping_ratio=0.02,
)
SOFT = Params(stiffness_x=2.07e5, stiffness_y=2.07e5, support_offset=0.0)
TABLE = [
    Params(damping_ratio=xi, stiffness_x=k_x, support_offset=h)
    for xi in (0.01, 0.07)
    for k_x, h in ((6.21e5, 0.0), (6.21e5, -0.4), (2.07e6, 0.0), (2.07e6, -0.4))
]


def rows(machines):
    return Params._make(np.array(column, float) for column in zip(*machines, strict=True))


def switched_on(*machines, settings=EXACT):
    return outcomes(rows(machines), settings)


@pytest.fixture(scope="module")
def table():
    return switched_on(*TABLE)


def test_table_1(table):
    out, status = table
    assert (status == Status.OK).all()
    assert (out.regime == LOCKED_0).all()
    off = np.abs(out.disphasing)
    symmetric = [2, 6]
    assert (off[symmetric] < 1e-9).all()
    assert (out.angular_amplitude[symmetric] < 1e-12).all()
    asymmetric = np.delete(off, symmetric)
    np.testing.assert_allclose([asymmetric.min(), asymmetric.max()], [0.027, 0.052], atol=5e-4)
    amplitude = np.delete(out.angular_amplitude, symmetric)
    assert ((amplitude > 1e-5) & (amplitude < 1e-4)).all()
    assert np.isfinite(out.synchronisation_time).all()
    assert not out.censored.any()


def test_steady_running_is_close_to_the_averaged_theory(table):
    out, _ = table
    twin = averaged.disphasing(rows(TABLE))
    np.testing.assert_allclose(out.disphasing, twin.angle, rtol=0, atol=1e-4)
    np.testing.assert_allclose(out.speed, twin.speed, rtol=1e-4)
    np.testing.assert_allclose(out.angular_amplitude, twin.angular_amplitude, rtol=5e-3, atol=1e-9)
    np.testing.assert_allclose(out.power_1, twin.power_1, rtol=1e-2)
    np.testing.assert_allclose(out.power_2, twin.power_2, rtol=1e-2)


def test_orbit_and_multiplier_are_those_of_the_variational_equations(table):
    out, _ = table
    machines = rows(TABLE)
    guesses = [proposal(prepare(p, "small", 0)) for p in TABLE]
    period = 2 * np.pi / averaged.disphasing(machines).speed
    orbits = find_orbits(pack(systems(machines).rigid), np.array(guesses), period, 96)
    assert orbits.converged.all()
    np.testing.assert_allclose(out.multiplier, orbits.multiplier, rtol=0, atol=1e-6)
    np.testing.assert_allclose(2 * np.pi / out.speed, orbits.period, rtol=1e-9)
    for p, state in zip(TABLE, orbits.state, strict=True):
        machine = prepare(p, "small", 100_000)
        mine = find_orbit(machine, proposal(machine), 1e-11)
        np.testing.assert_allclose(mine.state, state, rtol=0, atol=1e-8)


def test_start_is_that_of_the_trajectory(table):
    out, _ = table
    for i in (1, 4):
        time, seen = simulate(TABLE[i], Settings(tolerance=1e-10, run_up=5.0))
        angle = seen["disphasing_angle"][2] - out.disphasing[i]
        off = np.abs(angle - 2 * np.pi * np.round(angle / (2 * np.pi)))
        k = np.flatnonzero(off > 0.05)[-1]
        assert time[k] - 1e-5 < out.synchronisation_time[i] < time[k + 1] + 1e-5
        largest = np.hypot(seen["x"][2], seen["y"][2]).max()
        assert largest * (1 - 1e-6) < out.max_excursion[i] < largest * (1 + 1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("settings", [EXACT, FREED])
@pytest.mark.parametrize("p", [Params(), ON_MOUNTS, SOFT._replace(feed_mass=100.0)])
def test_a_run_of_a_minute_ends_on_the_orbit(p, settings):
    p = p._replace(damping_ratio=0.07)
    out, status = switched_on(p, settings=settings)
    assert status[0] == Status.OK
    m = system(p, settings.kinematics)
    settled = propagator.propagate(m, propagator.start(p, m), 60.0, 1e-11)
    turn = propagator.propagate(m, settled.state, 1.0, 1e-11, turns=1)
    times = np.linspace(0.0, turn.time, 2001)
    states = propagator.propagate(m, settled.state, turn.time, 1e-11, times=times).samples
    seen = measure(m, states, times[1])
    harmonic = 2 * abs(np.mean(states[:-1, 2] * np.exp(-2j * np.pi * times[:-1] / times[-1])))
    turns = np.round(seen.disphasing / (2 * np.pi))
    np.testing.assert_allclose(out.disphasing, seen.disphasing - 2 * np.pi * turns, atol=1e-6)
    np.testing.assert_allclose(out.angular_amplitude, harmonic, rtol=1e-4)
    np.testing.assert_allclose(out.speed, 2 * np.pi / turn.time, rtol=1e-8)
    cos, sin = math.cos(p.working_angle), math.sin(p.working_angle)
    for end, stroke in ((-1.0, out.stroke_left), (1.0, out.stroke_right)):
        x, y, alpha = states[:, 0], states[:, 1], states[:, 2]
        lift, shrink = (np.sin(alpha), np.cos(alpha) - 1) if m.exact else (alpha, 0.0)
        np.testing.assert_allclose(
            stroke, np.ptp((x + end * shrink) * cos + (y + end * lift) * sin) / 2, rtol=1e-5
        )
    rigid, rate = m.rigid, states.shape[1] // 2
    w_1, w_2 = states[:-1, rate + 3], states[:-1, rate + 4]
    for power, torque, slip, top, w in (
        (out.power_1, rigid.torque_1, rigid.slip_1, rigid.synchronous_speed_1, w_1),
        (out.power_2, rigid.torque_2, rigid.slip_2, rigid.synchronous_speed_2, w_2),
    ):
        mean = np.mean(w * torque * (top - w) / (slip**2 + (top - w) ** 2))
        np.testing.assert_allclose(power, mean, rtol=1e-4 if p.feed_mass else 1e-7)


def test_a_soft_rotational_mount_flips_the_locked_state():
    """Equation (11): the border is at 4.8e6 N m/rad; close to it the approach takes minutes."""
    stiffness = (4.5e6, 4.65e6, 4.95e6, 5.2e6)
    machines = [
        SYMMETRIC._replace(mount_rotational_stiffness=k, initial_phase_1=0.3) for k in stiffness
    ]
    out, status = switched_on(*machines)
    assert (status == Status.OK).all()
    assert list(out.regime) == [LOCKED_PI, LOCKED_PI, LOCKED_0, LOCKED_0]
    np.testing.assert_allclose(np.abs(out.disphasing), [np.pi, np.pi, 0, 0], atol=1e-9)
    assert (out.multiplier < 1).all()
    assert out.multiplier[1:3].min() > out.multiplier[[0, 3]].max()


def test_an_approach_too_slow_for_the_start_is_censored():
    p = SYMMETRIC._replace(mount_rotational_stiffness=4.75e6, initial_phase_1=0.3)
    out, status = switched_on(p, settings=Settings(propagator="exact", run_up=20.0))
    assert status[0] == Status.OK
    assert out.regime[0] == LOCKED_PI
    assert 0.99 < out.multiplier[0] < 1
    assert out.censored[0]
    assert out.synchronisation_time[0] == pytest.approx(20.0)


def test_flexible_mounts_are_close_to_the_averaged_theory():
    machines = [ON_MOUNTS, ON_MOUNTS._replace(mount_angle=0.7, axis_offset=0.1)]
    out, status = switched_on(*machines)
    twin = averaged.disphasing(rows(machines))
    assert (status == Status.OK).all()
    assert np.abs(twin.angle).min() > 1e-2
    np.testing.assert_allclose(out.disphasing, twin.angle, rtol=0, atol=2e-4)
    np.testing.assert_allclose(out.angular_amplitude, twin.angular_amplitude, rtol=1e-2)


def test_exact_kinematics_differ_little_at_small_amplitude(table):
    out, _ = table
    freed, status = switched_on(TABLE[1], settings=FREED)
    assert status[0] == Status.OK
    assert 1e-7 < abs(freed.disphasing[0] - out.disphasing[1]) < 1e-4
    np.testing.assert_allclose(freed.multiplier, out.multiplier[1], rtol=0, atol=1e-5)


def test_feed_drives_the_vibrators_apart_but_not_at_one_throw():
    """At constant weight disphasing is largest near 1.7 and vanishes near 2.97."""
    throws = np.array([1.4, 1.6, 1.7, 1.8, 2.2, 2.6, 2.9, 3.05])
    machines = [SOFT._replace(feed_mass=5 * k, throw_coefficient=k) for k in throws]
    out, status = switched_on(*machines)
    assert (status == Status.OK).all()
    assert (out.regime == LOCKED_0).all()
    assert (out.multiplier < 1).all()
    assert throws[np.argmax(out.disphasing)] == 1.7
    zero = np.interp(0.0, -out.disphasing[-2:], throws[-2:])
    assert abs(zero - 2.975) < 0.04
    np.testing.assert_allclose(
        out.disphasing, averaged.disphasing(rows(machines)).angle, rtol=0, atol=2e-4
    )


def test_motors_that_do_not_lock():
    weak = SYMMETRIC._replace(rated_torque_1=40.0, rated_torque_2=40.0, damping_ratio=0.07)
    apart = Params(synchronous_speed_1=150.0, breakdown_speed_1=119.0)
    heavy = Params(rated_torque_1=8.0, rotor_inertia=15.0)
    brief = Settings(propagator="exact", run_up=10.0)
    out, status = switched_on(weak, apart, heavy, settings=brief)
    assert (status == Status.OK).all()
    assert list(out.regime) == [CAPTURED, ASYNCHRONOUS, STALLED]
    assert np.isnan(out.disphasing).all()
    assert np.isnan(out.multiplier).all()
    assert np.isinf(out.synchronisation_time).all()
    assert not out.censored.any()
    # The mean of both speeds; the first motor of the last machine hardly moves.
    assert out.speed[0] < 0.8 * 157
    np.testing.assert_allclose(out.speed[1], 153.1, atol=0.2)
    assert 157 / 2 < out.speed[2] < 0.525 * 157


def test_means_of_unlocked_motors_are_those_of_the_last_second():
    p = Params(synchronous_speed_1=150.0, breakdown_speed_1=119.0)
    out, _ = switched_on(p, settings=Settings(propagator="exact", run_up=8.0))
    time, seen = simulate(p, Settings(run_up=8.0, tolerance=1e-10))
    last = time >= 7.0
    for stroke, side in ((out.stroke_left, "left"), (out.stroke_right, "right")):
        half = np.ptp(seen[f"displacement_{side}"][2][last]) / 2
        np.testing.assert_allclose(stroke, half, rtol=2e-3)
    np.testing.assert_allclose(out.angular_amplitude, np.ptp(seen["alpha"][2][last]) / 2, rtol=2e-3)
    w = np.array([seen["speed_1"][2][last], seen["speed_2"][2][last]])
    np.testing.assert_allclose(out.speed, w.mean(), rtol=1e-4)
    lag = np.array([[150.0], [157.0]]) - w
    power = (2 * 2.5 * 240 * 31 * lag / (31**2 + lag**2) * w).mean(axis=1)
    np.testing.assert_allclose([out.power_1[0], out.power_2[0]], power, rtol=2e-2, atol=10)


def test_feed_thrown_too_high_repeats_no_turn_but_the_motors_stay_locked():
    p = SOFT._replace(feed_mass=100.0, throw_coefficient=5.7)
    out, status = switched_on(p, settings=Settings(propagator="exact", run_up=8.0))
    assert status[0] == Status.OK
    assert out.regime[0] == LOCKED_0
    assert abs(out.disphasing[0]) < 0.1
    assert np.isnan(out.multiplier[0])
    assert out.synchronisation_time[0] < 7.0


def test_a_machine_that_runs_out_of_steps_keeps_its_last_second(monkeypatch):
    monkeypatch.setattr(exact, "BUDGET", 2000)
    stiff = Params(mount_stiffness=1e17, mount_damping_ratio=1.0)
    apart = Params(synchronous_speed_1=150.0, breakdown_speed_1=119.0)
    out, status = switched_on(apart, stiff)
    assert (status == Status.OUT_OF_BUDGET).all()
    assert out.censored.all()
    assert out.regime[0] == ASYNCHRONOUS
    assert 1 < out.synchronisation_time[0] < 60
    np.testing.assert_allclose(out.speed[0], 153.1, atol=0.3)
    assert out.regime[1] == -1
    assert out.synchronisation_time[1] < 1
    assert np.isnan(out.speed[1])


def test_a_bad_row_harms_no_other():
    massless = Params(mount_rotational_stiffness=1e6, shaft_half_angle=0.0)
    unknown = Params(synchronous_speed_2=math.nan)
    alone, _ = switched_on(ON_MOUNTS)
    out, status = switched_on(massless, ON_MOUNTS, unknown)
    assert list(status) == [Status.NON_FINITE, Status.OK, Status.NON_FINITE]
    for field, value in zip(out, alone, strict=True):
        np.testing.assert_array_equal(field[1], value[0])
    assert list(out.regime) == [-1, LOCKED_0, -1]
    assert np.isnan(out.speed[[0, 2]]).all()


def test_slow_rotors_and_short_starts():
    """A second is less than a turn, and less than a look at the run-up."""
    p = Params(
        synchronous_speed_1=5.0,
        synchronous_speed_2=5.0,
        breakdown_speed_1=4.0,
        breakdown_speed_2=4.0,
    )
    out, status = switched_on(p, settings=Settings(propagator="exact", run_up=1.0))
    assert status[0] == Status.OK
    assert 4 < out.speed[0] < 5
    assert out.regime[0] == ASYNCHRONOUS  # no orbit can be seen to be stable in so short a time
