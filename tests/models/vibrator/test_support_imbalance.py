"""Supports of unequal stiffness: equations, averaged theory, lanes and orbits agree."""

import lagrange
import numpy as np
import pytest
from machines import at, plausible, twin
from moments import vibratory_moments
from scipy.integrate import solve_ivp

from models.vibrator import lanes
from models.vibrator.equations import general, rigid_motion
from models.vibrator.equations.system import system, systems
from models.vibrator.exact import propagator
from models.vibrator.lanes import orbit, tangents
from models.vibrator.lanes.machines import prepared
from models.vibrator.lanes.packed import STATE, pack
from models.vibrator.parameters import Params
from models.vibrator.theory.averaged import disphasing, steady_motion

RIGID = {"mount_stiffness": np.inf, "mount_rotational_stiffness": np.inf, "feed_mass": 0.0}
ROWS = 8
UNEQUAL = np.linspace(-0.9, 0.9, ROWS)
MACHINES = plausible(ROWS, seed=21, **RIGID)._replace(support_imbalance=UNEQUAL)
MOUNTED = Params(
    unbalance_2=4.0,
    axis_offset=0.1,
    mount_stiffness=1e6,
    mount_angle=0.4,
    mount_mass=150.0,
    mount_damping_ratio=0.05,
    mount_rotational_stiffness=3e5,
    mount_inertia=8.0,
    feed_mass=120.0,
    feed_position=0.7,
    gravity=9.81,
    voltage_factor=0.9,
    support_imbalance=0.3,
)


def rates(t, state, p):
    """Return the rates of a rigid machine from forces on each of its points, written anew."""
    x, y, a, psi_1, psi_2, vx, vy, va, w_1, w_2 = state
    m, me = p.unbalanced_mass, np.array([p.unbalance_1, p.unbalance_2])
    angle = np.array([p.working_angle + psi_1, p.working_angle - psi_2])
    spin, sense = np.array([w_1, -w_2]), np.array([1.0, -1.0])
    seen = p.working_angle + p.shaft_half_angle * sense
    shaft_x, shaft_y = p.shaft_distance * np.cos(seen), p.shaft_distance * np.sin(seen)
    # Unknowns: x'', y'', alpha'', and the turning accelerations of both unbalances.
    matrix, right = np.zeros((5, 5)), np.zeros(5)
    matrix[0, 0] = matrix[1, 1] = p.body_mass
    matrix[2, 2] = p.body_inertia
    for i in range(2):
        e = me[i] / m
        out, along = e * np.cos(angle[i]), e * np.sin(angle[i])
        jacobian = np.zeros((2, 5))
        jacobian[0, [0, 2, 3 + i]] = 1, -shaft_y[i], -along
        jacobian[1, [1, 2, 3 + i]] = 1, shaft_x[i], out
        matrix += m * jacobian.T @ jacobian
        right -= m * jacobian.T @ (-(spin[i] ** 2) * np.array([out, along]))
        matrix[3 + i, 3 + i] += p.rotor_inertia
        w = sense[i] * spin[i]
        top = (p.synchronous_speed_1, p.synchronous_speed_2)[i]
        slip = top - (p.breakdown_speed_1, p.breakdown_speed_2)[i]
        rated = (p.rated_torque_1, p.rated_torque_2)[i]
        rho = (p.bearing_constant_1, p.bearing_constant_2)[i]
        torque = 2 * p.overload_capacity * rated * slip * (top - w) / (slip**2 + (top - w) ** 2)
        torque -= rho * me[i] * w**2 * np.sign(w - sense[i] * va)
        right[3 + i] += sense[i] * torque
    damping = [
        2 * p.damping_ratio * np.sqrt((p.body_mass + 2 * m) * k)
        for k in (p.stiffness_x, p.stiffness_y)
    ]
    for side in (-1, 1):
        share = (1 + side * p.support_imbalance) / 2
        lever = side * p.support_half_spacing
        pull_x = p.stiffness_x * (x + p.support_offset * a)
        pull_x = share * (pull_x + damping[0] * (vx + p.support_offset * va))
        pull_y = share * (p.stiffness_y * (y + lever * a) + damping[1] * (vy + lever * va))
        right[0] -= pull_x
        right[1] -= pull_y
        right[2] -= p.support_offset * pull_x + lever * pull_y
    risen = np.linalg.solve(matrix, right)
    return np.concatenate([state[5:], risen[:3], [risen[3], -risen[4]]])


def test_a_start_is_that_of_another_integrator_on_equations_of_its_own():
    p = Params(support_imbalance=0.35, rated_torque_2=200.0, damping_ratio=0.04)
    m = system(p)
    start = propagator.start(p, m)
    other = solve_ivp(rates, (0, 1), start, "DOP853", rtol=1e-11, atol=1e-13, args=(p,))
    end = propagator.propagate(m, start, 1.0, 1e-12).state
    scale = np.maximum(abs(other.y).max(axis=1), 1e-6)
    assert end[8] > 30 and abs(end[2]) > 1e-5
    np.testing.assert_allclose(end / scale, other.y[:, -1] / scale, rtol=0, atol=1e-9)


def test_accelerations_of_the_rigid_machine_are_lagranges():
    rng = np.random.default_rng(1)
    for i in range(ROWS):
        p, state, out = at(MACHINES, i), rng.normal(size=10), np.empty(5)
        state[8:] = rng.uniform(10, 160, size=2)
        rigid_motion.acceleration(system(p).rigid, state, out)
        q, v = np.append(state[:5], [0, 0]), np.append(state[5:], [0, 0])
        expected = lagrange.acceleration(p, False, False, 0.0, q, v)[:5]
        np.testing.assert_allclose(out, expected, rtol=0, atol=1e-12 * abs(expected).max())


@pytest.mark.parametrize("riding", [True, False])
@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_accelerations_of_the_general_machine_are_lagranges(kinematics, riding):
    m, rng = system(MOUNTED, kinematics), np.random.default_rng(7)
    for _ in range(20):
        q, v = rng.normal(size=(2, 7))
        v[3:5] = rng.uniform(-50, 160, size=2)
        out = np.array(general.accelerations(m, riding, np.concatenate([q, [0.3], v, [-0.8]])))
        exact = kinematics == "exact"
        expected = lagrange.acceleration(MOUNTED, exact, riding, m.feed_gravity, q, v)
        np.testing.assert_allclose(out[:7], expected, rtol=0, atol=1e-12 * abs(expected).max())


@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_energy_is_conserved_without_motors_and_losses(kinematics):
    p = Params(
        damping_ratio=0.0,
        bearing_constant_1=0.0,
        bearing_constant_2=0.0,
        voltage_factor=0.03,
        rated_torque_1=8.0,
        rated_torque_2=8.0,
        support_imbalance=0.6,
    )
    m = system(p, kinematics)
    rigid = m.rigid._replace(torque_1=0.0, torque_2=0.0)
    m = m._replace(rigid=rigid)
    state = rigid_motion.initial_state(Params._make(np.array([v]) for v in p))[0]
    state[:3], state[8:] = (2e-3, -3e-3, 4e-3), (60.0, 55.0)
    state = general.extend(state) if kinematics == "exact" else state
    times = np.linspace(0, 1, 50)
    samples = propagator.propagate(m, state, 1.0, 1e-13, times=times).samples
    energy, n = lagrange.mechanics(kinematics == "exact").energy, samples.shape[1] // 2
    q, v = np.zeros((2, len(times), 7))
    q[:, :5], v[:, :5] = samples[:, :5], samples[:, n : n + 5]
    values = [float(energy(lagrange.values(p), 0.0, 0.0, *pair)) for pair in zip(q, v, strict=True)]
    assert np.ptp(samples[:, 2]) > 1e-3
    np.testing.assert_allclose(values, values[0], rtol=1e-11)


def test_the_averaged_theory_is_that_of_point_masses_on_springs():
    rows = 40
    rng = np.random.default_rng(2)
    p = plausible(rows, seed=1)._replace(support_imbalance=rng.uniform(-0.9, 0.9, rows))
    w, dphi = rng.uniform(20.0, 200.0, rows), rng.uniform(-np.pi, np.pi, rows)
    moments = np.stack(vibratory_moments(p, w, dphi), axis=1)
    motion = np.stack(steady_motion(p, w, dphi), axis=1)
    for i in range(rows):
        slow = twin(at(p, i), w[i], dphi[i])
        np.testing.assert_allclose(motion[i], slow.amplitudes, rtol=1e-9, atol=1e-14)
        np.testing.assert_allclose(moments[i], slow.moments, rtol=1e-9, atol=1e-9)


def test_lanes_agree_with_the_exact_propagator():
    machines, state = prepared(MACHINES), rigid_motion.initial_state(MACHINES)
    ends = [
        propagator.propagate(systems(MACHINES).row(i), state[i], 1.0, 1e-13).state
        for i in range(ROWS)
    ]
    steps, nowhere = 1200, np.full(ROWS, np.nan)
    lanes.advance(machines, state, np.full(ROWS, 1 / steps), nowhere, steps, 0.05, False)
    for i in range(ROWS):
        scales = propagator.scales_of(systems(MACHINES).row(i), rigid_motion.DEGREES)
        np.testing.assert_allclose(state[i] / scales, ends[i] / scales, rtol=0, atol=1e-8)


def test_orbits_close_and_their_multipliers_are_those_of_the_passages():
    guess = disphasing(MACHINES)
    state = np.zeros((ROWS, STATE))
    motion = steady_motion(MACHINES, guess.speed, guess.angle)
    for i, amplitude in enumerate(motion[:3]):
        state[:, i], state[:, 5 + i] = amplitude.real, (1j * guess.speed * amplitude).real
    state[:, 4], state[:, 8], state[:, 9] = -guess.angle, guess.speed, guess.speed
    orbits = orbit.find_orbits(pack(systems(MACHINES).rigid), state, 2 * np.pi / guess.speed, 192)
    assert orbits.converged.sum() >= ROWS - 1
    for i in np.flatnonzero(orbits.converged):
        m = systems(MACHINES).row(i)
        scales = 1e-5 * propagator.scales_of(m, rigid_motion.DEGREES)
        columns = []
        for k in tangents.FREE:
            ends = [
                propagator.propagate(
                    m,
                    orbits.state[i] + side * scales * (np.arange(STATE) == k),
                    2 * orbits.period[i],
                    1e-13,
                    turns=1,
                ).state[tangents.FREE]
                for side in (1, -1)
            ]
            columns.append((ends[0] - ends[1]) / (2 * scales[k]))
        largest = abs(np.linalg.eigvals(np.array(columns).T)).max()
        np.testing.assert_allclose(orbits.multiplier[i], largest, rtol=0, atol=1e-6)


def test_a_mirrored_machine_moves_in_the_mirror():
    """Left and right exchanged, with the motors, the angle has the same magnitude."""
    p = Params(support_imbalance=0.4, stiffness_x=2.07e6, working_angle=np.pi / 2)
    here = Params._make(np.array([value]) for value in p)
    other = here._replace(support_imbalance=-here.support_imbalance)
    angle, mirrored = disphasing(here).angle, disphasing(other).angle
    assert abs(angle[0]) > 1e-3
    np.testing.assert_allclose(mirrored, -angle, rtol=1e-9)
