"""The beam in modal form: one oscillator per mode, coupled through the tip.

With z_i = phi_i q_i / X0 the tip's displacement in initial gaps is x = sum z_i, and

    z_i'' + 2 d_i z_i' + w_i^2 z_i = b_i (F cos(Omega t)/X0 - k_c p(x)),    b_i = phi_i^2,
    2 d_i = c_m + c_k w_i^2,    p(x) = (x - x_1)+ - (-x - x_2)+             (Rayleigh damping)

in real time. Nondimensional work per site is the integral of (penetration) |dx|, so that work in
joule is k_c X0^2 times it (eqs 6 to 8 of Knudsen & Massih 2002).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import Rows, Settings
from models.beam.structure.finite_element import modes
from models.beam.structure.random_load import random_load
from models.beam.structure.random_response import SURE, tip_deviation

Array = NDArray[np.float64]


class Beams(NamedTuple):
    """n beams in modal form.

    Attributes
    ----------
    forcing : ndarray, shape (n,)
        Angular forcing frequency Omega [rad s-1].
    frequency, decay, mobility : ndarray, shape (n, m)
        w_i [rad s-1], d_i [s-1], b_i [kg-1] of each mode.
    force : ndarray, shape (n,)
        F/X0 [N m-1].
    stiffness : ndarray, shape (n,)
        k_c [N m-1].
    moving : ndarray of int, shape (n,)
        Number of modes that obey their equations; the others follow the contact force statically.
    load : ndarray of random_load.LOAD, shape (n,)
        The random force over X0.
    """

    forcing: Array
    frequency: Array
    decay: Array
    mobility: Array
    force: Array
    stiffness: Array
    moving: NDArray[np.int64]
    load: NDArray[np.void]

    @property
    def is_random(self) -> NDArray[np.bool_]:
        """Whether each beam has a random load, shape (n,)."""
        return self.load["power"] > 0

    @property
    def memory(self) -> Array:
        """Forcing periods in which the first mode's free motion decays to 1/e, shape (n,)."""
        return self.forcing / (2 * np.pi * self.decay[:, 0])

    @property
    def oscillators(self) -> Array:
        """Frequency, decay and mobility of each mode, shape (n, 3, m)."""
        return np.stack([self.frequency, self.decay, self.mobility], axis=1)

    @property
    def random_memory(self) -> Array:
        """Forcing periods in which the motion under a random load changes, shape (n,).

        The slowest free motion decays to 1/e, or the force of a narrow band changes its amplitude.
        """
        free = self.forcing / (2 * np.pi * slowest_decay(self.frequency, self.decay))
        band = self.load["high"] - self.load["low"]
        return np.maximum(free, np.divide(1, band, out=np.zeros_like(band), where=band > 0))

    @property
    def turn(self) -> Array:
        """Forcing periods in a free oscillation of the first mode, shape (n,)."""
        return self.forcing / self.frequency[:, 0]

    def in_phase_time(self, row: int, forcing: float) -> tuple[Array, Array, Array]:
        """Return w_i, d_i [1] and b_i [m N-1] of one beam in the time Omega t, each shape (m,).

        Parameters
        ----------
        row : int
        forcing : float
            Omega [rad s-1].
        """
        w, d, b = self.frequency[row], self.decay[row], self.mobility[row]
        return w / forcing, d / forcing, b / forcing**2

    def take(self, rows: NDArray[np.intp]) -> "Beams":
        """Return some of the beams."""
        return Beams._make(a.take(rows, axis=0) for a in self)


def slowest_decay(frequency: Array, decay: Array) -> Array:
    """Return the rate of the slowest decay of n beams' free motion [s-1], shape (n,).

    Parameters
    ----------
    frequency, decay : ndarray, shape (n, m)
        w_i [rad s-1], d_i [s-1] of each mode.
    """
    over = np.sqrt(np.maximum(decay**2 - frequency**2, 0.0))
    return np.where(over > 0, frequency**2 / (decay + over), decay).min(axis=1)


def beams(p: Rows, settings: Settings, seed: NDArray[np.uint64] | None = None) -> Beams:
    """Return n beams in modal form.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    settings : Settings
        Only `elements`, `modes` and `residual_flexibility` are used.
    seed : ndarray of uint64, shape (n,), optional
        Of the random load; 0 if not given.

    Returns
    -------
    Beams
    """
    kept = settings.modes or None
    shapes = modes(
        p.length,
        p.flexural_rigidity,
        p.mass_per_length,
        p.lateral_support_stiffness,
        p.rotational_support_stiffness,
        settings.elements,
        None if settings.residual_flexibility else kept,
    )
    w = shapes.frequency
    decay = 0.5 * (p.mass_damping[:, None] + p.stiffness_damping[:, None] * w**2)
    mobility = shapes.tip**2
    if seed is None:
        seed = np.zeros(len(w), np.uint64)
    return Beams(
        2 * np.pi * p.forcing_frequency,
        w,
        decay,
        mobility,
        p.force_amplitude / p.initial_gap,
        p.contact_stiffness,
        np.full(len(w), min(kept or w.shape[1], w.shape[1])),
        random_load(p, slowest_decay(w, decay), seed),
    )


def steady_response(b: Beams) -> NDArray[np.complex128]:
    """Return each mode's share of the steady tip response without contact.

    Parameters
    ----------
    b : Beams

    Returns
    -------
    ndarray, shape (n, m), complex
        Z_i of z_i = Re(Z_i exp(i Omega t)), in initial gaps.
    """
    forcing = b.forcing[:, None]
    stiffness = np.asarray(b.frequency**2 - forcing**2 + 2j * b.decay * forcing, complex)
    return b.mobility * b.force[:, None] / stiffness


def free_reach(b: Beams) -> Array:
    """Return a bound of the tip's displacement without contact.

    Parameters
    ----------
    b : Beams

    Returns
    -------
    ndarray, shape (n,)
        In initial gaps. Under a random force, a bound that is not exceeded in any realistic life.
    """
    response = steady_response(b).sum(axis=1)
    harmonic = np.hypot(response.real, response.imag)
    if not b.load["power"].any():
        return harmonic
    random = tip_deviation(b.load, b.forcing, b.oscillators)
    return harmonic + SURE * random
