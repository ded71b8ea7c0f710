"""Exact kinematics, the flexible mount and the feed, against Lagrange's equations."""

import itertools

import lagrange
import numpy as np
import pytest

from models.vibrator.equations import general, rigid_motion
from models.vibrator.equations.system import system
from models.vibrator.parameters import Params

ODD = Params(
    unbalance_2=4.0,
    rated_torque_1=200.0,
    axis_offset=0.1,
    mount_angle=0.4,
    mount_mass=150.0,
    mount_damping_ratio=0.05,
    mount_inertia=8.0,
    feed_mass=120.0,
    feed_position=0.7,
    gravity=9.81,
)
MOUNTS = list(itertools.product((np.inf, 1e6), (np.inf, 3e5)))


def mounted(mount):
    return ODD._replace(mount_stiffness=mount[0], mount_rotational_stiffness=mount[1])


def random_state(rng, p):
    """Return q, v and the same as a state of the machine, the feed in flight."""
    q, v = rng.normal(size=(2, 7))
    v[3:5] = rng.uniform(-50, 160, size=2)
    q[~lagrange.free(p)] = v[~lagrange.free(p)] = 0
    return q, v, np.concatenate([q, [0.3], v, [-0.8]])


@pytest.mark.parametrize("riding", [True, False])
@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_accelerations_are_lagranges(kinematics, mount, riding):
    p = mounted(mount)
    m, rng = system(p, kinematics), np.random.default_rng(7)
    for _ in range(20):
        q, v, state = random_state(rng, p)
        out = np.array(general.accelerations(m, riding, state))
        expected = lagrange.acceleration(p, kinematics == "exact", riding, m.feed_gravity, q, v)
        np.testing.assert_allclose(out[:7], expected, rtol=0, atol=1e-12 * abs(expected).max())
        rise = p.feed_position * np.array([out[2], v[2] ** 2])
        angle = q[2] if kinematics == "exact" else 0.0
        deck = out[1] + rise[0] * np.cos(angle) - rise[1] * np.sin(angle)
        fall = 0.0 if riding else -m.feed_gravity - deck
        np.testing.assert_allclose(out[7], fall, rtol=1e-12)


def test_rigid_and_without_feed_they_are_the_plain_equations():
    p = ODD._replace(feed_mass=0.0)
    m, rng = system(p), np.random.default_rng(3)
    for _ in range(20):
        state = rng.normal(size=10)
        state[8:] = rng.uniform(-50, 160, size=2)
        plain = np.empty(5)
        rigid_motion.acceleration(m.rigid, state, plain)
        out = np.array(general.accelerations(m, True, general.extend(state)))
        np.testing.assert_allclose(out[:5], plain, rtol=0, atol=1e-12 * abs(plain).max())
        assert not out[5:].any()


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_landing_keeps_every_momentum_and_stops_the_feed_on_the_deck(kinematics, mount):
    p, exact = mounted(mount), kinematics == "exact"
    m, rng = system(p, kinematics), np.random.default_rng(5)
    momenta, at = lagrange.mechanics(exact).momenta, lagrange.free(p)
    for _ in range(20):
        q, v, state = random_state(rng, p)
        reach = np.zeros(7)  # by which the deck under the feed moves with the body
        reach[1:3] = 1, p.feed_position * (np.cos(q[2]) if exact else 1.0)
        feed = p.feed_mass * (reach @ v - 0.8)
        before = np.ravel(momenta(lagrange.values(p), 0.0, 0.0, q, v)) + feed * reach
        general.land(m, state)
        after = np.ravel(momenta(lagrange.values(p), 1.0, 0.0, q, state[8:15]))
        scale = 1e-12 * abs(before).max()
        np.testing.assert_allclose(after[at], before[at], rtol=0, atol=scale)
        assert abs(state[8:15] - v).max() > 1e-3
        np.testing.assert_array_equal(state[[7, 15]], 0)
        np.testing.assert_array_equal(state[:7], q)
