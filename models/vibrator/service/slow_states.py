"""Machines after some time in service: their friction, their springs, and what is bound to end.

With t the time in service,

    rho_j(t) = rho_0j [1 + (t/t_j)^nu]                       friction of bearing j
    k(t) = k_0 [1 + c log10(1 + t/1000 h)]                   rubber supports, both directions

and each of n springs at each side breaks at a Weibull time of its own: a side with s of them left
has s/n of its stiffness. With k_R and k_L the stiffness of the sides, (1 +- kappa)/2 of the total
when new, the supports have the total k_R + k_L and the imbalance (k_R - k_L)/(k_R + k_L). The
damping ratio remains.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.numerics.jit import kernel
from models.numerics.uniforms import STRIDE, mixed, uniform
from models.vibrator.parameters import Params, Rows
from models.vibrator.start.regimes import CAPTURED_BELOW

Array = NDArray[np.float64]

HARDENING_TIME = 3.6e6
"""1000 hours [s]."""


class Springs(NamedTuple):
    """Times at which springs break, in ascending order, of n machines.

    Attributes
    ----------
    time : ndarray, shape (n, b)
        [s]
    left, right : ndarray, shape (n, b + 1)
        Shares of the springs of each side that are whole, from the beginning and after each break.
    """

    time: Array
    left: Array
    right: Array


def changes(p: Rows) -> NDArray[np.bool_]:
    """Return which machines change in service."""
    worn = (p.bearing_constant_1 > 0) & np.isfinite(p.ageing_time_1)
    worn |= (p.bearing_constant_2 > 0) & np.isfinite(p.ageing_time_2)
    return np.asarray(worn | (p.support_hardening > 0) | np.isfinite(p.spring_life))


@kernel
def _fill(seed, count, out):
    for i in range(len(seed)):
        stream = mixed(seed[i] + STRIDE)
        for j in range(count):
            out[i, j] = uniform(stream, j)


def spring_breaks(p: Rows, seed: NDArray[np.uint64], springs: int) -> Springs:
    """Draw the times at which springs break.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    seed : ndarray of uint64, shape (n,)
    springs : int
        At each side.

    Returns
    -------
    Springs
        Infinite times where springs do not break.
    """
    n = len(seed)
    drawn = np.empty((n, 2 * springs))
    _fill(seed, 2 * springs, drawn)
    hazard = -elementary.log(drawn)
    scale = elementary.exp(elementary.log(hazard) / p.spring_shape[:, None])
    time = p.spring_life[:, None] * scale
    order = np.argsort(time, axis=1, kind="stable")
    on_left = np.cumsum(order < springs, axis=1)
    lost = np.arange(1, 2 * springs + 1)
    left, right = np.ones((2, n, 2 * springs + 1))
    left[:, 1:] = (springs - on_left) / springs
    right[:, 1:] = (springs - (lost - on_left)) / springs
    return Springs(np.take_along_axis(time, order, axis=1), left, right)


def in_service(p: Rows, time: Array, left: Array, right: Array) -> Rows:
    """Return n machines after some time.

    Parameters
    ----------
    p : Params
        When new, each field an ndarray of shape (n,).
    time : ndarray, shape (n,)
        [s]
    left, right : ndarray, shape (n,)
        Shares of the springs of each side that are whole, not both 0.

    Returns
    -------
    Params
    """
    k_right, k_left = right * (1 + p.support_imbalance), left * (1 - p.support_imbalance)
    decades = elementary.log1p(time / HARDENING_TIME) / math.log(10.0)
    factor = (1 + p.support_hardening * decades) * ((k_right + k_left) / 2)
    return p._replace(
        bearing_constant_1=p.bearing_constant_1 * (1 + _age(time, p.ageing_time_1, p)),
        bearing_constant_2=p.bearing_constant_2 * (1 + _age(time, p.ageing_time_2, p)),
        stiffness_x=p.stiffness_x * factor,
        stiffness_y=p.stiffness_y * factor,
        support_imbalance=(k_right - k_left) / (k_right + k_left),
    )


def _age(time: Array, ageing_time: Any, p: Rows) -> Any:
    """Return (t/t_j)^nu, 0 for an infinite t_j."""
    return elementary.exp(p.ageing_exponent * elementary.log(time / ageing_time))


def stopped_by_friction(p: Rows) -> Array:
    """Return times by which bearings are certain to hold both motors below working speed [s].

    At working speed, and above, the bearing of one vibrator alone then takes more than the
    breakdown torques of both motors. Infinite where friction does not grow.
    """
    slowest = CAPTURED_BELOW * np.maximum(p.synchronous_speed_1, p.synchronous_speed_2)
    rated = p.rated_torque_1 + p.rated_torque_2
    most = p.overload_capacity * rated * p.voltage_factor * p.voltage_factor
    first = np.full(len(slowest), np.inf)
    for rho, me, t in (
        (p.bearing_constant_1, p.unbalance_1, p.ageing_time_1),
        (p.bearing_constant_2, p.unbalance_2, p.ageing_time_2),
    ):
        grows = (rho > 0) & np.isfinite(t)
        with np.errstate(divide="ignore", invalid="ignore"):
            growth = most / (rho * me * slowest * slowest) - 1
        age = elementary.exp(elementary.log(np.maximum(growth, 0.0)) / p.ageing_exponent)
        first = np.where(grows, np.minimum(first, t * age), first)
    return first


def rows_of(p: Rows, rows: Any) -> Rows:
    """Return some machines."""
    return Params._make(field[rows] for field in p)
