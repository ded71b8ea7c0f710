"""Shapes of wear scars: the volume worn off as a power of the depth, and its inverse.

    V = B h^p;    beyond h = theta L of a bar inclined by theta, V = B [h^p - (h - theta L)^p]

where h is the depth in both bodies together, the growth of the gap by wear. The depth in the rod is
h/(1 + kappa), if the support loses kappa times the volume that the rod loses.

Source: volumes and depths of scars in Code_Aster, documentation of POST_USURE. The dimple between
crossed cylinders is the volume of a paraboloid.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from models.numerics.jit import kernel

SCARS = ("prismatic", "flat-bar", "dimple", "inclined")
"""Shapes: (B, p) are (S, 1), (4/3 L sqrt(2 R), 3/2), (pi sqrt(R R_s), 2),
(8 sqrt(2 R)/(15 theta), 5/2)."""

_ITERATIONS = 100
_CONVERGED = 1e-15


class Scar(NamedTuple):
    """Scars of n rows.

    Attributes
    ----------
    factor, power : ndarray, shape (n,)
        B [m^(3-p)], p [1].
    tilt : ndarray, shape (n,)
        theta L of an inclined bar [m], inf for other shapes.
    """

    factor: Any
    power: Any
    tilt: Any


def scar(
    shape: str, area: Any, radius: Any, width: Any, support_radius: Any, inclination: Any
) -> Scar:
    """Return the scars of n rows.

    Parameters
    ----------
    shape : str
        One of `SCARS`.
    area : ndarray, shape (n,)
        S, of a prismatic scar [m2].
    radius, width, support_radius : ndarray, shape (n,)
        R of the rod, L and R_s of the support [m].
    inclination : ndarray, shape (n,)
        theta [rad].
    """
    everywhere = np.ones_like(area)
    if shape == "prismatic":
        return Scar(area, everywhere, np.inf * everywhere)
    if shape == "flat-bar":
        return Scar(4 / 3 * width * np.sqrt(2 * radius), 1.5 * everywhere, np.inf * everywhere)
    if shape == "dimple":
        return Scar(np.pi * np.sqrt(radius * support_radius), 2 * everywhere, np.inf * everywhere)
    factor = 8 * np.sqrt(2 * radius) / (15 * inclination)
    return Scar(factor, 2.5 * everywhere, inclination * width)


@kernel
def scar_volume(depth, factor, power, tilt):
    """Return the volume of a scar of a depth."""
    volume = factor * math.pow(depth, power)
    if depth > tilt:
        volume -= factor * math.pow(depth - tilt, power)
    return volume


@kernel
def scar_depth(volume, factor, power, tilt):
    """Return the depth of a scar of a volume.

    Beyond h = theta L the volume is convex in h. Newton's method begins on the tangent at theta L,
    which is beyond the root, and approaches it from there.
    """
    if volume <= 0:
        return 0.0
    if power == 1:
        return volume / factor
    depth = math.pow(volume / factor, 1 / power)
    if depth <= tilt:
        return depth
    slope = factor * power * math.pow(tilt, power - 1)
    depth = tilt + (volume - scar_volume(tilt, factor, power, tilt)) / slope
    for _ in range(_ITERATIONS):
        slope = math.pow(depth, power - 1) - math.pow(depth - tilt, power - 1)
        excess = scar_volume(depth, factor, power, tilt) - volume
        back = excess / (factor * power * slope)
        depth = max(depth - back, tilt)
        if not back > _CONVERGED * depth:
            break
    return depth


@kernel
def oxide_volume(thickness, wear_factor, kappa, factor, power, tilt):
    """Return the volume of both bodies' scar at which the rod's has passed its oxide.

    An oxide layer of 2 to 30 um wears more slowly than the metal below it: pre-oxidised cladding by
    about 15 times, by depth. It is 0 where oxide wears like the metal.

    Parameters
    ----------
    thickness : float
        Depth of the rod's scar down to which oxide wears [m].
    wear_factor : float
        Rate of wear of the oxide over that of the metal.
    kappa : float
        Volume worn off the support over that worn off the rod.
    factor, power, tilt : float
        As in `Scar`.
    """
    if wear_factor == 1:
        return 0.0
    return scar_volume((1 + kappa) * thickness, factor, power, tilt)
