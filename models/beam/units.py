"""Units of dimensionless results, of one beam or of n whose parameters are arrays."""

from typing import Any

from models.beam.parameters import Params


def newton(p: Params) -> Any:
    """Return the contact force per penetration of one initial gap [N]."""
    return p.contact_stiffness * p.initial_gap


def joule(p: Params) -> Any:
    """Return one unit of dimensionless work [J]."""
    return p.contact_stiffness * p.initial_gap**2


def watt(p: Params) -> Any:
    """Return the work-rate of one unit of dimensionless work per forcing period [W]."""
    return joule(p) * p.forcing_frequency


def wear_per_work(p: Params) -> Any:
    """Return the growth of the right gap per dimensionless work (eq 9) [initial gaps]."""
    return p.wear_coefficient / p.contact_area * p.contact_stiffness * p.initial_gap
