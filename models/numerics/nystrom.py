"""Fixed Runge-Kutta steps of sixteen systems q'' = f(q, q') at a time, in Nystrom form.

The slopes of q are themselves sums of accelerations, so only the latter are kept: with K_l = h f_l,

    q_i = q + h (c_i v + sum_l (A A)_il K_l),    v_i = v + sum_l a_il K_l.

This is the method of the same tableau with half the memory and half the loads.
"""

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES
from models.numerics.fma import fma
from models.numerics.jit import kernel, lean
from models.numerics.tableaux import Tableau

STAGES = 12  # at most
_ZERO = 1e-15  # rounding error of products of coefficients


class Layout(NamedTuple):
    """Layout of a block of lanes; the quantities of one lane are LANES apart.

    Attributes
    ----------
    position, velocity : int
        Offsets of the state.
    at, speed : int
        Offsets of the position and velocity at which the accelerations are evaluated.
    rise : int
        Offset of the accelerations there, times the step.
    step : int
        Offset of the step, repeated for each quantity.
    end : int
        Offset of what follows.
    """

    position: int
    velocity: int
    at: int
    speed: int
    rise: int
    step: int
    end: int


def layout(quantities: int) -> Layout:
    """Return the layout for positions of this many quantities."""
    return Layout._make(range(0, 7 * quantities * LANES, quantities * LANES))


def _combiner(
    quantities: int, slopes: int, a: Any, b: Any, to: tuple[int, int]
) -> Callable[[Any], None]:
    """Return the kernel that stores the newest slope and sets `to` to the weighted sums of all."""
    position, velocity, _, _, rise, step, _ = layout(quantities)
    whole, c, (to_position, to_velocity) = quantities * LANES, float(sum(a)), to
    newest = slopes + (len(a) - 1) * whole
    used = [i for i in range(len(a) - 1) if max(abs(a[i]), abs(b[i])) > _ZERO]
    n, padding = len(used), [0] * (STAGES - 1 - len(used))
    a_0, b_0 = float(a[-1]), float(b[-1])
    a_1, a_2, a_3, a_4, a_5, a_6, a_7, a_8, a_9, a_10, a_11 = [float(a[i]) for i in used] + padding
    b_1, b_2, b_3, b_4, b_5, b_6, b_7, b_8, b_9, b_10, b_11 = [float(b[i]) for i in used] + padding
    k_1, k_2, k_3, k_4, k_5, k_6, k_7, k_8, k_9, k_10, k_11 = [
        slopes + i * whole for i in used
    ] + padding

    # Terms after the n-th are removed at compile time. Two chains of sums, so that the additions do
    # not all wait for each other.
    @lean
    def combine(w):
        for j in range(whole):
            k, v_0 = w[rise + j], w[velocity + j]
            w[newest + j] = k
            v, q, v_2, q_2 = a_0 * k, fma(c, v_0, b_0 * k), 0.0, 0.0
            if n >= 1:
                v_2, q_2 = a_1 * w[k_1 + j], b_1 * w[k_1 + j]
            if n >= 2:
                v = fma(a_2, w[k_2 + j], v)
                q = fma(b_2, w[k_2 + j], q)
            if n >= 3:
                v_2 = fma(a_3, w[k_3 + j], v_2)
                q_2 = fma(b_3, w[k_3 + j], q_2)
            if n >= 4:
                v = fma(a_4, w[k_4 + j], v)
                q = fma(b_4, w[k_4 + j], q)
            if n >= 5:
                v_2 = fma(a_5, w[k_5 + j], v_2)
                q_2 = fma(b_5, w[k_5 + j], q_2)
            if n >= 6:
                v = fma(a_6, w[k_6 + j], v)
                q = fma(b_6, w[k_6 + j], q)
            if n >= 7:
                v_2 = fma(a_7, w[k_7 + j], v_2)
                q_2 = fma(b_7, w[k_7 + j], q_2)
            if n >= 8:
                v = fma(a_8, w[k_8 + j], v)
                q = fma(b_8, w[k_8 + j], q)
            if n >= 9:
                v_2 = fma(a_9, w[k_9 + j], v_2)
                q_2 = fma(b_9, w[k_9 + j], q_2)
            if n >= 10:
                v = fma(a_10, w[k_10 + j], v)
                q = fma(b_10, w[k_10 + j], q)
            if n >= 11:
                v_2 = fma(a_11, w[k_11 + j], v_2)
                q_2 = fma(b_11, w[k_11 + j], q_2)
            w[to_position + j] = fma(w[step + j], q + q_2, w[position + j])
            w[to_velocity + j] = v_0 + (v + v_2)

    return combine


def _product(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a matrix product, rounded once: the sums of a BLAS depend on the processor."""
    exact = np.vectorize(Fraction, otypes=[object])
    return (exact(a) @ exact(b)).astype(float)


def weights(method: Tableau) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the weights of the slopes of s stages in velocities and in positions.

    Parameters
    ----------
    method : Tableau

    Returns
    -------
    a, b : ndarray, shape (s + 1, s)
        For the arguments of the stages, then for the new state.
    """
    stages = method.matrix()
    rows = np.vstack([stages, method.b])
    return rows, _product(rows, stages)


@cache
def combiner(quantities: int, slopes: int, method: Tableau) -> Callable[[int, Any], None]:
    """Compile the combination after a stage of one method.

    Parameters
    ----------
    quantities : int
        In a position.
    slopes : int
        Offset in the block of the room for the slopes of all stages.
    method : Tableau
        With s <= 12 stages.

    Returns
    -------
    kernel
        ``combine(stage, block)``, given the accelerations of a stage, counted from 0, sets the
        argument of the next; after the last, the new state.
    """
    at = layout(quantities)
    a, b = weights(method)
    stages = len(a) - 1
    combiners = [
        _combiner(
            quantities,
            slopes,
            a[done][:done],
            b[done][:done],
            (at.position, at.velocity) if done == stages else (at.at, at.speed),
        )
        for done in range(1, stages + 1)
    ]
    spare = combiners[-1:] * (STAGES - stages)
    c_1, c_2, c_3, c_4, c_5, c_6, c_7, c_8, c_9, c_10, c_11, c_12 = combiners + spare

    @kernel
    def combine(stage, w):
        if stage == 0:
            c_1(w)
        elif stage == 1:
            c_2(w)
        elif stage == 2:
            c_3(w)
        elif stage == 3:
            c_4(w)
        elif stage == 4:
            c_5(w)
        elif stage == 5:
            c_6(w)
        elif stage == 6:
            c_7(w)
        elif stage == 7:
            c_8(w)
        elif stage == 8:
            c_9(w)
        elif stage == 9:
            c_10(w)
        elif stage == 10:
            c_11(w)
        else:
            c_12(w)

    return combine


def stepper(
    quantities: int, slopes: int, method: Tableau, accelerate: Callable[[Any], None]
) -> Callable[[Any], None]:
    """Compile the steps of one method for one system.

    Parameters
    ----------
    quantities, slopes, method
        As for `combiner`.
    accelerate : kernel
        ``accelerate(block)`` sets the accelerations, times the step, at `Layout.rise`.

    Returns
    -------
    kernel
        ``step(block)`` advances the state by one step. Call it from a module-level kernel, or it is
        not cached.
    """
    at, whole, stages = layout(quantities), 2 * quantities * LANES, len(method.b)
    position, arguments = at.position, at.at
    combine = combiner(quantities, slopes, method)

    @kernel
    def step(w):
        for j in range(whole):
            w[arguments + j] = w[position + j]
        for stage in range(stages):
            accelerate(w)
            combine(stage, w)

    return step
