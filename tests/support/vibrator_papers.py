"""Closed formulas of Michalczyk & Cieplok 2014 for one disturbance at a time, undamped.

Each holds for identical motors at a known common speed, far from resonance, under the conditions
stated; `models.vibrator.theory.averaged` needs none of these. They refer to the body about its mass
centre WITH both unbalanced masses (`combined_centre`): lengths and inertias about C, the mass
centre of the bare body, cause errors of up to 20 % in K. Angles are those of the stable state, in
(-pi, pi]. Arguments may be numbers or arrays that broadcast.
"""

from typing import Any, NamedTuple

import numpy as np

from models.vibrator.start.regimes import wrapped


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


def synchronising_coefficient(distance: Any, inertia: Any, mass_xi: Any, mass_eta: Any) -> Any:
    """Return B = D^2/J' + 1/M_eta' - 1/M_xi' of eq. (5).

    Parameters
    ----------
    distance : array_like
        D [m], see `Centre.distance`.
    inertia, mass_xi, mass_eta : array_like
        J' [kg m2], M_xi' and M_eta' [kg].

    Returns
    -------
    array_like
        [kg-1]; dphi = 0 is stable where B > 0, otherwise dphi = pi.
    """
    return distance**2 / inertia + 1 / mass_eta - 1 / mass_xi


def synchronising_moment(unbalance: Any, speed: Any, coefficient: Any) -> Any:
    """Return K = m^2 e^2 w^2 B of eq. (5) [N m]: L_1 - L_2 = -K sin dphi.

    Parameters
    ----------
    unbalance : array_like
        m e of each vibrator [kg m].
    speed : array_like
        w [rad s-1].
    coefficient : array_like
        B [kg-1].
    """
    return unbalance**2 * speed**2 * coefficient


def conveyor_moment(
    unbalance: Any, speed: Any, deck_mass: Any, set_mass: Any, stiffness: Any, set_stiffness: Any
) -> Any:
    """Return K of the conveyor on leaf springs, eq. (2) [N m].

    The deck moves only along the working axis, together with the motor set; across it the set moves
    alone on its springs; nothing rotates.

    Parameters
    ----------
    unbalance : array_like
        m e of each vibrator [kg m].
    speed : array_like
        w [rad s-1].
    deck_mass, set_mass : array_like
        m_k and m_w, the latter with the unbalanced masses [kg].
    stiffness, set_stiffness : array_like
        k of the deck along the axis and k_z of the set across it [N m-1].
    """
    along = stiffness - (deck_mass + set_mass) * speed**2
    across = set_stiffness - set_mass * speed**2
    return unbalance**2 * speed**4 * (1 / along - 1 / across)


def speed_coefficient(
    rated_torque: Any,
    overload_capacity: Any,
    synchronous_speed: Any,
    breakdown_speed: Any,
    bearing_constant: Any,
    unbalance: Any,
    speed: Any,
) -> Any:
    """Return a_el + a_o of eq. (3) [N m s]: the drop of one vibrator's torque per unit of speed.

    a_el = 2 p M_zn/(w_s - w_u) of the motor near its synchronous speed and a_o = 2 rho m e w of
    the bearings; torques in N m, speeds in rad s-1, bearing constant in m, unbalance in kg m.
    """
    motor = 2 * overload_capacity * rated_torque / (synchronous_speed - breakdown_speed)
    return motor + 2 * bearing_constant * unbalance * speed


def disphasing_of_motors(speed_difference: Any, speed_coefficient: Any, moment: Any) -> Any:
    """Return dphi of motors that would run at different speeds if uncoupled, eqs. (4) and (6).

    Parameters
    ----------
    speed_difference : array_like
        w_ust1 - w_ust2, difference of the steady speeds without coupling [rad s-1].
    speed_coefficient : array_like
        a_el + a_o [N m s].
    moment : array_like
        K [N m].

    Returns
    -------
    array_like
        [rad]; NaN where |w_ust1 - w_ust2| (a_el + a_o) > |K|: no synchronisation, eq. (4).
    """
    with np.errstate(invalid="ignore"):
        angle = np.arcsin(speed_difference * speed_coefficient / np.abs(moment))
    return np.where(np.asarray(moment) > 0, angle, wrapped(np.pi + angle))


def disphasing_of_offset(centre: Centre, inertia: Any, mass_xi: Any, mass_eta: Any) -> Any:
    """Return dphi of a force axis off the mass centre, eq. (7) [rad].

    tan dphi = [2 w_off R/J'] / [(D^2 - w_off^2)/J' + 1/M_eta' - 1/M_xi'], on supports level with
    the mass centre and equally stiff both ways.

    Parameters
    ----------
    centre : Centre
    inertia, mass_xi, mass_eta : array_like
        J' [kg m2], M_xi' and M_eta' [kg].
    """
    held = (centre.distance**2 - centre.offset**2) / inertia + 1 / mass_eta - 1 / mass_xi
    return np.arctan2(2 * centre.offset * centre.along / inertia, held)


def angular_amplitude(angle: Any, unbalance: Any, centre: Centre, inertia: Any) -> Any:
    """Return the amplitude of the body's rotation at dphi, eq. (8) [rad].

    Parameters
    ----------
    angle : array_like
        dphi [rad].
    unbalance : array_like
        m e of each vibrator [kg m].
    centre : Centre
    inertia : array_like
        J' [kg m2].
    """
    sin, cos = np.sin(angle / 2), np.cos(angle / 2)
    lever = np.hypot(centre.along * sin - centre.offset * cos, centre.half * sin)
    return 2 * unbalance / np.abs(inertia) * lever


def disphasing_of_mounts(coefficient: Any, speed: Any, *mounts: tuple[Any, Any]) -> Any:
    """Return dphi of a motor set on elastic mounts, eq. (9) [rad].

    B sin dphi + sum (w^2/k_psi) sin(dphi - 2 psi) = 0, neglecting the mass of the set, including
    the unbalanced masses. Equal mounts along psi and psi + pi/2 cancel.

    Parameters
    ----------
    coefficient : array_like
        B [kg-1].
    speed : array_like
        w [rad s-1].
    *mounts : tuple
        Stiffness k_psi [N m-1] of each and its direction psi from the working axis [rad].
    """
    held, pulled = coefficient, 0.0
    for stiffness, direction in mounts:
        held = held + speed**2 / stiffness * np.cos(2 * direction)
        pulled = pulled + speed**2 / stiffness * np.sin(2 * direction)
    return np.arctan2(pulled, held)


def critical_rotational_stiffness(half: Any, speed: Any, coefficient: Any) -> Any:
    """Return k_o = r^2 w^2/B of eqs. (10) and (11) [N m rad-1].

    On a softer rotational mount the vibrators lock at pi instead of 0. Valid for a set without
    inertia.

    Parameters
    ----------
    half : array_like
        r, half the distance of the shafts [m].
    speed : array_like
        w [rad s-1].
    coefficient : array_like
        B [kg-1].
    """
    return half**2 * speed**2 / coefficient


def disphasing_of_feed(
    contact: Any, working_angle: Any, coefficient: Any, mass: Any, unbalance: Any, speed: Any
) -> Any:
    """Return dphi of feed thrown above the combined mass centre, eq. (12) [rad].

    B sin dphi = cos(beta) Im(N_1)/(M m e w^2), for feed much lighter than the body.

    Parameters
    ----------
    contact : array_like of complex
        N_1 [N], see `models.vibrator.theory.feed.contact_coefficient`.
    working_angle : array_like
        beta [rad].
    coefficient : array_like
        B > 0 [kg-1].
    mass : array_like
        M [kg].
    unbalance : array_like
        m e of each vibrator [kg m].
    speed : array_like
        w [rad s-1].
    """
    turned = np.cos(working_angle) * np.imag(contact) / (mass * unbalance * speed**2)
    return np.arcsin(turned / coefficient)


def disphasing_of_supports(
    centre: Centre,
    coefficient: Any,
    speed: Any,
    working_angle: Any,
    stiffness_x: Any,
    stiffness_y: Any,
    support_offset: Any,
    inertia: Any,
    mass_xi: Any,
    mass_eta: Any,
) -> Any:
    """Return dphi of unequal supports, supports out of level and an axis off centre [rad].

    B sin dphi = (k_x - k_y) sin 2beta/(w^2 M_xi' M_eta')
                 - 2R (k_x h_c cos beta - k_y x_c sin beta)/(w^2 M_xi' J') + 2 w_off R/J'

    where (x_c, y_c) leads from C to the combined centre and h_c = h + y_c. First order in the
    disturbances, for light damping; the paper has no such formula.

    Parameters
    ----------
    centre : Centre
    coefficient : array_like
        B [kg-1].
    speed : array_like
        w [rad s-1].
    working_angle : array_like
        beta [rad].
    stiffness_x, stiffness_y : array_like
        k_x, k_y [N m-1].
    support_offset : array_like
        h [m], below C.
    inertia, mass_xi, mass_eta : array_like
        J' [kg m2], M_xi' and M_eta' [kg].
    """
    cos, sin = np.cos(working_angle), np.sin(working_angle)
    across = centre.offset * centre.shift / centre.along
    x_c, y_c = centre.shift * cos - across * sin, centre.shift * sin + across * cos
    unlike = (stiffness_x - stiffness_y) * np.sin(2 * working_angle) / (mass_xi * mass_eta)
    tilting = stiffness_x * (support_offset + y_c) * cos - stiffness_y * x_c * sin
    turned = (
        unlike / speed**2
        - 2 * centre.along * tilting / (speed**2 * mass_xi * inertia)
        + 2 * centre.offset * centre.along / inertia
    )
    return np.arcsin(turned / coefficient)
