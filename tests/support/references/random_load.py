"""Beams under a random load."""

import numpy as np

from models.beam.parameters import Settings
from models.beam.structure.modal import beams

LEVEL = 1e-3  # N2 Hz-1
PURE = {"force_amplitude": 0.0, "random_force_level": LEVEL}


def prepared(propagator, p, seeds=None, **settings):
    s = Settings(**settings)
    seeds = np.arange(len(p.length)) if seeds is None else seeds
    b = beams(p, s, np.asarray(seeds, np.uint64))
    ((_, system),) = propagator.groups(b, s)
    return b, system


def started(propagator, system, p, gap=1.0):
    x0 = p.initial_gap
    state = propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)
    return state, np.full((len(x0), 2), gap)
