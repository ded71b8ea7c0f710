"""One beam at any forcing frequency, from modes that are found once.

In real time the modes, free and in contact, do not depend on the force. In the time Omega t their
rates and velocities scale with 1/Omega, and only the steady response must be recomputed.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.exact.phases import Phase, phases
from models.beam.structure.modal import Array, Beams


class Beam(NamedTuple):
    """One beam of the exact propagator.

    Attributes
    ----------
    free, contact : Phase
    detuning : ndarray, shape (2, 2, 2 m)
        Derivative of the steady response to the force with respect to log Omega, free and in
        contact, real and imaginary part: displacements, and velocities at constant time scale.
    """

    free: Phase
    contact: Phase
    detuning: Array

    @staticmethod
    def of(pair: tuple[Phase, Phase]) -> "Beam":
        """Return a beam whose forcing frequency does not vary."""
        return Beam(pair[0], pair[1], np.zeros((2, *pair[0].shape.shape[1:])))


class Tuning:
    """One beam that can be forced at any frequency.

    Parameters
    ----------
    beams : Beams
    row : int

    Attributes
    ----------
    forcing : float
        The angular frequency at which it is forced in `beams` [rad s-1].
    fundamental : float
        First natural angular frequency out of contact [rad s-1].
    size : int
        Of the state: 2 m.
    """

    def __init__(self, beams: Beams, row: int = 0):
        self._beams = beams.take(np.array([row]))
        self._phases = phases(self._beams, 0)
        self.forcing = float(self._beams.forcing[0])
        self.fundamental = float(self._beams.frequency[0, 0])
        self.size = 2 * self._beams.frequency.shape[1]

    def at(self, forcing: float) -> Beam:
        """Return the beam forced at an angular frequency [rad s-1]."""
        free, contact = self._steady(forcing)
        ratio = self.forcing / forcing
        each = (free, contact)
        pair = [_scaled(p, ratio, z) for p, (z, _) in zip(self._phases, each, strict=True)]
        detuning = [np.concatenate([change, 1j * (z + change)]) for z, change in each]
        return Beam(pair[0], pair[1], np.stack([[d.real, d.imag] for d in detuning]))

    def _steady(self, forcing: float) -> tuple[tuple[NDArray[np.complex128], ...], ...]:
        """Return the steady amplitude of each mode and its derivative, free and in contact."""
        b = self._beams
        w, d, mobility = b.in_phase_time(0, forcing)
        dynamic = w**2 - 1 + 2j * d
        free = mobility / dynamic
        change = free * (2 - 2j * d) / dynamic
        stiff = 1 + b.stiffness[0] * free.sum()
        contact = free / stiff
        contact_change = (change - contact * b.stiffness[0] * change.sum()) / stiff
        force = b.force[0]
        return (force * free, force * change), (force * contact, force * contact_change)


def _scaled(phase: Phase, ratio: float, steady: NDArray[np.complex128]) -> Phase:
    """Return a phase in a time scaled by 1/ratio."""
    rate, shape, dual = phase.rate.copy(), phase.shape.copy(), phase.dual.copy()
    m = len(steady)
    rate[:, 2:] *= ratio
    shape[2:, :, m:] *= ratio
    dual[m:] /= ratio
    whole = np.concatenate([steady, 1j * steady])
    shape[1] = whole.real, whole.imag
    tip = phase.tip.copy()
    tip[:, 1] = steady.sum().real, steady.sum().imag
    return phase._replace(rate=rate, speed=np.hypot(*rate), tip=tip, shape=shape, dual=dual)
