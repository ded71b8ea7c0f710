"""Rows of rods in service."""

import numpy as np

from models.beam.parameters import Params

FIELDS = Params._fields


def rows(n=1, seed=3, **values):
    """Return rows near nominal, with other values in all of them."""
    rng = np.random.default_rng(seed)
    x = np.tile(np.array(Params(), float), (n, 1))
    for name in ("forcing_frequency", "force_amplitude", "initial_gap", "mass_damping"):
        x[1:, FIELDS.index(name)] *= rng.uniform(0.9, 1.1, n - 1)
    for name, value in values.items():
        x[:, FIELDS.index(name)] = value
    return x
