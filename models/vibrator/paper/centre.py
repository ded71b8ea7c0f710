"""The body about its mass centre WITH both unbalanced masses, as the closed formulas require.

Lengths and inertias about C, the mass centre of the bare body, cause errors of up to 20 % in K.
Arguments may be numbers or arrays that broadcast.
"""

from typing import Any, NamedTuple

import numpy as np


class Centre(NamedTuple):
    """The body with both unbalanced masses on their shafts, about its mass centre.

    Attributes
    ----------
    mass : float
        M = M_k + 2m [kg].
    inertia : float
        J [kg m2].
    shift : float
        Of that centre from C along xi [m].
    along, half : float
        R and r = D sin gamma: shafts at R, +-r from it [m].
    offset : float
        w_off, of the midpoint of the shafts from the axis through it along xi [m].
    """

    mass: Any
    inertia: Any
    shift: Any
    along: Any
    half: Any
    offset: Any

    @property
    def distance(self) -> Any:
        """D = sqrt(R^2 + r^2), the distance to each shaft if they are not off centre [m]."""
        return np.hypot(self.along, self.half)


def combined_centre(
    body_mass: Any,
    body_inertia: Any,
    unbalanced_mass: Any,
    shaft_distance: Any,
    shaft_half_angle: Any,
    axis_offset: Any = 0.0,
) -> Centre:
    """Return mass, inertia and shafts about the mass centre to which the formulas refer.

    Parameters
    ----------
    body_mass, unbalanced_mass : array_like
        M_k and m [kg].
    body_inertia : array_like
        J_Ck about C [kg m2].
    shaft_distance, axis_offset : array_like
        D and w_C, from C [m].
    shaft_half_angle : array_like
        gamma [rad].

    Returns
    -------
    Centre
    """
    along, half = (
        shaft_distance * np.cos(shaft_half_angle),
        shaft_distance * np.sin(shaft_half_angle),
    )
    mass = body_mass + 2 * unbalanced_mass
    share = 2 * unbalanced_mass / mass
    lever = along**2 + axis_offset**2
    inertia = body_inertia + 2 * unbalanced_mass * (half**2 + lever) - mass * share**2 * lever
    return Centre(
        mass, inertia, share * along, (1 - share) * along, half, (1 - share) * axis_offset
    )


def reduced_mass(mass: Any, stiffness: Any, speed: Any) -> Any:
    """Return M' = M - k/w^2 [kg]: the effective mass on springs at speed w [rad s-1]."""
    return mass - stiffness / speed**2


def reduced_inertia(inertia: Any, stiffness_y: Any, half_spacing: Any, speed: Any) -> Any:
    """Return J' = J - k_y l^2/w^2 [kg m2], for supports level with the mass centre."""
    return inertia - stiffness_y * half_spacing**2 / speed**2
