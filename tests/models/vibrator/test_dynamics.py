"""The accelerations with the fewest operations, and their derivatives."""

import numpy as np
import pytest
from machines import plausible

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel
from models.numerics.nystrom import layout
from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import systems
from models.vibrator.lanes import dynamics
from models.vibrator.lanes.derivatives import FACTORS, SUPPORTS, change, linearise, support
from models.vibrator.lanes.packed import machine, pack

AT = layout(dynamics.DEGREES)
STEP = 3e-3
MACHINES = systems(
    plausible(
        LANES,
        seed=8,
        mount_stiffness=np.inf,
        mount_rotational_stiffness=np.inf,
        feed_mass=0.0,
        gravity=9.81,
    )
).rigid
CONSTANTS = pack(MACHINES).T.ravel()


@kernel
def _rises(constants, w):
    for lane in range(LANES):
        dynamics.prepare(machine(constants, lane), STEP, w, lane)
    dynamics.accelerate(w)


@kernel
def _changes(constants, w, factors, supports, z, v, out):
    linearise(constants, w, factors)
    support(constants, w[AT.step : AT.end], supports)
    both = np.concatenate((factors, supports))
    for lane in range(LANES):
        at = z[0, lane], z[1, lane], z[2, lane], z[3, lane], z[4, lane]
        rate = v[0, lane], v[1, lane], v[2, lane], v[3, lane], v[4, lane]
        changed = change(both, FACTORS + lane, lane, at, rate)
        for i in range(5):
            out[i, lane] = changed[i]


def states():
    """Return states at any angle, speeds of either sign, bearings far from changing theirs."""
    rng = np.random.default_rng(7)
    position = rng.uniform(-1, 1, (5, LANES)) * np.array([[0.01], [0.01], [0.01], [30], [30]])
    speed = rng.uniform(-1, 1, (5, LANES))
    speed[3:] = rng.choice([-1.0, 1.0], (2, LANES)) * rng.uniform(10, 200, (2, LANES))
    return np.concatenate([position, speed])


def risen(state):
    """Return the accelerations, and the block of lanes in which they were evaluated."""
    w = aligned(dynamics.END)
    w[AT.step : AT.end], w[AT.at : AT.rise] = STEP, state.ravel()
    _rises(CONSTANTS, w)
    return w[AT.rise : AT.step].reshape(5, LANES) / STEP, w


def test_they_are_those_of_the_plain_algebra():
    state = states()
    state[9, ::4] = -state[7, ::4] * np.linspace(0.5, 1.5, LANES // 4)  # bearings of either sign
    accelerations, _ = risen(state)
    for i in range(LANES):
        expected = np.empty(5)
        one_machine = type(MACHINES)._make(float(field[i]) for field in MACHINES)
        rigid_motion.acceleration(one_machine, np.ascontiguousarray(state[:, i]), expected)
        np.testing.assert_allclose(accelerations[:, i], expected, rtol=1e-11)


@pytest.mark.parametrize("variable", range(10))
def test_derivatives_are_those_of_the_accelerations(variable):
    """By differences of fourth order; in the body's motion the accelerations are linear."""
    size = 1e-2 if variable in (3, 4) else 0.2 if variable in (8, 9) else 1.0
    state = states()
    step = size * (np.arange(10) == variable)[:, None]
    near, far = (risen(state + k * step)[0] - risen(state - k * step)[0] for k in (1, 2))
    expected = (8 * near - far) / (12 * size)
    # The body is described at the centre of the supports, rates and accelerations over a step.
    z, v = np.zeros((2, 5, LANES))
    (z if variable < 5 else v)[variable % 5] = 1.0 if variable < 5 else STEP
    z[0] += MACHINES.support_offset * z[2]
    v[0] += MACHINES.support_offset * v[2]
    differences, (_, w) = np.empty((5, LANES)), risen(state)
    _changes(CONSTANTS, w, np.empty(FACTORS), np.empty(SUPPORTS), z, v, differences)
    differences[0] -= MACHINES.support_offset * differences[2]
    off = np.abs(differences / STEP**2 - expected)
    assert np.all(off < 1e-7 * np.abs(expected).max(axis=0))
