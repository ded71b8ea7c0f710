"""The linear phases of the beam, free or in contact at one site, as sums of exponentials.

With y = [z, z'] of all modes and the time s since the phase began,

    y(s) = Re sum_k c_k shape_k exp(rate_k s),

where one term is the displacement due to the gap (rate 0), one the response to the force (rate i),
and the others are the decaying modes of the phase, one for each conjugate pair. With a random
force, y is the motion beyond the tip's response to it without contact; that is a sum of J harmonics
between two of its samples, and in contact y responds to each of them by a term more. Damping is
proportional in free flight but not in
contact, whose modes are complex. Time is the phase of the forcing, Omega t; lengths are in initial
gaps. Complex arrays are split into real and imaginary parts, axis 0 or 1, so that the compiler can
vectorise over the last axis.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.interpolation import COEFFICIENTS, REACH
from models.beam.structure.modal import Array, Beams
from models.beam.structure.random_load import FINER

Complex = NDArray[np.complex128]


class Phase(NamedTuple):
    """One phase of one beam of m modes, in T = 2 + J + K terms.

    Attributes
    ----------
    rate : ndarray, shape (2, T)
        Real and imaginary part; modes follow gap, force and harmonics, slowest decay first.
    speed : ndarray, shape (T,)
        Moduli of the rates.
    tip : ndarray, shape (2, T)
        Sum of the displacements in `shape`, and 1 more for a harmonic, which the tip
        follows itself.
    shape : ndarray, shape (T, 2, 2 m)
        Per unit gap, phasor of the force and of each harmonic, and coefficient of each mode.
    dual : ndarray, shape (2 m, 2, K)
        Maps y, less the terms of gap, force and harmonics, to the modes' coefficients.
    phasor : ndarray, shape (2, J)
        Of the harmonics, at phase 0 of the force, in the present interval between samples.
    """

    rate: Array
    speed: Array
    tip: Array
    shape: Array
    dual: Array
    phasor: Array


def phases(beams: Beams, row: int) -> tuple[Phase, Phase]:
    """Return free flight and contact of one beam.

    Parameters
    ----------
    beams : Beams
    row : int

    Returns
    -------
    free, contact : Phase
    """
    forcing, force, stiffness = beams.forcing[row], beams.force[row], beams.stiffness[row]
    w, d, b = beams.in_phase_time(row, forcing)
    response = b / (w**2 - 1 + 2j * d)
    flexibility = b / w**2
    speed = _harmonics(beams.load[row])[:, None]
    per_line = b / (w**2 - speed**2 + 2j * d * speed)
    held = 1 + stiffness * per_line.sum(axis=1, keepdims=True)
    phasor = np.zeros((2, len(speed)))
    free = _phase(
        *_free_modes(w, d),
        np.zeros_like(b),
        force * response,
        phasor,
        speed,
        np.zeros(per_line.shape, complex),
    )
    contact = _phase(
        *_contact_modes(w, d, b, stiffness),
        stiffness * flexibility / (1 + stiffness * flexibility.sum()),
        force * response / (1 + stiffness * response.sum()),
        phasor,
        speed,
        -stiffness * per_line / held,
    )
    return free, contact


def _harmonics(load: np.void) -> Array:
    """Return the harmonics between samples of a random load, per radian of the force."""
    if load["power"] == 0:
        return np.empty(0)
    return FINER * load["rate"] / REACH * np.arange(len(COEFFICIENTS))


def _free_modes(w: Array, d: Array) -> tuple[Complex, Complex, Complex]:
    """Return rates, shapes and duals of uncoupled modes.

    At critical damping the two solutions of a mode coincide. Separating their rates by a fraction e
    of w changes w^2 by e^2 and costs eps/e in rounding: both stay below 1e-10.
    """
    split = np.sqrt((d**2 - w**2).astype(complex))
    split = np.where(abs(split) < 6e-6 * w, 6e-6 * w, split)
    fast = -d - split
    slow = w**2 / fast
    eye = np.eye(len(w))
    shape = np.block([[eye, eye], [np.diag(slow), np.diag(fast)]])
    part = np.diag(1 / (slow - fast))
    dual = np.block([[-part * fast, part], [part * slow, -part]])
    return np.concatenate([slow, fast]), shape, dual


def _contact_modes(
    w: Array, d: Array, b: Array, stiffness: float
) -> tuple[Complex, Complex, Complex]:
    """Return rates, shapes and duals of modes coupled by a spring at the tip.

    In the coordinates w z/sqrt(b), z'/sqrt(b), whose squares are energies, the matrix is nearly
    skew and its modes are well conditioned.
    """
    root = np.sqrt(b)
    coupled = np.diag(w) + stiffness * np.outer(root, root / w)
    matrix = np.block([[np.zeros_like(coupled), np.diag(w)], [-coupled, np.diag(-2 * d)]])
    rate, shape = np.linalg.eig(matrix)
    scale = np.concatenate([w, np.ones_like(w)]) / np.tile(root, 2)
    return rate.astype(complex), shape / scale[:, None], np.linalg.inv(shape) * scale


def _phase(
    rate: Complex,
    shape: Complex,
    dual: Complex,
    per_gap: Array,
    per_force: Complex,
    phasor: Array,
    speed: Array,
    per_harmonic: Complex,
) -> Phase:
    """Assemble a phase, with one term for each conjugate pair of modes."""
    keep = np.flatnonzero(rate.imag >= 0)
    keep = keep[np.argsort(-rate[keep].real)]
    twice = np.where(rate[keep].imag > 0, 2.0, 1.0)
    harmonics = slice(2, 2 + len(speed))
    rate = np.concatenate([[0, 1j], 1j * speed[:, 0], rate[keep]])
    gap_column = np.concatenate([per_gap, np.zeros_like(per_gap)])
    force_column = np.concatenate([per_force, 1j * per_force])
    harmonic_columns = np.hstack([per_harmonic, 1j * speed * per_harmonic])
    shape = np.vstack([gap_column, force_column, harmonic_columns, shape.T[keep]])
    dual = np.hstack([np.zeros((len(dual.T), harmonics.stop)), dual.T[:, keep] * twice])
    tip = shape[:, : len(per_gap)].sum(axis=1)
    tip[harmonics] += 1
    return Phase(
        _parts(rate, 0),
        np.hypot(*_parts(rate, 0)),
        _parts(tip, 0),
        _parts(shape, 1),
        _parts(dual, 1),
        phasor,
    )


def _parts(a: Complex, axis: int) -> Array:
    """Return real and imaginary part along a new axis."""
    return np.ascontiguousarray(np.stack([a.real, a.imag], axis))
