"""Beams at their nominal values, and what a propagator prepares of them."""

import numpy as np

from models.beam.parameters import Params, Settings
from models.beam.structure.modal import beams


def nominal(n=1, **values):
    fields = {**Params._field_defaults, **values}
    return Params(*(np.broadcast_to(np.asarray(v, float), (n,)).copy() for v in fields.values()))


def prepared(propagator, p, **settings):
    s = Settings(**settings)
    ((_, system),) = propagator.groups(beams(p, s), s)
    return system
