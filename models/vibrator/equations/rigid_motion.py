"""Equations of motion (13)-(23) of Michalczyk & Cieplok 2014: two unbalanced motors on a body.

The body moves by x, y and turns by alpha; an unbalance points along theta_1 = beta + psi_1
(counter-clockwise) or theta_2 = beta - psi_2 (clockwise). With s_i the levers of the shafts and
n_i = (cos theta_i, sin theta_i), the masses m are at (x, y) + s_i + alpha e_z x s_i + e_i n_i:
the geometry is frozen at alpha = 0, and the forces still derive from a Lagrangian. As in (15), the
body feels no reaction to the torques of motors and bearings.

Gravity, which (13) to (23) neglect, has the potential g sum m e_i sin theta_i. As the angles psi_i
are measured from a fixed axis, it acts on psi_i alone, with the moment -m e_1 g cos theta_1 or
+m e_2 g cos theta_2. All other weights are constant forces on x, y and alpha, which the supports
carry: x, y and alpha are measured from equilibrium.

`acceleration` applies to the machine with its motors bolted to the body and no feed; for all else
see `models.vibrator.equations.general`.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel
from models.vibrator.equations.rigid import accelerations
from models.vibrator.parameters import Rows

DEGREES = 5
"""x, y, alpha, psi_1, psi_2. A state is these [m, rad], then their rates [m s-1, rad s-1]."""


def initial_state(p: Rows) -> NDArray[np.float64]:
    """Return n machines at rest, the unbalances at their initial phases from hanging down.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).

    Returns
    -------
    ndarray, shape (n, 10)
    """
    state = np.zeros((len(p.working_angle), 2 * DEGREES))
    state[:, 3] = -(np.pi / 2 + p.working_angle) + p.initial_phase_1
    state[:, 4] = np.pi / 2 + p.working_angle + p.initial_phase_2
    return state


@kernel
def acceleration(m, state, out):
    """Set out[:5] to the accelerations by `models.vibrator.equations.rigid`.

    Parameters
    ----------
    m : Rigid
    state : ndarray, shape (10,)
    out : ndarray, shape (>= 5,)
    """
    x, y, alpha = state[0], state[1], state[2]
    vx, vy, va, w_1, w_2 = state[5], state[6], state[7], state[8], state[9]
    theta_1, theta_2 = m.working_angle + state[3], m.working_angle - state[4]
    c_1, s_1 = math.cos(theta_1), math.sin(theta_1)
    c_2, s_2 = math.cos(theta_2), math.sin(theta_2)
    motion = accelerations(m, c_1, s_1, c_2, s_2, x, y, alpha, vx, vy, va, w_1, w_2)
    out[0], out[1], out[2] = motion.x, motion.y, motion.alpha
    out[3], out[4] = motion.psi_1, motion.psi_2
