"""The state of beams in lanes: at the start, and converted to half steps."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from models.beam.lanes.layout import CLOCK, SHARED, X1, X2, P, modes_of
from models.beam.lanes.recurrence import is_static, mode_step
from models.beam.lanes.systems import System, gains, systems
from models.beam.structure.modal import Array
from models.beam.structure.random_response import opening
from models.numerics.jit import kernel


def start(system: System, displacement: Array, velocity: Array) -> Array:
    """Return the state in the layout of `models.beam.lanes.layout`, shape (n, 2 m + 4).

    A contact present at the start acts from the end of the first step on.
    """
    n, _, m = system.modes.shape
    to_displacement, to_velocity, moving = system.begin.transpose(1, 0, 2)
    modal = system.modal[:, :m]
    z = -modal.real * moving
    v = modal.imag * system.beams.forcing[:, None]
    if system.beams.is_random.any():
        b = system.beams
        response = opening(b.load, b.forcing, b.oscillators)
        z -= response[:, 0, :m] * moving
        v -= response[:, 1, :m]
    z[:, 0] += displacement
    v[:, 0] += velocity
    state = np.zeros((n, 2 * m + SHARED))
    state[:, :m] = z
    state[:, m : 2 * m] = to_displacement * z + to_velocity * v - system.modes[:, 0] * z
    state[:, 2 * m + X1] = state[:, 2 * m + X2] = displacement
    return state


def finer(system: System, state: Array) -> Iterator[tuple[NDArray[np.intp], System, Array]]:
    """Halve the steps; the displacement half a step before is interpolated."""
    for rows, fine in systems(system.beams, 2 * system.steps):
        yield rows, fine, _in_half_steps(system.take(rows), state[rows], fine)


def _in_half_steps(system: System, state: Array, fine: System) -> Array:
    """Return nearly the same state, shape (n, 2 m' + 4)."""
    b = system.beams
    out = np.zeros((len(state), 2 * fine.modes.shape[2] + SHARED))
    step = 2 * np.pi / (system.beams.forcing * system.steps)
    modal = (system.modal * system.beams.forcing[:, None]).imag.sum(axis=1)
    _refine(b.frequency, b.decay, gains(b), b.moving, step, -modal, state, out)
    return out


@kernel
def _refine(frequency, decay, gain, moving, step, velocity, state, out):
    """Set `out` to the state in half steps; `velocity` is the tip velocity without contact."""
    m, size = modes_of(state), modes_of(out)
    for n in range(len(state)):
        p = state[n, 2 * m + P]
        x1, x2 = state[n, 2 * m + X1], state[n, 2 * m + X2]
        h = step[n]
        speed = velocity[n]
        for i in range(min(size, moving[n])):
            w, d, g = frequency[n, i], decay[n, i], gain[n, i]
            if i >= m or is_static(w, d, h):
                z, v = g / (w * w) * p, 0.0
            else:
                y, r = state[n, i], state[n, m + i]
                _, p12, _, p22, _, _, b1, b2 = mode_step(w, d, h)
                z, v = y + g * b1 * p, (r + p22 * y) / p12 + g * b2 * p
            speed += w * v
            if not is_static(w, d, h / 2):
                _, p12, _, p22, _, _, b1, b2 = mode_step(w, d, h / 2)
                y = z - g * b1 * p
                out[n, i], out[n, size + i] = y, p12 * (v - g * b2 * p) - p22 * y
        out[n, 2 * size + P], out[n, 2 * size + X1] = p, x1
        out[n, 2 * size + X2] = 0.75 * x1 + 0.25 * x2 - 0.25 * h * speed
        out[n, CLOCK] = state[n, CLOCK]
