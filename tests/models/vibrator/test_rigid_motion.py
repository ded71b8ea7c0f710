"""The equations of the rigid machine without feed."""

import lagrange
import numpy as np
import paper
import pytest
from scipy.integrate import solve_ivp

from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params

NOMINAL = Params()
ODD = NOMINAL._replace(
    unbalance_2=4.2,
    unbalanced_mass=80.0,
    rated_torque_2=180.0,
    synchronous_speed_2=150.0,
    breakdown_speed_1=120.0,
    bearing_constant_1=3e-4,
    support_half_spacing=1.3,
    working_angle=0.7,
    stiffness_x=1.1e6,
    damping_ratio=0.07,
    gravity=9.81,
)


def accelerations(p, state):
    out = np.full(5, np.nan)
    rigid_motion.acceleration(system(p).rigid, np.asarray(state, float), out)
    return out


def random_states(n):
    rng = np.random.default_rng(13)
    states = rng.normal(size=(n, 10))
    states[:, 8:] = rng.uniform(-50, 160, size=(n, 2))
    return states


@pytest.mark.parametrize("p", [NOMINAL, ODD])
def test_they_are_the_printed_ones(p):
    for state in random_states(50):
        expected = paper.rates(0.0, paper.from_axis(p, state), p)[5:]
        np.testing.assert_allclose(
            accelerations(p, state), expected, rtol=0, atol=1e-12 * abs(expected).max()
        )


def test_they_are_lagranges_off_the_axis_and_with_a_heavy_motor_set():
    p = ODD._replace(axis_offset=0.15, mount_mass=150.0, mount_inertia=9.0)
    for state in random_states(50):
        q, v = np.append(state[:5], [0, 0]), np.append(state[5:], [0, 0])
        expected = lagrange.acceleration(p, False, False, 0.0, q, v)[:5]
        np.testing.assert_allclose(
            accelerations(p, state), expected, rtol=0, atol=1e-12 * abs(expected).max()
        )


@pytest.mark.parametrize("p", [NOMINAL, ODD])
def test_a_run_up_is_that_of_the_printed_equations(p):
    m = system(p)
    start = propagator.start(p, m)
    solution = solve_ivp(
        paper.rates,
        (0, 1),
        paper.from_axis(p, start),
        "DOP853",
        rtol=1e-11,
        atol=1e-13,
        args=(p,),
    )
    motion = propagator.propagate(m, start, 1.0, 1e-12)
    assert motion.state[8] > 30  # rad/s, under way
    expected, scale = solution.y[:, -1], np.maximum(abs(solution.y).max(axis=1), 1e-6)
    got = paper.from_axis(p, motion.state)
    np.testing.assert_allclose(got / scale, expected / scale, rtol=0, atol=1e-9)


def test_the_unbalances_start_hanging_down():
    p = ODD._replace(initial_phase_1=0.3, initial_phase_2=-0.2)
    state = propagator.start(p, system(p))
    phi_1, phi_2 = paper.from_axis(p, state)[3:5]
    np.testing.assert_allclose([phi_1 - 0.3, phi_2 + 0.2], [-np.pi, np.pi], rtol=1e-14)
    assert not state[[0, 1, 2, 5, 6, 7, 8, 9]].any()


def test_a_symmetric_machine_keeps_its_symmetry():
    p = NOMINAL._replace(stiffness_x=2.07e6, support_offset=0.0)
    hanging = np.pi / 2 + p.working_angle
    p = p._replace(initial_phase_1=hanging + 0.4, initial_phase_2=0.4 - hanging)
    m = system(p)
    times = np.linspace(0, 3, 500)
    motion = propagator.propagate(m, propagator.start(p, m), 3.0, 1e-10, times=times)
    x, y, alpha, psi_1, psi_2 = motion.samples[:, :5].T
    assert psi_1[-1] > 300
    np.testing.assert_allclose(psi_1, psi_2, rtol=0, atol=1e-9)
    np.testing.assert_allclose(alpha, 0, rtol=0, atol=1e-12)
    across = y * np.cos(p.working_angle) - x * np.sin(p.working_angle)
    np.testing.assert_allclose(across, 0, rtol=0, atol=1e-12)
    assert np.hypot(x, y).max() > 2e-3
