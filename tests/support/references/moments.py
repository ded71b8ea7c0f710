"""The vibratory moments, whose difference the paper's formulas approximate."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.numerics.jit import kernel
from models.vibrator.parameters import Rows
from models.vibrator.theory.averaged import broadcast
from models.vibrator.theory.balance import moments
from models.vibrator.theory.linear_machine import machines
from models.vibrator.theory.receptance import respond


@kernel
def _brake(bodies, speed, angle, out):
    for i in range(len(bodies)):
        a = bodies[i]
        g = respond(a, speed[i])
        l1, l2, _, _ = moments(a, g, speed[i], math.cos(angle[i]), math.sin(angle[i]))
        out[0, i], out[1, i] = l1, l2


def vibratory_moments(
    p: Rows, speed: ArrayLike, angle: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean moments with which the vibrating body drives the two rotors.

    L_1 and L_2 in the direction of rotation [N m]; arguments as of `steady_motion`.
    """
    p, (speed, angle) = broadcast(p, speed, angle)
    out = np.empty((2, len(speed)))
    _brake(machines(p), speed, angle, out)
    return out[0], out[1]
