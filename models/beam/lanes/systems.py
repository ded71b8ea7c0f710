"""Beams prepared for the fast propagator, in groups that share a step size."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.lanes.layout import padded
from models.beam.lanes.random_motion import taps_of
from models.beam.lanes.recurrence import is_static, mode_step
from models.beam.parameters import Settings
from models.beam.structure.interpolation import REACH
from models.beam.structure.modal import Array, Beams, free_reach, steady_response
from models.beam.structure.propagation import LONGEST
from models.numerics.elementary import cos, sin
from models.numerics.jit import kernel

LADDER = tuple(base << k for k in range(8) for base in (64, 96))
COMPLIANCE = 0.01
UNSTABLE = 0.03  # compliance above which the impulse corrections may become unstable
RESOLVED = 16  # steps per turn of the random load's highest frequency, at least
_FINE = 48  # and where that many can be had: fewer than 32 make work-rates up to 1 % too high
MOST_UNDER_RANDOM = 1024  # steps per forcing period
_MOST = 2**21  # steps in a time mean


class System(NamedTuple):
    """n beams with one step size; see `models.beam.structure.propagation.System`.

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
    response : ndarray, shape (n,), complex
        Their sum.
    free_reach, beams, steps, longest
        As there; the more steps there are, the fewer periods, unless the steps are set.
    wave : ndarray, shape (2, steps)
        Cosine and sine of the force's phase at the end of each step.
    taps : ndarray, shape (steps, REACH)
        As in `models.beam.lanes.random_motion`.
    """

    modes: Array
    begin: Array
    sigma: Array
    modal: NDArray[np.complex128]
    response: NDArray[np.complex128]
    free_reach: Array
    beams: Beams
    steps: int
    longest: int
    wave: Array
    taps: Array

    def take(self, rows: NDArray[np.intp]) -> "System":
        """Return some of the beams."""
        arrays = (a.take(rows, axis=0) for a in self[:-5])
        return System._make([*arrays, self.beams.take(rows), *self[-4:]])


@kernel
def _compliance(frequency, decay, gain, moving, h):
    """Return the displacement of one beam within a step per unit of its final penetration."""
    total = 0.0
    for i in range(moving):
        total += gain[i] * mode_step(frequency[i], decay[i], h)[6]
    return total


@kernel
def _prepare(forcing, frequency, decay, gain, moving, steps, modes, begin, sigma, compliance):
    for n in range(frequency.shape[0]):
        h = 2 * np.pi / (forcing[n] * steps)
        compliance[n] = _compliance(frequency[n], decay[n], gain[n], moving[n], h)
        sigma[n] = 0.0
        for i in range(frequency.shape[1]):
            w, d, b = frequency[n, i], decay[n, i], gain[n, i]
            if i >= moving[n] or is_static(w, d, h):
                sigma[n] += b / (w * w)
                continue
            p11, p12, p21, p22, a1, a2, b1, b2 = mode_step(w, d, h)
            determinant = math.exp(-2 * d * h)
            sigma[n] += b * b1
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
            compliance = _compliance(frequency[n], decay[n], gain[n], moving[n], h)
            steps[n] = candidate
            if abs(compliance) <= COMPLIANCE and candidate >= least[n]:
                break


def groups(beams: Beams, settings: Settings) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Prepare n beams, in groups that share a number of steps and, by twos, of moving modes.

    Unless `steps_per_period` is set, a row's step is the longest of `LADDER` in which a contact
    gives way by no more than `COMPLIANCE` of its penetration, without residual flexibility; the
    error of a work-rate is then about 0.1 %. A turn of the random load's highest frequency takes
    `_FINE` steps, or as many as `MOST_UNDER_RANDOM` allows, and at least `RESOLVED`. A row is in no
    group if contact is too stiff, or the load too fast, for the last of the ladder or for the steps
    set; nor if, under a random load, whose averages are long, it takes more than
    `MOST_UNDER_RANDOM` steps and they are not set.
    """
    steps = np.full(len(beams.forcing), settings.steps_per_period)
    within = np.ones(len(steps), bool)
    if not settings.steps_per_period:
        fine = np.minimum(_FINE * beams.load["high"], MOST_UNDER_RANDOM)
        least = np.maximum(fine, _least_steps(beams))
        _choose_steps(
            beams.forcing, beams.frequency, beams.decay, gains(beams), beams.moving, least, steps
        )
        within = ~beams.is_random | (steps <= MOST_UNDER_RANDOM)
    for count in np.unique(steps[within]):
        rows = np.flatnonzero(within & (steps == count))
        longest = LONGEST if settings.steps_per_period else _MOST // int(count)
        for part, system in systems(beams.take(rows), int(count), longest):
            yield rows[part], system


def systems(
    b: Beams, steps: int, longest: int = LONGEST
) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Prepare n beams for this many steps, in groups with equal numbers of modes.

    Rows of a group also share the rate of a random load. Time means take `longest` periods at most.
    """
    n, m = b.frequency.shape
    modes, begin = np.zeros((n, 4, m)), np.zeros((n, 3, m))
    sigma, compliance = np.empty((2, n))
    _prepare(
        b.forcing,
        b.frequency,
        b.decay,
        gains(b),
        b.moving,
        steps,
        modes,
        begin,
        sigma,
        compliance,
    )
    modal = steady_response(b)
    phase = 2 * np.pi * np.arange(1, steps + 1) / steps
    system = System(
        modes,
        begin,
        sigma,
        modal,
        modal.sum(axis=1),
        free_reach(b),
        b,
        steps,
        min(LONGEST, longest),
        np.stack([cos(phase), sin(phase)]),
        np.empty((0, REACH)),
    )
    sound = (np.abs(compliance) <= UNSTABLE) & (_least_steps(b) <= steps)
    width = np.minimum(m, _widths(begin[:, 2]))
    kinds = np.stack([width, b.load["rate"]], axis=1)
    for size, rate in np.unique(kinds[sound], axis=0).tolist():
        part = np.flatnonzero(sound & (kinds == [size, rate]).all(axis=1))
        group = system.take(part)
        cut = group._replace(
            modes=np.ascontiguousarray(group.modes[:, :, :size]),
            begin=np.ascontiguousarray(group.begin[:, :, :size]),
            taps=taps_of(rate, steps) if group.beams.is_random.any() else group.taps,
        )
        yield part, cut


def gains(b: Beams) -> Array:
    """Return the acceleration of each mode per unit penetration, shape (n, m)."""
    return -b.stiffness[:, None] * b.mobility


def _least_steps(b: Beams) -> Array:
    """Return the number of steps required by the highest frequency of a random load, shape (n,)."""
    return RESOLVED * b.load["high"]


def _widths(moving: Array) -> NDArray[np.int64]:
    """Return the number of modes kept per row: up to the last moving one, in pairs."""
    return padded(np.where(moving > 0, 1 + np.arange(moving.shape[1]), 1).max(axis=1))
