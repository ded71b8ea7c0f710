"""The start of a beam: its propagator, gaps, shares of wear and state."""

import numpy as np

from models.beam import exact, lanes
from models.beam.parameters import Rows, Settings
from models.beam.structure.modal import Array, Beams
from models.beam.structure.propagation import Propagator, System

PROPAGATORS: dict[str, Propagator] = {"fast": lanes, "exact": exact}


def one_system(beams: Beams, settings: Settings) -> tuple[Propagator, System]:
    """Return a propagator that can follow one beam, and the system it prepares.

    The exact one if contact is too stiff, or a random force too fast, for fixed steps.
    """
    for propagator in (PROPAGATORS[settings.propagator], exact):
        for _, system in propagator.groups(beams, settings):
            return propagator, system
    raise AssertionError("the exact propagator takes any beam")


def initial_gaps(p: Rows) -> Array:
    """Return the initial right and left gaps, in units of their mean X0, shape (n, 2) or (2,)."""
    return np.stack([1 + p.gap_asymmetry / 2, 1 - p.gap_asymmetry / 2], axis=-1)


def wear_shares(p: Rows) -> Array:
    """Return the wear coefficient of each site relative to the right site, shape (n, 2) or (2,)."""
    ratio = p.wear_coefficient_ratio
    return np.stack([np.ones_like(ratio, float), ratio], axis=-1)


def initial_state(propagator: Propagator, system: System, p: Rows) -> Array:
    """Return the state of n beams at the start, in their propagator's form."""
    x0 = p.initial_gap
    return propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)
