"""Beams prepared for the fast propagator: modes as recurrences, and the size of the step."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Settings
from models.beam.response.averages import LONGEST
from models.beam.structure.modal import Array, Beams, reach, steady_response
from models.beam.structure.random_load import COUNT, add_modes, draw
from models.numerics.jit import kernel

LADDER = tuple(base << k for k in range(8) for base in (64, 96))
COMPLIANCE = 0.01
UNSTABLE = 0.03  # compliance from which on the corrections below may feed themselves
RESOLVED = 16  # least steps in a turn of the random load's fastest line
MOST_UNDER_RANDOM = 1024  # steps in a forcing period
_MOST = 2**20  # steps in a time mean


class System(NamedTuple):
    """n beams, prepared for steps of one size.

    Attributes
    ----------
    modes : ndarray, shape (n, 4, m)
        t, d, alpha, beta of the m lowest modes; zero for one that follows the contact statically.
    begin : ndarray, shape (n, 3, m)
        The displacement after one step per unit of displacement and of velocity, and 1; or zeros.
    sigma : ndarray, shape (n,)
        Displacement within the step per unit of its final penetration, negative.
    modal : ndarray, shape (n, all modes), complex
        Steady amplitude of each mode.
    reach : ndarray, shape (n,)
        Bound of the tip's displacement without contact.
    load : ndarray of random_load.LOAD, shape (n,)
    oscillators : ndarray, shape (n, 3, all modes)
        w_i [rad s-1], d_i [s-1], b_i [kg-1] of each mode: how it responds to the random load.
    forcing : ndarray, shape (n,)
        [rad s-1]
    beams : Beams
    steps : int
        In a forcing period.
    """

    modes: Array
    begin: Array
    sigma: Array
    modal: NDArray[np.complex128]
    reach: Array
    load: NDArray[np.void]
    oscillators: Array
    forcing: Array
    beams: Beams
    steps: int

    @property
    def is_random(self) -> NDArray[np.bool_]:
        """Which beams have a random load, shape (n,)."""
        return self.load["power"] > 0

    @property
    def memory(self) -> Array:
        """Forcing periods in which the first mode's free motion falls to 1/e, shape (n,)."""
        return self.forcing / (2 * np.pi * self.oscillators[:, 1, 0])

    @property
    def turn(self) -> Array:
        """Forcing periods in a free oscillation of the first mode, shape (n,)."""
        return self.forcing / self.beams.frequency[:, 0]

    @property
    def longest(self) -> int:
        """Forcing periods in a time mean, at most."""
        return min(LONGEST, _MOST // self.steps)

    def take(self, rows: NDArray[np.intp]) -> "System":
        """Return the systems of some rows."""
        return System._make([*(a[rows] for a in self[:-2]), self.beams.take(rows), self.steps])


@kernel
def _mode_step(w, d, h):
    """Propagate z'' + 2 d z' + w^2 z = g over h, with g linear from g0 to g1.

    Returns P11, P12, P21, P22, A1, A2, B1, B2 of s1 = P s0 + A g0 + B g1 for s = (z, z'/w): a
    Taylor series over a small fraction of h, then doubled, accurate for any damping.
    """
    small = h
    doublings = 0
    while (w + 2 * d) * small > 0.25:
        small *= 0.5
        doublings += 1
    a, b = w * small, 2 * d * small
    # phi1 and phi2 of [[0, a], [-a, -b]] applied to (0, 1)
    v1, v2 = 0.0, 1.0
    f11, f12, f21, f22 = 0.0, 1.0, 0.0, 0.5
    weight = 1.0
    for k in range(1, 14):
        v1, v2 = a * v2, -a * v1 - b * v2
        weight /= k + 1
        f11 += weight * v1
        f12 += weight * v2
        f21 += weight / (k + 2) * v1
        f22 += weight / (k + 2) * v2
    p11, p21 = 1 - a * f11, -a * f12
    p12, p22 = a * f12, 1 - a * f11 - b * f12
    scale = small / w
    b1, b2 = scale * f21, scale * f22
    a1, a2 = scale * f11 - b1, scale * f12 - b2
    for _ in range(doublings):
        c1, c2 = a1 + 0.5 * b1, a2 + 0.5 * b2
        e1, e2 = 0.5 * b1, 0.5 * b2
        a1, a2, b1, b2 = (
            p11 * c1 + p12 * c2 + 0.5 * a1,
            p21 * c1 + p22 * c2 + 0.5 * a2,
            p11 * e1 + p12 * e2 + 0.5 * a1 + b1,
            p21 * e1 + p22 * e2 + 0.5 * a2 + b2,
        )
        p11, p12, p21, p22 = (
            p11 * p11 + p12 * p21,
            p11 * p12 + p12 * p22,
            p21 * p11 + p22 * p21,
            p21 * p12 + p22 * p22,
        )
    return p11, p12, p21, p22, a1, a2, b1, b2


@kernel
def _is_static(w, d, h):
    """Tell a mode too fast for a force sampled at steps of h: its slower pole is beyond Nyquist."""
    pole = w if d < w else w * (w / (d + np.sqrt(d * d - w * w)))
    return pole * h > np.pi


@kernel
def _compliance(frequency, decay, gain, moving, h):
    """Return what the modes that move, and what the others, bring to sigma of one beam."""
    total = residual = 0.0
    for i in range(frequency.size):
        w, d = frequency[i], decay[i]
        if i >= moving:
            residual += gain[i] / (w * w)
        elif _is_static(w, d, h):
            total += gain[i] / (w * w)
        else:
            total += gain[i] * _mode_step(w, d, h)[6]
    return total, residual


@kernel
def _prepare(forcing, frequency, decay, gain, moving, steps, modes, begin, sigma, residual):
    for n in range(frequency.shape[0]):
        h = 2 * np.pi / (forcing[n] * steps)
        sigma[n], residual[n] = _compliance(frequency[n], decay[n], gain[n], moving[n], h)
        for i in range(moving[n]):
            w, d, b = frequency[n, i], decay[n, i], gain[n, i]
            if _is_static(w, d, h):
                continue
            p11, p12, p21, p22, a1, a2, b1, b2 = _mode_step(w, d, h)
            determinant = np.exp(-2 * d * h)
            modes[n, 0, i] = p11 + p22
            modes[n, 1, i] = determinant
            modes[n, 2, i] = b * (a1 + p11 * b1 + p12 * b2)
            modes[n, 3, i] = -b * (p22 * a1 - p12 * a2 + determinant * b1)
            begin[n, 0, i] = p11
            begin[n, 1, i] = p12 / w
            begin[n, 2, i] = 1.0


@kernel
def _choose_steps(forcing, frequency, decay, gain, moving, least, steps):
    for n in range(frequency.shape[0]):
        for candidate in LADDER:
            h = 2 * np.pi / (forcing[n] * candidate)
            sigma, _ = _compliance(frequency[n], decay[n], gain[n], moving[n], h)
            steps[n] = candidate
            if abs(sigma) <= COMPLIANCE and candidate >= least[n]:
                break


def groups(beams: Beams, settings: Settings) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Prepare n beams, in groups that share a number of steps and, by fours, of moving modes.

    What a row is computed with depends on the row alone, and so do its bits.

    Unless `steps_per_period` is set, a row's step is the longest of `LADDER` in which a contact
    gives way by no more than `COMPLIANCE` of its penetration, residual flexibility left out; the
    error of a work-rate is then about 0.1 %. A turn of the fastest line of a random load takes
    `RESOLVED` steps at least. A row whose step stays too long, because contact is too stiff or the
    load too fast for the longest of the ladder or for the steps that are set, is in no group; nor
    is one under a random load, whose averages are long, that takes more than `MOST_UNDER_RANDOM`.

    Parameters
    ----------
    beams : Beams
    settings : Settings

    Yields
    ------
    rows : ndarray of int
        Which of the n beams are in the group.
    system : System
    """
    steps = np.full(len(beams.forcing), settings.steps_per_period)
    if not settings.steps_per_period:
        least = _least_steps(beams)
        _choose_steps(
            beams.forcing, beams.frequency, beams.decay, _gain(beams), beams.moving, least, steps
        )
    for count in np.unique(steps):
        rows = np.flatnonzero(steps == count)
        for part, system in _systems(beams.take(rows), int(count)):
            yield rows[part], system


def finer(system: System) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Prepare the same beams for steps of half the size, in groups as `groups` yields them.

    Parameters
    ----------
    system : System

    Yields
    ------
    rows : ndarray of int
        Which of the system's beams are in the group.
    system : System
    """
    yield from _systems(system.beams, 2 * system.steps)


def _systems(b: Beams, steps: int) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Prepare n beams for so many steps, in groups of one number of modes."""
    n, m = b.frequency.shape
    modes, begin = np.zeros((n, 4, m)), np.zeros((n, 3, m))
    sigma, residual = np.empty((2, n))
    _prepare(
        b.forcing,
        b.frequency,
        b.decay,
        _gain(b),
        b.moving,
        steps,
        modes,
        begin,
        sigma,
        residual,
    )
    system = System(
        modes,
        begin,
        sigma + residual,
        steady_response(b),
        reach(b),
        b.load,
        np.stack([b.frequency, b.decay, b.mobility], axis=1),
        b.forcing,
        b,
        steps,
    )
    sound = (np.abs(sigma) <= UNSTABLE) & (_least_steps(b) <= steps)
    sound &= (b.load["power"] == 0) | (steps <= MOST_UNDER_RANDOM)
    width = np.minimum(m, _widths(begin[:, 2]))
    for size in np.unique(width[sound]):
        part = np.flatnonzero(sound & (width == size))
        some = system.take(part)
        cut = some._replace(modes=some.modes[:, :, :size], begin=some.begin[:, :, :size])
        yield part, cut


def _gain(b: Beams) -> Array:
    """Return what each mode does per unit penetration, shape (n, m)."""
    return -b.stiffness[:, None] * b.mobility


def _least_steps(b: Beams) -> Array:
    """Return how many steps the fastest line of a random load needs, shape (n,)."""
    return RESOLVED * b.load["edges"][:, -1]


def _widths(moving: Array) -> NDArray[np.int64]:
    """Return how many modes to keep of each row: up to the last that moves, in whole fours."""
    last = np.where(moving > 0, 1 + np.arange(moving.shape[1]), 1).max(axis=1)
    return -(-last // 4) * 4


@kernel
def _open(load, forcing, oscillators, opening):
    """Add the modes' steady response to the random load at t = 0."""
    lines = np.empty((COUNT, 3))
    for n in range(load.size):
        if load[n]["power"] > 0:
            frequency, decay, mobility = oscillators[n]
            draw(load[n], 0, lines)
            add_modes(lines, 0, 1.0, forcing[n], frequency, decay, mobility, opening[n])


def start(system: System, displacement: Array, velocity: Array) -> Array:
    """Return the state at phase 0 of the force, tip displaced in the shape of the first mode.

    A contact that exists at the start acts from the end of the first step.

    Parameters
    ----------
    system : System
    displacement, velocity : ndarray, shape (n,)
        Of the tip, in initial gaps and initial gaps per second.

    Returns
    -------
    ndarray, shape (n, 2 m + 4)
        y and r of each mode, then penetration, displacement, the displacement a step before, and
        the clock: forcing periods since the start.
    """
    n, _, m = system.modes.shape
    to_displacement, to_velocity, moving = system.begin.transpose(1, 0, 2)
    modal = system.modal[:, :m]
    z = -modal.real * moving
    v = modal.imag * system.forcing[:, None]
    if system.is_random.any():
        opening = np.zeros((n, 2, system.oscillators.shape[2]))
        _open(system.load, system.forcing, system.oscillators, opening)
        z -= opening[:, 0, :m] * moving
        v -= opening[:, 1, :m]
    z[:, 0] += displacement
    v[:, 0] += velocity
    state = np.zeros((n, 2 * m + 4))
    state[:, :m] = z
    state[:, m : 2 * m] = to_displacement * z + to_velocity * v - system.modes[:, 0] * z
    state[:, 2 * m + 1] = displacement
    state[:, 2 * m + 2] = displacement
    return state


def refine(system: System, state: Array, fine: System) -> Array:
    """Return nearly the same state in steps of half the size.

    Parameters
    ----------
    system : System
    state : ndarray, shape (n, 2 m + 4)
        Of `start`.
    fine : System
        The same beams; see `finer`.

    Returns
    -------
    ndarray, shape (n, 2 m' + 4)
        The displacement a step before is interpolated, with the tip's velocity.
    """
    b = system.beams
    out = np.zeros((len(state), 2 * fine.modes.shape[2] + 4))
    step = 2 * np.pi / (system.forcing * system.steps)
    modal = (system.modal * system.forcing[:, None]).imag.sum(axis=1)
    _refine(b.frequency, b.decay, _gain(b), b.moving, step, -modal, state, out)
    return out


@kernel
def _refine(frequency, decay, gain, moving, step, velocity, state, out):
    """Set out to state in half steps; velocity is that of the tip without contact."""
    m, size = (state.shape[1] - 4) // 2, (out.shape[1] - 4) // 2
    for n in range(len(state)):
        p, x1, x2 = state[n, 2 * m], state[n, 2 * m + 1], state[n, 2 * m + 2]
        h = step[n]
        speed = velocity[n]
        for i in range(min(size, moving[n])):
            w, d, g = frequency[n, i], decay[n, i], gain[n, i]
            if i >= m or _is_static(w, d, h):
                z, v = g / (w * w) * p, 0.0
            else:
                y, r = state[n, i], state[n, m + i]
                _, p12, _, p22, _, _, b1, b2 = _mode_step(w, d, h)
                z, v = y + g * b1 * p, (r + p22 * y) / p12 + g * b2 * p
            speed += w * v
            if not _is_static(w, d, h / 2):
                _, p12, _, p22, _, _, b1, b2 = _mode_step(w, d, h / 2)
                y = z - g * b1 * p
                out[n, i], out[n, size + i] = y, p12 * (v - g * b2 * p) - p22 * y
        out[n, 2 * size], out[n, 2 * size + 1] = p, x1
        out[n, 2 * size + 2] = 0.75 * x1 + 0.25 * x2 - 0.25 * h * speed
        out[n, 2 * size + 3] = state[n, 2 * m + 3]
