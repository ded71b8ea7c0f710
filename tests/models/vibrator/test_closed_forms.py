"""The closed formulas against the general one, each under its own conditions."""

import numpy as np
import pytest
from machines import SYMMETRIC, UNDAMPED, net_torques
from moments import vibratory_moments

from models.vibrator.parameters import Params
from models.vibrator.theory.averaged import disphasing, feed_gravity
from models.vibrator.theory.feed import contact_coefficient
from tests.support import vibrator_papers as cf
from tests.support.vibrator_papers import combined_centre, reduced_inertia, reduced_mass


def quantities(p, w):
    """Return combined centre, J', M_xi', M_eta' and B of one machine."""
    c = combined_centre(
        p.body_mass,
        p.body_inertia,
        p.unbalanced_mass,
        p.shaft_distance,
        p.shaft_half_angle,
        p.axis_offset,
    )
    cos2, sin2 = np.cos(p.working_angle) ** 2, np.sin(p.working_angle) ** 2
    j = reduced_inertia(c.inertia, p.stiffness_y, p.support_half_spacing, w)
    m_xi = reduced_mass(c.mass, p.stiffness_x * cos2 + p.stiffness_y * sin2, w)
    m_eta = reduced_mass(c.mass, p.stiffness_x * sin2 + p.stiffness_y * cos2, w)
    return c, j, m_xi, m_eta, cf.synchronising_coefficient(c.distance, j, m_xi, m_eta)


def moment(p, w):
    """Return K by equation (5), and by the general formula."""
    k = cf.synchronising_moment(p.unbalance_1, w, quantities(p, w)[-1])
    moment_1, moment_2 = vibratory_moments(p, w, np.pi / 2)
    return k, (moment_2 - moment_1)[0]


def test_synchronising_moment_of_a_free_body_is_exact():
    free = UNDAMPED._replace(stiffness_x=1e-3, stiffness_y=1e-3)
    for p in (free, free._replace(shaft_half_angle=1.0, body_inertia=700.0, unbalanced_mass=300.0)):
        closed, general = moment(p, 150.0)
        assert closed == pytest.approx(general, rel=1e-9)


def test_synchronising_moment_on_springs():
    closed, general = moment(UNDAMPED, 156.65)
    assert closed == pytest.approx(general, rel=0.01)
    # About C instead of the combined centre it would be a fifth larger.
    about_c = cf.synchronising_coefficient(0.8, 2667.0 - 2.07e6 / 156.65**2, 1.0, 1.0)
    assert cf.synchronising_moment(5.0, 156.65, about_c) > 1.15 * general


def test_conveyor_follows_from_the_general_formula():
    # Leaf springs: the deck moves along x only, the set also across it on its own springs.
    for k, k_z in ((2e6, 5e6), (9e7, 5e6), (2e6, 9e7)):
        p = UNDAMPED._replace(
            working_angle=0.0,
            body_inertia=1e18,
            stiffness_x=k,
            stiffness_y=1e18,
            mount_stiffness=k_z,
            mount_angle=np.pi / 2,
            mount_mass=180.0,
        )
        closed = cf.conveyor_moment(5.0, 150.0, p.body_mass, 180.0 + 200.0, k, k_z)
        moment_1, moment_2 = vibratory_moments(p, 150.0, np.pi / 2)
        assert closed == pytest.approx((moment_2 - moment_1)[0], rel=1e-6)


def slopes(p, w):
    return cf.speed_coefficient(
        p.rated_torque_1,
        p.overload_capacity,
        p.synchronous_speed_1,
        p.breakdown_speed_1,
        p.bearing_constant_1,
        p.unbalance_1,
        w,
    )


def test_speed_coefficient_is_the_slope_of_the_torque():
    p = SYMMETRIC._replace(bearing_constant_1=3e-3)
    w, e = p.synchronous_speed_1, 1e-3
    low, high = (net_torques(p, w + step)[0][0] for step in (-e, e))
    assert slopes(p, w) == pytest.approx((low - high) / (2 * e), rel=1e-8)


def unequal(p, difference):
    """Let motor 2 run slower, on its own, by a difference of speed."""
    return p._replace(
        synchronous_speed_2=p.synchronous_speed_1 - difference,
        breakdown_speed_2=p.breakdown_speed_1 - difference,
    )


def test_disphasing_of_unequal_motors():
    soft = UNDAMPED._replace(stiffness_x=1e4, stiffness_y=1e4)
    for difference in (0.1, 0.5, 1.5, 2.5):
        p = unequal(soft, difference)
        state = disphasing(p)
        k = moment(p, state.speed[0])[0]
        closed = cf.disphasing_of_motors(difference, slopes(p, state.speed[0]), k)
        assert state.angle[0] == pytest.approx(closed, rel=5e-3)


def test_where_synchronisation_ends():
    soft = UNDAMPED._replace(stiffness_x=1e4, stiffness_y=1e4)
    w = 155.5
    k = moment(soft, w)[0]
    limit = k / slopes(soft, w)
    assert np.isnan(cf.disphasing_of_motors(1.001 * limit, slopes(soft, w), k))
    assert cf.disphasing_of_motors(0.999 * limit, slopes(soft, w), k) > 1.5
    differences = limit * np.array([0.99, 1.01])
    assert np.array_equal(disphasing(unequal(soft, differences)).exists, [True, False])


def test_negative_moment_locks_around_pi():
    assert cf.disphasing_of_motors(0.0, 40.0, -100.0) == np.pi
    assert cf.disphasing_of_motors(1.0, 40.0, -100.0) == pytest.approx(-np.pi + np.arcsin(0.4))
    p = unequal(SYMMETRIC._replace(mount_rotational_stiffness=2e6), 0.5)
    state = disphasing(p)
    moment_1, moment_2 = vibratory_moments(p, state.speed, np.pi / 2)
    closed = cf.disphasing_of_motors(0.5, slopes(p, state.speed[0]), (moment_2 - moment_1)[0])
    assert closed < -np.pi / 2
    assert state.angle[0] == pytest.approx(closed, rel=0.01)


@pytest.mark.parametrize("offset", [-0.3, 0.02, 0.1, 0.3])
def test_force_axis_off_centre(offset):
    p = UNDAMPED._replace(axis_offset=offset)
    state = disphasing(p)
    c, j, m_xi, m_eta, _ = quantities(p, state.speed[0])
    angle = cf.disphasing_of_offset(c, j, m_xi, m_eta)
    assert state.angle[0] == pytest.approx(angle, rel=0.01)
    alpha = cf.angular_amplitude(state.angle[0], 5.0, c, j)
    assert state.angular_amplitude[0] == pytest.approx(alpha, rel=0.01)
    assert abs(alpha) > 1e-6


def test_angular_amplitude_of_motors_held_apart():
    p = unequal(UNDAMPED, 1.5)
    state = disphasing(p)
    assert state.angle[0] > 0.5
    c, j, *_ = quantities(p, state.speed[0])
    alpha = cf.angular_amplitude(state.angle[0], 5.0, c, j)
    assert state.angular_amplitude[0] == pytest.approx(alpha, rel=0.01)


@pytest.mark.parametrize("direction", [-1.2, -0.5, 0.3, 1.0])
def test_elastic_mount_of_a_set_without_mass(direction):
    soft = UNDAMPED._replace(stiffness_x=2e4, stiffness_y=2e4, unbalanced_mass=1e-3)
    p = soft._replace(mount_stiffness=1e8, mount_angle=direction)
    state = disphasing(p)
    b = quantities(p, state.speed[0])[-1]
    closed = cf.disphasing_of_mounts(b, state.speed[0], (1e8, direction))
    assert state.angle[0] == pytest.approx(closed, rel=5e-3)
    # The body also shakes the mass of the set, which the formula leaves out: it says too much.
    heavy = p._replace(unbalanced_mass=100.0, mount_stiffness=1e9)
    state = disphasing(heavy)
    b = quantities(heavy, state.speed[0])[-1]
    closed = cf.disphasing_of_mounts(b, state.speed[0], (1e9, direction))
    assert 1.15 < closed / state.angle[0] < 1.4


def test_equal_mounts_both_ways_cancel():
    b, w = 0.0002, 156.0
    for psi in (0.2, -1.0):
        angle = cf.disphasing_of_mounts(b, w, (3e7, psi))
        both = cf.disphasing_of_mounts(b, w, (3e7, psi), (3e7, psi + np.pi / 2))
        assert abs(angle) > 0.1 and abs(both) < 1e-12
        across = cf.disphasing_of_mounts(b, w, (3e7, psi + np.pi / 2))
        assert np.sign(across) == -np.sign(angle)


def test_equal_mounts_both_ways_cancel_in_the_general_formula():
    # Each alone turns dphi; to first order in the flexibility the general formula adds up to 0.
    p = UNDAMPED._replace(mount_stiffness=1e11, unbalanced_mass=1.0)
    angle, turned = (disphasing(p._replace(mount_angle=a)).angle[0] for a in (0.4, 0.4 + np.pi / 2))
    assert abs(angle) > 1e-4
    assert abs(angle + turned) < 2e-3 * abs(angle)


def test_rotational_mount_that_flips_the_vibrators():
    light = UNDAMPED._replace(unbalanced_mass=1.0)
    for p, accuracy in ((light, 0.01), (UNDAMPED, 0.05)):
        w = disphasing(p).speed[0]
        c, *_, b = quantities(p, w)
        critical = cf.critical_rotational_stiffness(c.half, w, b)
        around = p._replace(
            mount_rotational_stiffness=critical * np.array([1 - accuracy, 1 + accuracy])
        )
        assert np.array_equal(disphasing(around).angle, [np.pi, 0.0])
    assert critical == pytest.approx(4.7e6, rel=0.02)


@pytest.mark.parametrize("throw", [0.9, 1.2, 1.7, 2.3, 3.2])
def test_light_feed(throw):
    soft = UNDAMPED._replace(stiffness_x=2.07e4, stiffness_y=2.07e4)
    c, *_ = quantities(soft, 156.65)
    p = soft._replace(
        feed_mass=0.1,
        throw_coefficient=throw,
        feed_position=c.shift * np.cos(soft.working_angle),  # above the combined centre
    )
    state = disphasing(p)
    w = state.speed[0]
    *_, b = quantities(p, w)
    contact = contact_coefficient(throw) * p.feed_mass * feed_gravity(p)[0]
    closed = cf.disphasing_of_feed(contact, p.working_angle, b, c.mass, 5.0, w)
    assert state.angle[0] == pytest.approx(closed, rel=2e-3)


@pytest.mark.parametrize(
    ("k_x", "h", "beta"),
    [(6.21e5, 0.0, 30), (6.21e5, -0.4, 30), (2.07e6, -0.4, 30), (2.07e6, 0.3, 40), (1e6, 0, -20)],
)
def test_unlike_and_unlevel_supports(k_x, h, beta):
    for xi, accuracy in ((0.0, 0.015), (0.01, 0.05)):
        p = Params(
            stiffness_x=k_x, support_offset=h, working_angle=np.radians(beta), damping_ratio=xi
        )
        state = disphasing(p)
        w = state.speed[0]
        c, j, m_xi, m_eta, b = quantities(p, w)
        closed = cf.disphasing_of_supports(
            c, b, w, p.working_angle, k_x, p.stiffness_y, h, j, m_xi, m_eta
        )
        assert abs(closed) > 0.01
        assert state.angle[0] == pytest.approx(closed, rel=accuracy)


def test_supports_formula_knows_nothing_of_rubber():
    p = Params(stiffness_x=2.07e6, damping_ratio=0.07)
    state = disphasing(p)
    w = state.speed[0]
    c, j, m_xi, m_eta, b = quantities(p, w)
    closed = cf.disphasing_of_supports(
        c, b, w, p.working_angle, 2.07e6, 2.07e6, -0.4, j, m_xi, m_eta
    )
    assert closed / state.angle[0] == pytest.approx(1.35, abs=0.01)


def test_supports_formula_holds_small_offsets_too():
    p = UNDAMPED._replace(axis_offset=0.02)
    state = disphasing(p)
    w = state.speed[0]
    c, j, m_xi, m_eta, b = quantities(p, w)
    closed = cf.disphasing_of_supports(
        c, b, w, p.working_angle, 2.07e6, 2.07e6, 0.0, j, m_xi, m_eta
    )
    assert state.angle[0] == pytest.approx(closed, rel=0.01)
