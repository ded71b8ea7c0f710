"""Beams ready to be advanced by the exact propagator."""

from typing import Any, NamedTuple

import numpy as np

from models.beam import exact
from models.beam.parameters import Params, Settings
from models.beam.structure.modal import Beams, beams

NOMINAL = Params()
FAR = 1e6  # a gap never crossed [X0]


class Setup(NamedTuple):
    """One or more beams, ready to be advanced."""

    modal: Beams
    system: Any
    state: np.ndarray
    gaps: np.ndarray

    def advance(self, periods, growth=0.0, trace=False):
        growth = np.full_like(self.gaps, growth)
        return exact.advance(self.system, self.state, self.gaps, growth, periods, trace)


def set_up(*rows, gap=1.0, **settings):
    settings = Settings(**settings)
    p = Params(*np.array(rows, float).T)
    modal = beams(p, settings)
    ((_, system),) = exact.groups(modal, settings)
    state = exact.start(
        system, p.initial_displacement / p.initial_gap, p.initial_velocity / p.initial_gap
    )
    gaps = gap * np.stack([1 + p.gap_asymmetry / 2, 1 - p.gap_asymmetry / 2], axis=1)
    return Setup(modal, system, state, gaps)


def at_omega(omega, **settings):
    """Return the nominal beam, forced at a multiple of its fundamental frequency."""
    w0 = set_up(NOMINAL, **settings).modal.frequency[0, 0]
    return NOMINAL._replace(forcing_frequency=omega * w0 / (2 * np.pi))


def critically_damped(elements, mode):
    w = set_up(NOMINAL, elements=elements).modal.frequency[0, mode]
    c_k = (2 * w - NOMINAL.mass_damping) / w**2
    return NOMINAL._replace(stiffness_damping=c_k)


def deflected(p):
    return p._replace(initial_displacement=4e-4, initial_velocity=-0.1)
