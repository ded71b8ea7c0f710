"""The machine in the averaged theory: constants of its linear response."""

from typing import Any, NamedTuple

import numpy as np

from models.numerics.elementary import cos, sin
from models.vibrator.parameters import Rows
from models.vibrator.theory.feed import apparent_mass
from models.vibrator.theory.motor_set import damping, motor_set


class Machine(NamedTuple):
    """Constants of a machine's linear response; n machines if the fields are arrays.

    Attributes
    ----------
    c, s : float
        Cosine and sine of the working angle.
    along, across, half : float
        R, w_C and r, the positions of the shafts [m].
    mass, inertia : float
        Of everything that vibrates, about C [kg, kg m2].
    set_mass, set_inertia : float
        Of the motor set, unbalanced masses included, about the midpoint of the shafts.
    stiffness_x, damping_x, stiffness_y, damping_y, offset, spacing, lever : float
        Supports: k_x, b_x, k_y, b_y, h, l, and l times the imbalance.
    slide_xi, slide_eta : float
        Unit vector of the mount's direction.
    slide_stiffness, slide_damping, turn_stiffness, turn_damping : float
        Mounts; a rigid one has infinite stiffness and no damping.
    feed, feed_loss, feed_position : float
        Real and imaginary part of the apparent mass of the feed [kg], and its position [m].
    unbalance_1, unbalance_2 : float
        m e_i [kg m].
    """

    c: Any
    s: Any
    along: Any
    across: Any
    half: Any
    mass: Any
    inertia: Any
    set_mass: Any
    set_inertia: Any
    stiffness_x: Any
    damping_x: Any
    stiffness_y: Any
    damping_y: Any
    offset: Any
    spacing: Any
    lever: Any
    slide_xi: Any
    slide_eta: Any
    slide_stiffness: Any
    slide_damping: Any
    turn_stiffness: Any
    turn_damping: Any
    feed: Any
    feed_loss: Any
    feed_position: Any
    unbalance_1: Any
    unbalance_2: Any


def machines(p: Rows) -> np.recarray[Any, Any]:
    """Return the `Machine` of each of n rows.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).

    Returns
    -------
    recarray, shape (n,)
        Each a record with the fields of `Machine`.
    """
    along, half, set_mass, set_inertia = motor_set(p)
    sprung = p.body_mass + 2 * p.unbalanced_mass
    loaded = p.feed_mass > 0
    feed = np.zeros(len(loaded), complex)
    feed[loaded] = p.feed_mass[loaded] * apparent_mass(p.throw_coefficient[loaded])
    return np.rec.fromarrays(
        Machine(
            c=cos(p.working_angle),
            s=sin(p.working_angle),
            along=along,
            across=p.axis_offset,
            half=half,
            mass=p.body_mass + set_mass,
            inertia=p.body_inertia + set_inertia + set_mass * (along**2 + p.axis_offset**2),
            set_mass=set_mass,
            set_inertia=set_inertia,
            stiffness_x=p.stiffness_x,
            damping_x=damping(p.damping_ratio, sprung, p.stiffness_x),
            stiffness_y=p.stiffness_y,
            damping_y=damping(p.damping_ratio, sprung, p.stiffness_y),
            offset=p.support_offset,
            spacing=p.support_half_spacing,
            lever=p.support_imbalance * p.support_half_spacing,
            slide_xi=cos(p.mount_angle),
            slide_eta=sin(p.mount_angle),
            slide_stiffness=p.mount_stiffness,
            slide_damping=damping(p.mount_damping_ratio, set_mass, p.mount_stiffness),
            turn_stiffness=p.mount_rotational_stiffness,
            turn_damping=damping(p.mount_damping_ratio, set_inertia, p.mount_rotational_stiffness),
            feed=feed.real,
            feed_loss=feed.imag,
            feed_position=p.feed_position,
            unbalance_1=p.unbalance_1,
            unbalance_2=p.unbalance_2,
        ),
        dtype=[(name, float) for name in Machine._fields],
    )
