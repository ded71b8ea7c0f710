"""The averaged theory against its slow twin, balances, symmetries and published values."""

import time

import numpy as np
import pytest
from machines import SYMMETRIC, UNDAMPED, at, net_torques, over_the_bounds, plausible, twin
from moments import vibratory_moments

from models.vibrator.parameters import Params
from models.vibrator.theory.averaged import disphasing, feed_gravity, steady_motion

RIGID = {"mount_stiffness": np.inf, "mount_rotational_stiffness": np.inf}


@pytest.mark.parametrize(
    "fixed",
    [
        {},
        RIGID,
        {"mount_stiffness": np.inf},
        {"mount_rotational_stiffness": np.inf},
        RIGID | {"mount_mass": 0.0, "mount_inertia": 0.0, "feed_mass": 0.0},
    ],
)
def test_moments_and_motion_are_those_of_point_masses_on_springs(fixed):
    rows = 60
    p = plausible(rows, seed=1, **fixed)
    rng = np.random.default_rng(2)
    w, dphi = rng.uniform(20.0, 200.0, rows), rng.uniform(-np.pi, np.pi, rows)
    moments = np.stack(vibratory_moments(p, w, dphi), axis=1)
    motion = np.stack(steady_motion(p, w, dphi), axis=1)
    for i in range(rows):
        slow = twin(at(p, i), w[i], dphi[i])
        np.testing.assert_allclose(motion[i], slow.amplitudes, rtol=1e-9, atol=1e-14)
        np.testing.assert_allclose(moments[i], slow.moments, rtol=1e-9, atol=1e-9)


def test_the_state_balances_all_torques():
    p = plausible(400, seed=3)
    state = disphasing(p)
    assert 0.9 < state.stable.mean() < 1
    rows = np.flatnonzero(state.exists)
    moments = vibratory_moments(p, state.speed, state.angle)
    net, motor = net_torques(p, state.speed)
    for torque, moment in zip(net, moments, strict=True):
        np.testing.assert_allclose(torque[rows], -moment[rows], rtol=1e-9, atol=1e-8)
    powers = np.stack([state.power_1, state.power_2])
    np.testing.assert_allclose(powers, state.speed * np.stack(motor), rtol=1e-9)
    alpha = abs(steady_motion(p, state.speed, state.angle).alpha)
    np.testing.assert_allclose(state.angular_amplitude, alpha, rtol=1e-12)


def test_the_motors_feed_the_dampers_and_bearings_alone():
    p = plausible(50, seed=4)
    state = disphasing(p)
    for i in np.flatnonzero(state.exists):
        machine, w = at(p, i), state.speed[i]
        bearings = w**3 * (
            machine.bearing_constant_1 * machine.unbalance_1
            + machine.bearing_constant_2 * machine.unbalance_2
        )
        loss = twin(machine, w, state.angle[i]).loss + bearings
        assert state.power_1[i] + state.power_2[i] == pytest.approx(loss, rel=1e-8)


def test_stability_is_that_of_the_averaged_equations():
    p = over_the_bounds(20_000, seed=5)
    state = disphasing(p)
    rows = np.flatnonzero(state.exists)
    p = Params._make(field[rows] for field in p)
    w, dphi, n = state.speed[rows], state.angle[rows], len(rows)
    assert 0.5 < state.stable[rows].mean() < 0.95
    inertia = (
        p.rotor_inertia[:, None]
        + np.stack([p.unbalance_1, p.unbalance_2], 1) ** 2 / (p.unbalanced_mass[:, None])
    )

    def moments(dw, turned):
        return np.stack(vibratory_moments(p, w * (1 + dw), dphi + turned), axis=1)

    def torques(dw):
        return np.stack(net_torques(p, w * (1 + dw))[0], axis=1)

    e = 1e-6
    drag = (moments(e, 0) - moments(-e, 0)) / (2 * e * w[:, None])
    slope = (torques(e) - torques(-e)) / (2 * e * w[:, None])
    jacobian = np.zeros((n, 3, 3))
    jacobian[:, :2, :2] = 0.5 * drag[:, :, None] + slope[:, :, None] * np.eye(2)
    jacobian[:, :2, 2] = (moments(0, e) - moments(0, -e)) / (2 * e)
    jacobian[:, :2] /= inertia[:, :, None]
    jacobian[:, 2] = [1.0, -1.0, 0.0]
    growth = np.linalg.eigvals(jacobian)
    clear = abs(growth.real).min(axis=1) > 1e-4 * abs(growth).max(axis=1)
    assert clear.mean() > 0.8
    stable = growth.real.max(axis=1) < 0
    assert np.array_equal(stable[clear], state.stable[rows][clear])


TABLE_1 = [
    (0.01, 6.21e5, 0.0, -0.052359),
    (0.01, 6.21e5, -0.4, -0.042263),
    (0.01, 2.07e6, 0.0, 0.0),
    (0.01, 2.07e6, -0.4, 0.035061),
    (0.07, 6.21e5, 0.0, -0.051670),
    (0.07, 6.21e5, -0.4, -0.045384),
    (0.07, 2.07e6, 0.0, 0.0),
    (0.07, 2.07e6, -0.4, 0.027081),
]


def test_the_published_rows_come_out():
    xi, k_x, h, angle = np.transpose(TABLE_1)
    state = disphasing(Params(damping_ratio=xi, stiffness_x=k_x, support_offset=h))
    assert state.stable.all()
    np.testing.assert_allclose(state.angle, angle, atol=1e-6)
    asymmetric = angle != 0
    assert np.all(np.round(abs(state.angle[asymmetric]), 3) >= 0.027)  # as published
    assert np.all(np.round(abs(state.angle[asymmetric]), 3) <= 0.052)
    assert np.all(state.angular_amplitude[asymmetric] > 1e-5)
    assert np.all(state.angular_amplitude[asymmetric] < 1e-4)
    assert not state.angle[~asymmetric].any()
    assert not state.angular_amplitude[~asymmetric].any()


def test_a_soft_rotational_mount_locks_the_vibrators_at_pi():
    stiffness = np.array([1e6, 3e6, 4.5e6, 5.0e6, 6e6, 1e8, np.inf])
    state = disphasing(UNDAMPED._replace(mount_rotational_stiffness=stiffness))
    assert state.stable.all()
    assert np.array_equal(state.angle, [np.pi, np.pi, np.pi, 0, 0, 0, 0])


def test_angles_beyond_a_quarter_turn_and_near_pi_are_found():
    p = plausible(400, seed=6, mount_rotational_stiffness=2.5e6)
    state = disphasing(p)
    far = abs(state.angle[state.stable])
    assert np.sum(far > 3.0) > 5 and np.sum((far > 1.0) & (far < 2.0)) > 5
    assert np.all(far <= np.pi)


def test_a_mount_stiffens_into_none():
    loose = plausible(50, seed=7, mount_stiffness=1e14, mount_rotational_stiffness=1e14)
    tight = loose._replace(**{name: np.full(50, np.inf) for name in RIGID})
    a, b = disphasing(loose), disphasing(tight)
    np.testing.assert_allclose(a.angle, b.angle, rtol=1e-5, atol=1e-5)


def test_the_mirror_image_runs_the_other_way_round():
    p = plausible(100, seed=8)
    swapped = {}
    for name in Params._fields:
        if name.endswith("_1"):
            other = name[:-1] + "2"
            swapped |= {name: getattr(p, other), other: getattr(p, name)}
    mirror = p._replace(
        **swapped,
        working_angle=np.pi - p.working_angle,
        axis_offset=-p.axis_offset,
        mount_angle=-p.mount_angle,
        feed_position=-p.feed_position,
    )
    a, b = disphasing(p), disphasing(mirror)
    np.testing.assert_allclose(a.angle, -b.angle, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(a.power_1, b.power_2, rtol=1e-7)


def test_the_slower_motor_is_driven_as_a_generator():
    speed = np.array([157.0, 156.0, 155.0])
    state = disphasing(Params(synchronous_speed_2=speed, breakdown_speed_2=speed - 31))
    assert np.all(np.diff(state.angle) > 0)
    assert np.all(np.diff(state.power_1) > 0)
    assert state.power_2[0] > 0 > state.power_2[1] > state.power_2[2]


def test_where_the_motors_cannot_be_held_together_there_is_nothing():
    state = disphasing(Params(synchronous_speed_2=np.array([156.0, 150.0])))
    assert np.array_equal(state.exists, [True, False])
    assert not state.stable[1]
    for field in (state.angle, state.speed, state.angular_amplitude, state.power_1):
        assert np.array_equal(np.isnan(field), [False, True])


def test_the_fastest_of_several_states_is_taken():
    # At 28 rad/s the body resonates: the weak motors can be caught there, or run at speed.
    torque = np.array([8.0, 20.0])
    weak = SYMMETRIC._replace(damping_ratio=0.07, rated_torque_1=torque, rated_torque_2=torque)
    assert np.all(disphasing(weak).speed > 0.85 * 157)
    below = np.array([27.0, 29.5])  # a stable balance lies between
    sums = [
        sum(np.array(net_torques(weak, w)[0]) + np.array(vibratory_moments(weak, w, 0.0)))
        for w in below
    ]
    assert sums[0][1] > 0 > sums[1][1]
    # Braked enough, they are never faster than at the resonance.
    caught = disphasing(weak._replace(damping_ratio=0.2))
    assert caught.speed[0] < 0.2 * 157 < 0.9 * 157 < caught.speed[1]


def test_any_machine_within_the_bounds_gets_an_answer():
    p = over_the_bounds(20_000, seed=9)
    disphasing(Params())
    began = time.process_time()
    with np.errstate(all="raise"):
        state = disphasing(p)
    assert time.process_time() - began < 20
    assert 0.02 < state.exists.mean() < 0.2
    assert np.all(state.exists | ~state.stable)
    for field in state:
        if field.dtype != bool:
            assert np.array_equal(np.isfinite(field), state.exists)
    exists = state.exists
    assert np.all((state.angle[exists] > -np.pi) & (state.angle[exists] <= np.pi))
    assert np.all((state.speed[exists] > 0) & (state.angular_amplitude[exists] >= 0))
    moments, (net, motor) = (
        vibratory_moments(p, state.speed, state.angle),
        (net_torques(p, state.speed)),
    )
    size = abs(np.array(motor)) + abs(np.array(moments)).sum(axis=0)
    off = abs(np.array(net) + np.array(moments)) / size
    assert np.all(off[:, exists] < 1e-8)


def test_a_row_does_not_depend_on_its_neighbours():
    p = plausible(20, seed=10)
    whole = disphasing(p)
    for i in (0, 7, 19):
        alone = disphasing(at(p, i))
        for field, value in zip(whole, alone, strict=True):
            assert field[i : i + 1].tobytes() == value.tobytes()


def test_feed_gravity_gives_the_deck_its_throw():
    p = plausible(20, seed=11)
    speed = (p.synchronous_speed_1 + p.synchronous_speed_2) / 2
    gravity = feed_gravity(p)
    for i in range(20):
        x, y, alpha, _, _ = twin(at(p, i)._replace(feed_mass=0.0), speed[i], 0.0).amplitudes
        throw = abs(y + p.feed_position[i] * alpha) * speed[i] ** 2 / gravity[i]
        assert throw == pytest.approx(p.throw_coefficient[i], rel=1e-9)
