"""The algebra of the rigid machine: accelerations as Lagrange's."""

import math

import lagrange
import numpy as np
import paper
from machines import at, plausible

from models.numerics.jit import kernel
from models.vibrator.equations.rigid import accelerations
from models.vibrator.equations.system import systems

MACHINES = plausible(
    30,
    seed=17,
    mount_stiffness=np.inf,
    mount_rotational_stiffness=np.inf,
    feed_mass=0.0,
    gravity=9.81,
)


@kernel
def _evaluate(m, state, out):
    x, y, alpha = state[0], state[1], state[2]
    vx, vy, va, w_1, w_2 = state[5], state[6], state[7], state[8], state[9]
    c_1, s_1 = math.cos(m.working_angle + state[3]), math.sin(m.working_angle + state[3])
    c_2, s_2 = math.cos(m.working_angle - state[4]), math.sin(m.working_angle - state[4])
    motion = accelerations(m, c_1, s_1, c_2, s_2, x, y, alpha, vx, vy, va, w_1, w_2)
    out[0], out[1], out[2], out[3], out[4] = motion


def evaluate(m, state):
    out = np.full(5, np.nan)
    _evaluate(m, state, out)
    return out


def rigid(p):
    return [systems(p).row(i).rigid for i in range(len(p.body_mass))]


def random_states(count, seed):
    """Return states at any angle and speed, the body as restless as a few metres per second."""
    rng = np.random.default_rng(seed)
    states = rng.normal(size=(count, 10))
    states[:, 3:5] = rng.uniform(-10, 10, size=(count, 2))
    senses = rng.choice([-1.0, 1.0], size=(count, 2))
    states[:, 8:] = senses * rng.uniform(10, 200, size=(count, 2))  # bearings keep their sign
    return states


def test_accelerations_are_lagranges():
    for i, (m, state) in enumerate(zip(rigid(MACHINES), random_states(30, 1), strict=True)):
        q, v = np.append(state[:5], [0, 0]), np.append(state[5:], [0, 0])
        expected = lagrange.acceleration(at(MACHINES, i), False, False, 0.0, q, v)[:5]
        np.testing.assert_allclose(
            evaluate(m, state), expected, rtol=0, atol=1e-12 * abs(expected).max()
        )


def test_accelerations_are_those_of_the_printed_equations():
    centred = MACHINES._replace(
        axis_offset=np.zeros(30), mount_mass=np.zeros(30), mount_inertia=np.zeros(30)
    )
    for i, (m, state) in enumerate(zip(rigid(centred), random_states(30, 2), strict=True)):
        p = at(centred, i)
        expected = paper.rates(0.0, paper.from_axis(p, state), p)[5:]
        np.testing.assert_allclose(
            evaluate(m, state), expected, rtol=0, atol=1e-12 * abs(expected).max()
        )
