"""The motor set with its unbalanced masses, and the damping of springs by a ratio.

C is the mass centre of the bare body; see `models.vibrator.parameters`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.elementary import cos, sin
from models.vibrator.parameters import Rows


class MotorSet(NamedTuple):
    """The motor sets of n machines, unbalanced masses included.

    Attributes
    ----------
    along, half : ndarray, shape (n,)
        R and r [m]: along the working axis from C, the shafts are at R; across it, at r to either
        side of their midpoint.
    mass, inertia : ndarray, shape (n,)
        m_0 [kg], and J_0 about the midpoint of the shafts [kg m2].
    """

    along: Any
    half: Any
    mass: Any
    inertia: Any


def motor_set(p: Rows) -> MotorSet:
    """Return the motor sets of n machines, each field of p of shape (n,)."""
    half = p.shaft_distance * sin(p.shaft_half_angle)
    return MotorSet(
        along=p.shaft_distance * cos(p.shaft_half_angle),
        half=half,
        mass=p.mount_mass + 2 * p.unbalanced_mass,
        inertia=p.mount_inertia + 2 * p.unbalanced_mass * half**2,
    )


def damping(ratio: Any, mass: Any, stiffness: Any) -> NDArray[np.float64]:
    """Return b = 2 ratio sqrt(m k) [N s m-1], or of a rotation [N m s]; 0 for a rigid spring."""
    return 2 * ratio * np.sqrt(mass * np.where(np.isinf(stiffness), 0.0, stiffness))
