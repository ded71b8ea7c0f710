"""The error-controlled propagator: what is conserved, and the flights of the feed."""

import math

import lagrange
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.numerics.dop853 import GUARDED, OUT_OF_BUDGET, REACHED_END
from models.vibrator.equations import general
from models.vibrator.equations.system import system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params

FREE = Params(
    rated_torque_1=0.0,
    rated_torque_2=0.0,
    bearing_constant_1=0.0,
    bearing_constant_2=0.0,
    damping_ratio=0.0,
    unbalance_2=4.0,
    axis_offset=0.1,
)
FLEXIBLE = FREE._replace(
    mount_stiffness=5e6, mount_rotational_stiffness=3e6, mount_mass=100.0, mount_inertia=6.0
)
FED = Params(feed_mass=300.0, throw_coefficient=1.75, feed_position=0.4, damping_ratio=0.07)


HEAVY = FLEXIBLE._replace(gravity=9.81)


@pytest.mark.parametrize(
    "p", [FREE, FLEXIBLE, FREE._replace(feed_mass=200.0), FREE._replace(gravity=9.81), HEAVY]
)
@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_energy_is_conserved_without_motors_and_losses(kinematics, p):
    """The geometry frozen at alpha = 0 has an energy too: it is that of the linear embedding."""
    m = system(p, kinematics)._replace(feed_gravity=1e6)  # the feed, if any, stays on the deck
    start = propagator.start(p, m)
    start[:3], rates = (5e-3, -3e-3, 4e-3), len(start) // 2
    start[rates + 3 : rates + 5] = 110.0, 95.0
    motion = propagator.propagate(m, start, 2.0, 1e-13, times=np.linspace(0, 2, 50))
    energy = lagrange.mechanics(kinematics == "exact").energy
    values, arms = lagrange.values(p), np.zeros((2, len(motion.samples), 7))
    states = motion.samples.reshape(len(motion.samples), 2, rates).swapaxes(0, 1)
    arms[:, :, : min(rates, 7)] = states[:, :, :7]
    energies = np.array([energy(values, 1.0, 0.0, q, v) for q, v in zip(*arms, strict=True)])
    assert np.ptp(arms[1, :, 3]) > 1  # rotors and body exchange energy
    np.testing.assert_allclose(energies / energies[0], 1, rtol=0, atol=1e-12)


def test_turns_are_whole():
    p = Params()
    m = system(p)
    start = propagator.start(p, m)
    motion = propagator.propagate(m, start, 60.0, 1e-10, turns=40)
    assert motion.status == GUARDED
    np.testing.assert_allclose(motion.state[3] - start[3], 80 * math.pi, rtol=1e-14)
    again = propagator.propagate(m, start, motion.time, 1e-10)
    np.testing.assert_allclose(motion.state, again.state, rtol=0, atol=1e-8)
    assert propagator.propagate(m, start, 0.1, 1e-10, turns=40).status == REACHED_END


def test_a_machine_too_stiff_to_follow_runs_out_of_budget():
    p = Params(mount_stiffness=1e17, mount_damping_ratio=1.0)
    m = system(p)
    motion = propagator.propagate(m, propagator.start(p, m), 0.1, 1e-8, times=[0.0, 0.1])
    assert motion.status == OUT_OF_BUDGET
    assert 0 < motion.time < 0.1
    assert np.isnan(motion.samples[1]).all()


def fed_by_scipy(p, kinematics, gravity, start, end):
    """Follow the feed mode by mode with scipy's events; return times of changes and the state."""
    frozen = kinematics == "small"
    q, v = np.zeros(7), np.zeros(7)
    q[:5], v[:5] = start[:5], start[8:13]
    state, riding, t, changes = np.concatenate([q, v, [0.0, 0.0]]), True, 0.0, []

    def deck(state, a):
        angle = 0.0 if frozen else state[2]
        turning = math.cos(angle) * a[2] - (0.0 if frozen else math.sin(angle) * state[9] ** 2)
        return a[1] + p.feed_position * turning

    def accelerate(state, riding):
        return lagrange.acceleration(p, not frozen, riding, gravity, state[:7], state[7:14])

    def rates(t, state, riding):
        a = accelerate(state, riding)
        fall = 0.0 if riding else -gravity - deck(state, a)
        return np.concatenate([state[7:14], a, [state[15], fall]])

    def lifts(t, state, riding):
        return gravity + deck(state, accelerate(state, True))

    def lands(t, state, riding):
        return state[14] + (1e-30 if state[15] > 0 else 0.0)

    for event in (lifts, lands):
        event.terminal, event.direction = True, -1
    while t < end:
        if riding and lifts(t, state, True) < 0:  # no sign change: the deck falls away at once
            changes.append(t)
            riding = False
        done = solve_ivp(
            rates,
            (t, end),
            state,
            "DOP853",
            events=lifts if riding else lands,
            args=(riding,),
            rtol=1e-11,
            atol=1e-13,
            max_step=2e-3,
        )
        t, state = done.t[-1], done.y[:, -1]
        if done.status != 1:
            break
        changes.append(t)
        if not riding:
            reach = np.zeros(7)
            reach[1:3] = 1, p.feed_position * (1.0 if frozen else math.cos(state[2]))
            mass = lagrange.mechanics(not frozen).mass(
                lagrange.values(p), 1.0, 0.0, state[:7], state[7:14]
            )
            at = lagrange.free(p)
            impulse = p.feed_mass * state[15] * reach[at]
            state[7:14][at] += np.linalg.solve(mass[np.ix_(at, at)], impulse)
        state[14:] = 0.0
        riding = not riding
    return np.array(changes), state


@pytest.mark.parametrize("kinematics", ["small", "exact"])
def test_the_feed_flies_and_lands_as_by_scipy(kinematics):
    m = system(FED, kinematics)
    start = propagator.start(FED, m)
    start[11:13] = 150.0  # already fast
    end = 0.4
    changes, expected = fed_by_scipy(FED, kinematics, m.feed_gravity, start, end)
    assert len(changes) > 8
    times = np.linspace(0, end, 20_001)
    motion = propagator.propagate(m, start, end, 1e-12, times=times)
    q, v = motion.state[:8], motion.state[8:]
    np.testing.assert_allclose(q[[0, 1, 2, 7]], expected[[0, 1, 2, 14]], rtol=0, atol=1e-11)
    np.testing.assert_allclose(q[3:5], expected[3:5], rtol=0, atol=1e-9)
    np.testing.assert_allclose(v[3:5], expected[10:12], rtol=1e-9)
    flying = np.searchsorted(changes, times) % 2 == 1
    clear = abs(times[:, None] - changes).min(axis=1) > 1e-8
    np.testing.assert_array_equal((motion.samples[:, 7] > 0)[clear], flying[clear])


@pytest.mark.parametrize(("throw", "position"), [(0.9, 0.0), (1.5, -1.2), (2.97, 0.0), (5.8, -1.2)])
def test_the_feed_is_never_below_the_deck_nor_pulled_by_it(throw, position):
    p = FED._replace(throw_coefficient=throw, feed_position=position)
    m = system(p)
    motion = propagator.propagate(
        m, propagator.start(p, m), 4.0, 1e-9, times=np.linspace(0, 4, 8001)
    )
    assert motion.status == REACHED_END
    height = motion.samples[:, 7]
    assert height.min() == 0
    assert (height > 0).any() == (throw > 1 or height[:4000].any())
    push = [general.support_of_feed(m, state) for state in motion.samples[height == 0]]
    assert min(push) > -1e-6 * m.feed_gravity


def test_the_throw_coefficient_is_that_of_the_running_deck():
    """A feed so light that the deck does not feel it."""
    p = FED._replace(feed_mass=1e-6, throw_coefficient=1.7, stiffness_x=2.07e6, support_offset=0.0)
    m = system(p)
    times = np.linspace(7.9, 8.0, 2001)
    motion = propagator.propagate(m, propagator.start(p, m), 8.0, 1e-8, times=times)
    deck = motion.samples[:, 1] + p.feed_position * motion.samples[:, 2]
    amplitude, speed = np.ptp(deck) / 2, motion.samples[:, 11].mean()
    np.testing.assert_allclose(amplitude * speed**2 / m.feed_gravity, 1.7, rtol=0.01)


def test_small_and_exact_kinematics_meet_as_the_motion_becomes_small():
    """Their difference goes with the square of the displacements over the levers."""
    gaps = []
    for scale in (1.0, 0.1):
        p = FREE._replace(unbalance_1=5.0 * scale, unbalance_2=4.0 * scale)
        states = []
        for kinematics in ("small", "exact"):
            m = system(p, kinematics)
            start = general.extend(propagator.start(p, system(p)))
            start[11:13] = 100.0
            states.append(propagator.propagate(m, start, 0.2, 1e-12).state[:3] / scale)
        gaps.append(abs(states[1] - states[0]).max())
    assert gaps[0] > 1e-8
    assert gaps[1] < 0.15 * gaps[0]


@pytest.mark.parametrize(
    ("stiffness_x", "support_offset", "low", "high"),
    [(6.21e5, 0.0, -0.052, -0.051), (6.21e5, -0.4, -0.046, -0.045), (2.07e6, -0.4, 0.027, 0.028)],
)
def test_rubber_supports_disphase_the_motors_as_published(stiffness_x, support_offset, low, high):
    """Rows 5, 6 and 8 of Table 1, known as 1.55 to 2.98 degrees; row 7 is symmetric, hence 0."""
    p = Params(damping_ratio=0.07, stiffness_x=stiffness_x, support_offset=support_offset)
    m = system(p)
    settled = propagator.propagate(m, propagator.start(p, m), 12.0, 1e-8).state
    turn = propagator.propagate(m, settled, 1.0, 1e-8, turns=1).time
    times = np.linspace(0, turn, 100, endpoint=False)
    samples = propagator.propagate(m, settled, turn, 1e-8, times=times).samples
    angle = math.remainder((samples[:, 3] - samples[:, 4]).mean(), 2 * math.pi)
    assert low < angle < high
    rotation = 2 * abs((samples[:, 2] * np.exp(-2j * np.pi * times / turn)).mean())
    assert 5e-5 < rotation < 8e-5
