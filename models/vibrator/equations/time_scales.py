"""The fastest rate of a machine, which bounds fixed steps, and its slowest vibration."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.vibrator.equations.rigid import Rigid


def fastest_rates(m: Rigid) -> NDArray[np.float64]:
    """Return upper bounds of the rates of free vibration and decay of n rigid machines.

    Parameters
    ----------
    m : Rigid
        Each field an ndarray of shape (n,).

    Returns
    -------
    ndarray, shape (n,)
        [s-1]. For the supports by Gershgorin's theorem, in units in which the body's mass and
        radius of gyration are 1; for each motor the steepest slope of its torque over the rotor's
        inertia, and the frequency at which its unbalance swings under gravity.
    """
    centre = (m.moment_x**2 + m.moment_y**2) / m.mass
    inertia = m.inertia - centre
    # Rotors share the body's mass: what remains of it without the share of the unbalances.
    radius = np.sqrt(inertia / m.mass)
    lever_x = (np.abs(m.support_offset) + np.abs(m.moment_y) / m.mass) / radius
    lever_y = (np.abs(m.half_spacing) + np.abs(m.moment_x) / m.mass) / radius
    free = m.mass - m.unbalance_1**2 * m.mobility_1 - m.unbalance_2**2 * m.mobility_2
    lightest = np.maximum(np.minimum(free, m.mass), 0.05 * m.mass)

    def largest(x, y):
        return (x * (1 + lever_x) ** 2 + y * (1 + lever_y) ** 2) / lightest

    vibration = np.sqrt(largest(m.stiffness_x, m.stiffness_y))
    decay = largest(m.damping_x, m.damping_y)
    motor = [
        mobility * (torque / slip**2 + 2 * loss * speed)
        for mobility, torque, slip, loss, speed in (
            (m.mobility_1, m.torque_1, m.slip_1, m.bearing_loss_1, m.synchronous_speed_1),
            (m.mobility_2, m.torque_2, m.slip_2, m.bearing_loss_2, m.synchronous_speed_2),
        )
    ]
    swing = [
        np.sqrt(m.gravity * unbalance * mobility)
        for unbalance, mobility in ((m.unbalance_1, m.mobility_1), (m.unbalance_2, m.mobility_2))
    ]
    return np.maximum.reduce([vibration + decay, *motor, *swing])


def slowest_period(m: Rigid) -> Any:
    """Estimate the longest period of free vibration of a body on its supports [s].

    Parameters
    ----------
    m : Rigid
        One machine, or n with fields of shape (n,).

    Returns
    -------
    float or ndarray, shape (n,)
        As if its three degrees of freedom were uncoupled; unequal supports, which couple two of
        them, lengthen it by at most the factor that is added.
    """
    turning = m.stiffness_x * m.support_offset**2 + m.stiffness_y * m.half_spacing**2
    ways = (m.mass / m.stiffness_x, m.mass / m.stiffness_y, m.inertia / turning)
    even = 1 - np.abs(m.support_lever) / m.half_spacing
    return 2 * np.pi * np.sqrt(np.maximum.reduce(ways) / even)
