"""The accelerations with the fewest operations against those of the plain algebra."""

import numpy as np
from machines import plausible

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel
from models.numerics.nystrom import layout
from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import systems
from models.vibrator.lanes import dynamics
from models.vibrator.lanes.packed import machine, pack

AT = layout(dynamics.DEGREES)
STEP = 3e-3


@kernel
def _rises(constants, w):
    for lane in range(LANES):
        dynamics.prepare(machine(constants, lane), STEP, w, lane)
    dynamics.accelerate(w)


def test_they_are_those_of_the_plain_algebra():
    rng = np.random.default_rng(7)
    p = plausible(
        LANES, seed=8, mount_stiffness=np.inf, mount_rotational_stiffness=np.inf, feed_mass=0.0
    )
    m, w = systems(p), aligned(dynamics.END)
    position = rng.uniform(-1, 1, (5, LANES)) * np.array([[0.01], [0.01], [0.01], [30], [30]])
    speed = rng.uniform(-1, 1, (5, LANES)) * np.array([[1], [1], [1], [200], [200]])
    speed[4, ::4] = -speed[2, ::4] * rng.uniform(0.5, 1.5, len(speed[4, ::4]))  # of either sign
    w[AT.at : AT.speed], w[AT.speed : AT.rise] = position.ravel(), speed.ravel()
    _rises(pack(m.rigid).T.ravel(), w)
    risen = w[AT.rise : AT.step].reshape(5, LANES)
    for i in range(LANES):
        expected = np.empty(5)
        state = np.concatenate([position[:, i], speed[:, i]])
        rigid_motion.acceleration(m.row(i).rigid, state, expected)
        np.testing.assert_allclose(risen[:, i], STEP * expected, rtol=1e-11)
