"""Blekhman's criterion picks the state that torques pick."""

import numpy as np
from criterion import integral, minimising_angle
from machines import SYMMETRIC, UNDAMPED, plausible
from moments import vibratory_moments

from models.vibrator.theory.averaged import disphasing
from tests.support import vibrator_papers as cf
from tests.support.vibrator_papers import combined_centre, reduced_inertia, reduced_mass

CONSERVATIVE = {"damping_ratio": 0.0, "mount_damping_ratio": 0.0, "feed_mass": 0.0}


def test_its_slope_is_the_vibratory_moment():
    rows = 100
    p = plausible(rows, seed=1, **CONSERVATIVE)
    rng = np.random.default_rng(2)
    w, dphi = rng.uniform(50.0, 200.0, rows), rng.uniform(-np.pi, np.pi, rows)
    moment_1, moment_2 = vibratory_moments(p, w, dphi)
    e = 1e-3
    slope = (integral(p, w, dphi + e) - integral(p, w, dphi - e)) / (2 * np.sin(e))
    size = abs(integral(p, w, dphi)) + abs(moment_1)
    assert np.all(abs(moment_1 + slope) < 1e-8 * size)
    assert np.all(abs(moment_2 - slope) < 1e-8 * size)


def test_its_minimum_is_where_identical_motors_lock():
    equal = {
        "unbalance_2": "unbalance_1",
        "rated_torque_2": "rated_torque_1",
        "synchronous_speed_2": "synchronous_speed_1",
        "breakdown_speed_2": "breakdown_speed_1",
        "bearing_constant_2": "bearing_constant_1",
    }
    p = plausible(200, seed=3, **CONSERVATIVE, mount_rotational_stiffness=6e6)
    p = p._replace(**{name: getattr(p, other) for name, other in equal.items()})
    state = disphasing(p)
    assert state.stable.all() and 0.05 < np.mean(abs(state.angle) > np.pi / 2) < 0.95
    off = minimising_angle(p, state.speed) - state.angle
    assert np.all(abs(np.angle(np.exp(1j * off))) < 1e-9)


def test_it_agrees_with_the_coefficient_of_equation_5():
    p = UNDAMPED
    w = disphasing(p).speed[0]
    for inertia in (500.0, 2667.0, 1e5):
        for stiffness in (2.07e6, 9e7):  # above and below the speed of the springs
            q = p._replace(body_inertia=inertia, stiffness_x=stiffness)
            c = combined_centre(q.body_mass, inertia, 100.0, 0.8, q.shaft_half_angle)
            along = np.cos(q.working_angle) ** 2
            k_xi = stiffness * along + q.stiffness_y * (1 - along)
            k_eta = stiffness * (1 - along) + q.stiffness_y * along
            b = cf.synchronising_coefficient(
                c.distance,
                reduced_inertia(c.inertia, q.stiffness_y, 1.0, w),
                reduced_mass(c.mass, k_xi, w),
                reduced_mass(c.mass, k_eta, w),
            )
            near_zero = np.cos(minimising_angle(q, w)[0]) > 0
            assert near_zero == (b > 0), (inertia, stiffness)


def test_the_pi_state_of_a_soft_mount_is_its_minimum():
    soft = SYMMETRIC._replace(mount_rotational_stiffness=[3e6, 8e6])
    np.testing.assert_allclose(np.cos(minimising_angle(soft, 156.65)), [-1, 1], atol=1e-12)
