"""Measures of the motion of one vibrator, sampled at equal intervals of time."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.numerics.jit import kernel
from models.numerics.linear import product
from models.vibrator.equations.system import System

_FRACTIONS = np.linspace(0.0, 1.0, 65)
_CUBICS = np.stack(  # Hermite's, for the values, then for the rates, at both ends
    [
        (1 + 2 * _FRACTIONS) * (1 - _FRACTIONS) ** 2,
        _FRACTIONS**2 * (3 - 2 * _FRACTIONS),
        _FRACTIONS * (1 - _FRACTIONS) ** 2,
        _FRACTIONS**2 * (_FRACTIONS - 1),
    ]
)


class Measures(NamedTuple):
    """Measures of a motion over a time span.

    Attributes
    ----------
    disphasing : float
        Mean of psi_1 - psi_2, not wrapped [rad].
    angular_amplitude, stroke_left, stroke_right : float
        Half peak-to-peak [rad, m, m].
    speed_1, speed_2, power_1, power_2 : float
        Means [rad s-1, rad s-1, W, W].
    """

    disphasing: float
    angular_amplitude: float
    stroke_left: float
    stroke_right: float
    speed_1: float
    speed_2: float
    power_1: float
    power_2: float


def refine(
    value: NDArray[np.float64], rate: NDArray[np.float64], interval: float
) -> NDArray[np.float64]:
    """Interpolate a quantity between samples by Hermite cubics.

    Parameters
    ----------
    value, rate : ndarray, shape (2, k)
        At both ends of k intervals between samples.
    interval : float
        [s]

    Returns
    -------
    ndarray, shape (k, 65)
        At equal steps from end to end of each interval.
    """
    ends = np.stack([value.T, interval * rate.T])
    return product(ends, np.stack([_CUBICS[:2], _CUBICS[2:]])).sum(axis=0)


def extremes(
    value: NDArray[np.float64], rate: NDArray[np.float64], interval: float
) -> tuple[float, float]:
    """Return the smallest and the largest value, including between samples; see `refine`."""
    ends, rates = np.stack([value[:-1], value[1:]]), np.stack([rate[:-1], rate[1:]])
    turning = rates[0] * rates[1] < 0
    between = refine(ends[:, turning], rates[:, turning], interval).ravel()
    every = np.concatenate([value, between])
    return float(every.min()), float(every.max())


@kernel
def excursion(samples, interval):
    """Return the largest distance of C from its rest position, including between samples.

    Parameters
    ----------
    samples : ndarray, shape (k, 10) or (k, 16)
        States at equal intervals.
    interval : float
        [s]

    Returns
    -------
    float
        [m]
    """
    rates = samples.shape[1] // 2
    largest = value = rate = 0.0
    for k in range(len(samples)):
        x, y, vx, vy = samples[k, 0], samples[k, 1], samples[k, rates], samples[k, rates + 1]
        before, rate_before = value, rate
        value, rate = x * x + y * y, 2 * interval * (x * vx + y * vy)
        largest = value if value > largest else largest
        if rate_before > 0 and rate < 0:
            for i in range(_CUBICS.shape[1]):
                between = before * _CUBICS[0, i] + value * _CUBICS[1, i]
                between += rate_before * _CUBICS[2, i] + rate * _CUBICS[3, i]
                largest = between if between > largest else largest
    return math.sqrt(largest)


def measure(m: System, samples: NDArray[np.float64], interval: float) -> Measures:
    """Measure a motion.

    Parameters
    ----------
    m : System
    samples : ndarray, shape (k, 10) or (k, 16)
        States at equal intervals, including both ends.
    interval : float
        [s]

    Returns
    -------
    Measures
    """
    (x, y, alpha, psi_1, psi_2), (vx, vy, spin, w_1, w_2) = (
        part[:5] for part in np.split(samples.T, 2)
    )
    turned = m.exact * alpha
    cos, sin = math.cos(m.rigid.working_angle), math.sin(m.rigid.working_angle)
    # Displacement along xi per unit of rotation and of distance to the right of C.
    arm = cos * (elementary.cos(turned) - 1) + sin * (elementary.sin(turned) if m.exact else alpha)
    arm_rate = spin * (sin * elementary.cos(turned) - cos * elementary.sin(turned))

    def stroke(end: float) -> float:
        shift, rate = cos * x + sin * y + end * arm, cos * vx + sin * vy + end * arm_rate
        return _half_range(shift, rate, interval)

    duration = interval * (len(samples) - 1)
    torque_1 = kloss(m.rigid.torque_1, m.rigid.slip_1, m.rigid.synchronous_speed_1 - w_1)
    torque_2 = kloss(m.rigid.torque_2, m.rigid.slip_2, m.rigid.synchronous_speed_2 - w_2)
    if m.torque_lag:
        torque_1, torque_2 = samples.T[-2:]
    return Measures(
        _mean(psi_1 - psi_2),
        _half_range(alpha, spin, interval),
        stroke(-m.rigid.half_spacing),
        stroke(m.rigid.half_spacing),
        float(psi_1[-1] - psi_1[0]) / duration,
        float(psi_2[-1] - psi_2[0]) / duration,
        _mean(w_1 * torque_1),
        _mean(w_2 * torque_2),
    )


def first_harmonic(periodic: NDArray[np.float64]) -> float:
    """Return the amplitude of the first harmonic of one period, sampled without its end."""
    return float(2 * abs(np.fft.rfft(periodic)[1]) / len(periodic))


def _half_range(value: NDArray[np.float64], rate: NDArray[np.float64], interval: float) -> float:
    low, high = extremes(value, rate, interval)
    return (high - low) / 2


def _mean(value: NDArray[np.float64]) -> float:
    return float(np.mean((value[1:] + value[:-1]) / 2))


def kloss(torque: Any, slip: Any, lag: Any) -> Any:
    """Return the motor torque of (22), (23) before bearing loss."""
    return torque * lag / (slip**2 + lag**2)
