"""The averaged theory of synchronous running: one formula for every disturbance.

With both vibrators at the mean speed w and psi_1 - psi_2 = dphi, the vibrating body brakes or
drives rotor i with the vibratory moment

    L_i = (w^2/2) Im(m e_i H_i^* . q e^(-j psi_i)),    q = w^2 G(w) sum_i m e_i H_i e^(j psi_i),

and synchronous running is where motor torque less bearing torque balances it, T_i(w) + L_i = 0. At
given w the difference of the two balances is c + rho cos(dphi - delta) = 0: of its two solutions,
where they exist, one is restoring, d(L_1 - L_2)/d dphi < 0. That leaves one equation for w, the sum
of the balances along the restoring dphi.

Forces are evaluated at the undeflected geometry and to first harmonic; the linear body is treated
exactly. The neglected ripple of the speeds within a revolution changes dphi of the nominal machine
by up to 5e-5 rad, its speed by 4e-5 and its amplitudes by 0.25 %. Feed on the deck has its declared
throw coefficient, however much its own weight damps the deck.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.numerics.jit import kernel
from models.vibrator.parameters import Params, Rows
from models.vibrator.theory.balance import balance, is_stable, kloss, motors
from models.vibrator.theory.linear_machine import machines
from models.vibrator.theory.receptance import respond

_SECANTS = 12
_NEAR = 0.9  # of the larger synchronous speed: lower limit of the secant search
_CLOSE = 1e-10  # last step of the secants, over that speed
_SPEEDS = 200  # geometrically spaced, searched where the secants fail
_SLOWEST = 0.05  # of the larger synchronous speed: stalled below


class Disphasing(NamedTuple):
    """Synchronous running of n machines.

    Attributes
    ----------
    angle : ndarray, shape (n,)
        dphi = psi_1 - psi_2 in (-pi, pi] [rad].
    speed : ndarray, shape (n,)
        w [rad s-1].
    exists : ndarray of bool, shape (n,)
        Whether the torque balances have a solution; if not, all numbers are NaN.
    stable : ndarray of bool, shape (n,)
        Whether it is stable as a solution of the averaged equations I_i psi_i'' = T_i(psi_i') +
        L_i, with a body that follows instantly.
    angular_amplitude : ndarray, shape (n,)
        Amplitude of the body's rotation [rad].
    power_1, power_2 : ndarray, shape (n,)
        Of the motors, before bearing loss [W]; negative for one that is driven.
    """

    angle: NDArray[np.float64]
    speed: NDArray[np.float64]
    exists: NDArray[np.bool_]
    stable: NDArray[np.bool_]
    angular_amplitude: NDArray[np.float64]
    power_1: NDArray[np.float64]
    power_2: NDArray[np.float64]


class Motion(NamedTuple):
    """Harmonic motion of n machines: each quantity is Re(amplitude e^(j psi_1)).

    Attributes
    ----------
    x, y : ndarray of complex, shape (n,)
        Displacement of C, the mass centre of the bare body [m].
    alpha : ndarray of complex, shape (n,)
        Rotation of the body [rad].
    slide, turn : ndarray of complex, shape (n,)
        Of the motor set against the body along its mount's direction [m] and about the midpoint
        of the shafts [rad]; 0 for a rigid mount.
    """

    x: NDArray[np.complex128]
    y: NDArray[np.complex128]
    alpha: NDArray[np.complex128]
    slide: NDArray[np.complex128]
    turn: NDArray[np.complex128]


@kernel
def _by_secants(a, motor_1, motor_2, top):
    """Return the speed of a state just below the top, NaN if the secants do not converge to one."""
    w = top
    at = balance(a, motor_1, motor_2, w)
    slope = -motor_1.breakdown / motor_1.slip**2 - motor_2.breakdown / motor_2.slip**2
    for _ in range(_SECANTS):
        step = -at.sum / slope
        if not _NEAR * top < w + step <= top:
            return math.nan
        if abs(step) <= _CLOSE * top:
            return w + step
        before = at.sum
        w += step
        at = balance(a, motor_1, motor_2, w)
        slope = (at.sum - before) / step
    return math.nan


@kernel
def _by_bisection(a, motor_1, motor_2, low, high):
    """Return the root between a speed at which the sum is positive and one at which it is not."""
    middle = 0.5 * (low + high)
    while low < middle < high:
        if balance(a, motor_1, motor_2, middle).sum > 0.0:
            low = middle
        else:
            high = middle
        middle = 0.5 * (low + high)
    return middle


@kernel
def _solve(a, motor_1, motor_2):
    """Return the speed of the fastest stable state and True, else of the fastest (or NaN), False.

    Just below a stable state the sum is positive.
    """
    top = max(motor_1.synchronous, motor_2.synchronous)
    w = _by_secants(a, motor_1, motor_2, top)
    if w > 0.0:
        at = balance(a, motor_1, motor_2, w)
        if at.reached and is_stable(a, motor_1, motor_2, w, at):
            return w, True
    fallback, high = math.nan, top
    positive = balance(a, motor_1, motor_2, top).sum > 0.0  # if a breakdown speed is the higher
    for k in range(1, _SPEEDS + 1):
        low = top * _SLOWEST ** (k / _SPEEDS)
        was_positive, positive = positive, balance(a, motor_1, motor_2, low).sum > 0.0
        if positive and not was_positive:
            w = _by_bisection(a, motor_1, motor_2, low, high)
            at = balance(a, motor_1, motor_2, w)
            if at.reached:
                if is_stable(a, motor_1, motor_2, w, at):
                    return w, True
                if math.isnan(fallback):
                    fallback = w
        high = low
    return fallback, False


@kernel
def _disphase(bodies, drives, numbers, flags):
    for i in range(len(bodies)):
        a, motor_1, motor_2 = bodies[i], drives[i, 0], drives[i, 1]
        w, stable = _solve(a, motor_1, motor_2)
        at = balance(a, motor_1, motor_2, w)
        angle = math.atan2(at.sin, at.cos)
        numbers[0, i] = angle if angle != -math.pi else math.pi
        numbers[1, i] = w
        numbers[2, i] = w * w * abs(at.alpha)
        numbers[3, i] = w * kloss(motor_1, w)
        numbers[4, i] = w * kloss(motor_2, w)
        flags[0, i], flags[1, i] = not math.isnan(w), stable


@kernel
def _move(bodies, speed, angle, out):
    for i in range(len(bodies)):
        a = bodies[i]
        w = speed[i]
        g = respond(a, w)
        force_1 = w * w * a.unbalance_1
        force_2 = w * w * a.unbalance_2 * cmath.exp(-1j * angle[i])
        xi, eta = force_1 * g.xi_1 + force_2 * g.xi_2, force_1 * g.eta_1 + force_2 * g.eta_2
        out[0, i] = a.c * xi - a.s * eta
        out[1, i] = a.s * xi + a.c * eta
        out[2, i] = force_1 * g.alpha_1 + force_2 * g.alpha_2
        out[3, i] = force_1 * g.slide_1 + force_2 * g.slide_2
        out[4, i] = force_1 * g.turn_1 + force_2 * g.turn_2


def broadcast(p: Rows, *more: ArrayLike) -> tuple[Params, list[NDArray[np.float64]]]:
    """Return Params of contiguous arrays of equal length, with `more` broadcast likewise."""
    columns = np.array(np.broadcast_arrays(*np.atleast_1d(*p, *more)), float)
    return Params._make(columns[: len(p)]), list(columns[len(p) :])


def disphasing(p: Rows) -> Disphasing:
    """Find the synchronous running of n machines by the averaged theory.

    Parameters
    ----------
    p : Params
        Each field a number or an ndarray of shape (n,).

    Returns
    -------
    Disphasing
        Of several stable states the fastest, which is the one at working speed; a slower one is
        captured at a resonance (Sommerfeld effect). For a machine without a stable state, the
        fastest unstable one. Not searched: states faster than both synchronous speeds, slower than
        0.05 of the larger, or with a dphi at which the moments are not restoring.

    Notes
    -----
    Below 0.9 of the larger synchronous speed states are sought between 200 speeds, so two states
    less than 1.5 % apart in speed, at a narrow resonance, may be missed.
    """
    p, _ = broadcast(p)
    n = len(p.body_mass)
    numbers, flags = np.empty((5, n)), np.empty((2, n), np.bool_)
    _disphase(machines(p), motors(p), numbers, flags)
    angle, speed, alpha, power_1, power_2 = numbers
    return Disphasing(angle, speed, flags[0], flags[1], alpha, power_1, power_2)


def steady_motion(p: Rows, speed: ArrayLike, angle: ArrayLike) -> Motion:
    """Return the motion of n machines whose vibrators turn at one constant speed.

    Parameters
    ----------
    p : Params
        Each field a number or an ndarray of shape (n,).
    speed : array_like, shape (n,)
        Of both vibrators [rad s-1].
    angle : array_like, shape (n,)
        dphi = psi_1 - psi_2 [rad].

    Returns
    -------
    Motion
        With psi_1 = w t and psi_2 = w t - dphi: x(t) = Re(x e^(jwt)), x'(t) = Re(jw x e^(jwt)).
        psi_1 is counted from the working axis, counter-clockwise.
    """
    p, (speed, angle) = broadcast(p, speed, angle)
    out = np.empty((5, len(speed)), complex)
    _move(machines(p), speed, angle, out)
    return Motion._make(out)


def feed_gravity(p: Rows) -> NDArray[np.float64]:
    """Return the gravity that gives the feed its declared throw coefficient.

    Parameters
    ----------
    p : Params
        Each field a number or an ndarray of shape (n,).

    Returns
    -------
    ndarray, shape (n,)
        g = A_y w^2/k_p [m s-2] with A_y the vertical amplitude of the empty deck at the feed, for
        vibrators in phase at the mean w of the two synchronous speeds: defined whether or not the
        vibrators synchronise.
    """
    p, _ = broadcast(p)
    speed = (p.synchronous_speed_1 + p.synchronous_speed_2) / 2
    deck = steady_motion(p._replace(feed_mass=0.0), speed, 0.0)
    moved = deck.y + p.feed_position * deck.alpha
    return np.hypot(moved.real, moved.imag) * speed**2 / p.throw_coefficient
